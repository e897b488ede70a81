// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "lighting/evaluation/evaluate.h"
#include "lighting/light_set.h"
#include "lighting/polar_map.h"

namespace lightwell {

// How steadily light sets follow a sequence of maps. M(t): what the map gives in frame t, S(t): what the lights
// give (shadow image or irradiance), ‖·‖ over all points and RGB; a mean is over the frames that have it.
struct Steadiness {
  double error = 0;             // mean of ‖S(t) − M(t)‖ / ‖M(t)‖
  double reference_change = 0;  // mean of ‖M(t) − M(t−1)‖ / ‖M(t)‖
  double change = 0;            // mean of ‖S(t) − S(t−1)‖ / ‖M(t)‖
  // change − reference_change, but not below 0: by how much the lights are more restless than the light.
  double excess = 0;
  // mean of ‖(S(t) − S(t−1)) − (M(t) − M(t−1))‖ / ‖M(t)‖: the stricter one, which lights that change as much as
  // the light but elsewhere, or later, do not pass.
  double change_error = 0;
  double largest_error = 0;  // over the frames
  double largest_excess = 0;  // over the frames, of ‖S(t) − S(t−1)‖ − ‖M(t) − M(t−1)‖, relative: a pop
};

// One configuration's record over a sequence.
struct Coherence {
  std::size_t frames = 0;  // that counted: frames whose map is black do not
  Steadiness shadow;
  Steadiness irradiance;
  // Frames by which the lights follow (lighting/evaluation/latency.h); NaN where the sequence does not tell.
  double power_lag_frames = 0;      // total luminance
  double direction_lag_frames = 0;  // luminance-weighted mean direction
};

// The map's side of one frame: computed once, compared with any number of light sets.
struct ReferenceFrame {
  std::vector<Rgbd> shadow;
  std::vector<Rgbd> irradiance;
  double power = 0;                 // Σ luminance × solid angle
  Vec3d direction = Vec3d::Zero();  // Σ luminance × solid angle × direction / power, not unit
};
ReferenceFrame reference_frame(const EvaluationGeometry& geometry, const PolarMap& map);

// Follows one light set, or its first `prefix` lights as a reader would take them (take_lights), frame by frame.
class CoherenceMeter {
 public:
  explicit CoherenceMeter(Occluder occluder = Occluder::sphere, std::optional<std::size_t> prefix = {});
  // Frames in order. reference: of a geometry with this occluder. Black maps end the comparison with the frame
  // before and are not counted.
  void add(const ReferenceFrame& reference, const LightSet& lights);
  [[nodiscard]] Coherence result() const;

 private:
  // Running sums of one image's steadiness.
  struct Track {
    std::vector<Rgbd> last_map, last_lights;
    Steadiness sum;
    std::size_t frames = 0, changes = 0;
    void add(const std::vector<Rgbd>& map, std::vector<Rgbd> lights, bool follows);
    [[nodiscard]] Steadiness mean() const;
  };

  Occluder occluder_;
  std::optional<std::size_t> prefix_;
  bool follows_ = false;  // the frame before was counted
  Track shadow_, irradiance_;
  std::vector<Vec3d> power_, map_power_, direction_, map_direction_;
};

}  // namespace lightwell
