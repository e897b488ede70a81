// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <list>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "daemon/simulator/probe_model.h"
#include "daemon/simulator/projector.h"
#include "daemon/simulator/scene.h"
#include "daemon/simulator/sensor.h"

namespace lightwell::simulator {

// What a frame shows, exactly: from the scene, not from the frame's pixels.
struct FrameTruth {
  Rgbd total_illuminance = Rgbd::Zero();  // lux summed over the upper hemisphere; R = G = B = luminance for a
                                          // monochrome camera, which can see no more
  std::vector<DiscLight> lights;          // those in closed form, the part above the horizon; same for colour
  std::optional<Vec3d> position_m;
  double scene_s = 0;  // the scene's time at the middle of the exposure
};

// A scene through lens and sensor. One thread; pure otherwise: equal arguments give equal bytes.
class FrameGenerator {
 public:
  // Makes the scene's lasting layers at once, which can take a second for large images.
  FrameGenerator(std::shared_ptr<const Scene> scene, const ProbeModel& model);

  // end_s: scene time when the exposure ends; out: bytes of the model's size in `format`.
  FrameTruth render(double end_s, double exposure_us, std::uint64_t frame_index, PixelFormat format,
                    std::span<std::byte> out);

  [[nodiscard]] const ProbeModel& model() const { return model_; }

 private:
  struct Projected {
    std::vector<float> plane;
    Rgbd illuminance;
  };
  const Projected& layer(std::int64_t id);
  void compose(const SceneMoment& moment);
  void mix(const SceneMoment& moment);
  [[nodiscard]] Rgbd seen(const Rgbd& colour) const;

  std::shared_ptr<const Scene> scene_;
  ProbeModel model_;
  Projector projector_;
  Sensor sensor_;
  std::map<std::int64_t, Projected> lasting_;
  std::list<std::pair<std::int64_t, Projected>> recent_;  // newest first
  std::vector<SceneMoment::Part> mixed_;                  // what base_ holds
  std::vector<float> base_;
  std::vector<DiscLight> lights_;  // what plane_ holds beside base_
  std::vector<float> plane_;
};

}  // namespace lightwell::simulator
