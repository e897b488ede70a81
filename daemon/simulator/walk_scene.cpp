// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "daemon/simulator/paint.h"
#include "daemon/simulator/walk_stage.h"

// The probe is carried over the stage in lanes, as one mows a lawn: along x at the ground's height, along z 10 cm
// higher, and so on to 30 cm, each layer's lanes between those of the layer two below; then from the beginning.
namespace lightwell::simulator {
namespace {

constexpr int kWidth = 360, kHeight = 180;  // 1°
// Walls are painted so often; between, the two pictures are mixed. Lamps and lenses are exact at every moment.
constexpr double kKeyframe_s = 0.1;
constexpr double kSpeed_m_s = 0.5;
constexpr double kLane_m = 0.1;  // from one to the next
constexpr double kLayer_m = 0.1;
constexpr int kLayers = 4, kLanes = 17;

constexpr double kLaneLength_m = 2 * kWalkHalf_m, kLaneAndTurn_m = kLaneLength_m + kLane_m;
constexpr double kLayerWay_m = kLanes * kLaneAndTurn_m;

// Along the lanes of a layer, `way` metres from their beginning.
Vec3d place_on_lanes(int layer, double way) {
  const double lane = std::floor(way / kLaneAndTurn_m);
  const double rest = way - lane * kLaneAndTurn_m;
  const double shift = layer >= 2 ? kLane_m / 2 : 0;
  const double across =
      std::min(lane * kLane_m + std::max(0.0, rest - kLaneLength_m) - kWalkHalf_m + shift, kWalkHalf_m);
  const double forth = std::min(rest, kLaneLength_m) - kWalkHalf_m;
  const double along = std::fmod(lane, 2) == 0 ? forth : -forth;
  const double height = layer * kLayer_m;
  // Every other layer from the corner where the one below it ends.
  return layer % 2 == 0 ? Vec3d(along, height, across) : Vec3d(-across, height, -along);
}

Vec3d probe_position(double time_s) {
  const double way = std::fmod(kSpeed_m_s * time_s, kLayers * kLayerWay_m);
  const int layer = std::min(static_cast<int>(way / kLayerWay_m), kLayers - 1);
  const double in_layer = way - layer * kLayerWay_m;
  const double last_turn = kLayerWay_m - kLane_m;
  if (in_layer < last_turn) return place_on_lanes(layer, in_layer);
  const double part = (in_layer - last_turn) / kLane_m;
  return (1 - part) * place_on_lanes(layer, last_turn) + part * place_on_lanes((layer + 1) % kLayers, 0);
}

class WalkScene final : public Scene {
 public:
  SceneMoment at(double begin_s, double end_s) const override {
    const double middle = (begin_s + end_s) / 2;
    const double key = std::floor(middle / kKeyframe_s);
    const double w = middle / kKeyframe_s - key;
    const auto id = static_cast<std::int64_t>(key);
    SceneMoment moment;
    moment.parts = {{id, 1 - w}, {id + 1, w}};
    moment.position_m = probe_position(middle);
    moment.lights = stage_lights(*moment.position_m);
    return moment;
  }

  Layer layer(std::int64_t id) const override {
    const Vec3d from = probe_position(static_cast<double>(id) * kKeyframe_s);
    return paint_upper_half(kWidth, kHeight, [&](const Vec3d& d) { return stage_wall_radiance(from, d); });
  }

  std::vector<std::int64_t> lasting_layers() const override { return {}; }
  double brightest_cd_m2() const override { return kStageBrightest_cd_m2; }
};

}  // namespace

std::shared_ptr<const Scene> make_walk_scene() {
  return std::make_shared<WalkScene>();
}

}  // namespace lightwell::simulator
