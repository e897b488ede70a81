// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/simulator/paint.h"
#include "daemon/simulator/walk_stage.h"

// The walk's stage from one place of it, still: several such probes see one light.
namespace lightwell::simulator {
namespace {

constexpr int kWidth = 360, kHeight = 180;  // 1°

class StageScene final : public Scene {
 public:
  explicit StageScene(const Vec3d& position_m) : position_m_(position_m) {}

  SceneMoment at(double, double) const override {
    SceneMoment moment;
    moment.parts = {{0, 1.0}};
    moment.position_m = position_m_;
    moment.lights = stage_lights(position_m_);
    return moment;
  }
  Layer layer(std::int64_t) const override {
    return paint_upper_half(kWidth, kHeight,
                            [&](const Vec3d& d) { return stage_wall_radiance(position_m_, d); });
  }
  std::vector<std::int64_t> lasting_layers() const override { return {0}; }
  double brightest_cd_m2() const override { return kStageBrightest_cd_m2; }

 private:
  Vec3d position_m_;
};

}  // namespace

std::shared_ptr<const Scene> make_stage_scene(const Vec3d& position_m) {
  return std::make_shared<StageScene>(position_m);
}

}  // namespace lightwell::simulator
