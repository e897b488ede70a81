// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/simulator/frame_generator.h"

#include <algorithm>

namespace lightwell::simulator {
namespace {

constexpr std::size_t kRecentLayers = 4;  // two keyframes in use, two to spare

bool same(const DiscLight& a, const DiscLight& b) {
  return a.direction == b.direction && a.angular_radius_rad == b.angular_radius_rad &&
         (a.illuminance == b.illuminance).all();
}

}  // namespace

FrameGenerator::FrameGenerator(std::shared_ptr<const Scene> scene, const ProbeModel& model)
    : scene_(std::move(scene)),
      model_(model),
      projector_(model.calibration.lens, is_bayer(model.format.pixel_format)),
      sensor_(model),
      base_(projector_.pixels(), 0.0f),
      plane_(projector_.pixels(), 0.0f) {
  for (const std::int64_t id : scene_->lasting_layers()) {
    const Layer made = scene_->layer(id);
    lasting_[id] = {projector_.project(made), hemisphere_illuminance(made.image)};
  }
  // The first keyframes, and with them the table that later ones are interpolated by.
  for (const SceneMoment::Part& part : scene_->at(0, 1e-3).parts) layer(part.layer);
}

const FrameGenerator::Projected& FrameGenerator::layer(std::int64_t id) {
  if (const auto found = lasting_.find(id); found != lasting_.end()) return found->second;
  for (const auto& [key, value] : recent_)
    if (key == id) return value;
  if (recent_.size() >= kRecentLayers) recent_.pop_back();
  const Layer made = scene_->layer(id);
  recent_.emplace_front(id, Projected{projector_.project(made), hemisphere_illuminance(made.image)});
  return recent_.front().second;
}

void FrameGenerator::compose(const SceneMoment& moment) {
  const bool same_base = moment.parts == mixed_;
  if (same_base &&
      std::equal(moment.lights.begin(), moment.lights.end(), lights_.begin(), lights_.end(), same))
    return;
  if (!same_base) mix(moment);
  std::copy(base_.begin(), base_.end(), plane_.begin());
  for (const DiscLight& light : moment.lights) projector_.add_disc(light, plane_);
  lights_ = moment.lights;
}

void FrameGenerator::mix(const SceneMoment& moment) {
  std::fill(base_.begin(), base_.end(), 0.0f);
  for (const SceneMoment::Part& part : moment.parts) {
    const std::vector<float>& source = layer(part.layer).plane;
    const auto weight = static_cast<float>(part.weight);
    for (std::size_t i = 0; i < base_.size(); ++i) base_[i] += weight * source[i];
  }
  mixed_ = moment.parts;
}

Rgbd FrameGenerator::seen(const Rgbd& colour) const {
  return projector_.bayer() ? colour : Rgbd(Rgbd::Constant(luminance(colour)));
}

FrameTruth FrameGenerator::render(double end_s, double exposure_us, std::uint64_t frame_index,
                                  PixelFormat format, std::span<std::byte> out) {
  const SceneMoment moment = scene_->at(end_s - exposure_us * 1e-6, end_s);
  compose(moment);
  sensor_.encode(plane_, exposure_us, frame_index, format, out);

  FrameTruth truth;
  truth.position_m = moment.position_m;
  truth.scene_s = end_s - exposure_us * 0.5e-6;
  for (const SceneMoment::Part& part : moment.parts)
    truth.total_illuminance += part.weight * seen(layer(part.layer).illuminance);
  for (DiscLight light : moment.lights) {
    light.illuminance = seen(light.illuminance) * part_above_horizon(light);
    truth.total_illuminance += light.illuminance;
    truth.lights.push_back(light);
  }
  return truth;
}

}  // namespace lightwell::simulator
