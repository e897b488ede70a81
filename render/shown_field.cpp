// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/shown_field.h"

#include "render/say.h"
#include "render/session_inputs.h"

namespace lightwell::render {

Result<bool> ShownField::update(const LightSource& source, const Scene& scene, Renderer& renderer) {
  if (source.field_version() == version_) return false;
  version_ = source.field_version();
  const LightField& field = *source.field();
  const auto start = Clock::now();
  const Status done = set(field, renderer);
  if (!done && options_.live_field && done.error().kind == ErrorKind::bad_input) {
    if (done.error().message != said_unfit_) say("a light field is refused: " + done.error().message);
    said_unfit_ = done.error().message;
    return false;
  }
  if (!done) return Error{done.error().kind, options_.field.string() + ": " + done.error().message};
  update_ms_.push_back(std::chrono::duration<double, std::milli>(Clock::now() - start).count());
  if (options_.live_field) say_reach(field, scene);
  return true;
}

Status ShownField::set(const LightField& field, Renderer& renderer) {
  const Sphere& objects = renderer.object_bounds();
  const Vec3d centre = objects.centre.cast<double>(),
              reach = Vec3d::Constant(static_cast<double>(objects.radius));
  const Vec3d low = centre - reach, high = centre + reach;
  if (!options_.live_field)
    return renderer.set_field(field, find_main_lights(field, options_.field_shadows, low, high));
  const auto now = Clock::now();
  const double since_last_s = std::chrono::duration<double>(now - last_).count();
  last_ = now;
  return renderer.set_field(field, main_lights_.update(field, since_last_s, low, high));
}

// A file's is among what is said before the first picture.
void ShownField::say_reach(const LightField& field, const Scene& scene) {
  if (field.grid == said_reach_of_) return;
  said_reach_of_ = field.grid;
  if (const std::string remark = remark_on_reach(scene, field, "the live field"); !remark.empty())
    say(remark);
}

}  // namespace lightwell::render
