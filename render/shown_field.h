// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "lighting/field/main_light_tracks.h"
#include "render/light_source.h"
#include "render/options.h"
#include "render/renderer.h"

namespace lightwell::render {

// Brings a source's field into a renderer, with main lights that are looked for where the objects are: of a file once, of a
// live field followed from one to the next.
class ShownField {
 public:
  explicit ShownField(const Options& options) : options_(options), main_lights_(options.field_shadows) {}

  // True where the source had another field than at the last call, and it is shown. A live one that the driver cannot hold is
  // said and passed by. bad_input: so is a file's, which ends the run.
  Result<bool> update(const LightSource& source, const Scene& scene, Renderer& renderer);
  // How long each that is shown took, milliseconds: main lights and loading.
  [[nodiscard]] const std::vector<double>& update_ms() const { return update_ms_; }

 private:
  using Clock = std::chrono::steady_clock;
  Status set(const LightField& field, Renderer& renderer);
  void say_reach(const LightField& field, const Scene& scene);

  const Options& options_;
  MainLightTracks main_lights_;
  int version_ = 0;
  Clock::time_point last_ = Clock::now();
  std::vector<double> update_ms_;
  std::string said_unfit_;
  std::optional<FieldGrid> said_reach_of_;
};

}  // namespace lightwell::render
