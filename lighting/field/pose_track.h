// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "lighting/vector.h"

namespace lightwell {

// Where a probe stands in the world and how it is turned: its own frame is the world's where the turn is none (+Y its
// zenith, docs/conventions.md).
struct ProbePose {
  Vec3d position_m = Vec3d::Zero();
  Eigen::Quaterniond world_from_probe = Eigen::Quaterniond::Identity();
};

struct TimedPose {
  std::int64_t time_ns = 0;  // CLOCK_MONOTONIC
  ProbePose pose;
};

// A path through poses: straight lines and constant turning between them, and nothing where they tell nothing.
class PoseTrack {
 public:
  struct Limits {
    double most_gap_s = 0.1;     // between two poses, above which what is between them is not known
    double most_speed_m_s = 20;  // a faster step is a fault of the tracker: what is between is not known
  };
  // poses: one or more, times rising.
  PoseTrack(std::vector<TimedPose> poses, const Limits& limits);

  enum class Known { yes, outside, in_gap, in_jump };
  struct At {
    Known known = Known::yes;
    ProbePose pose;  // where known
  };
  // The pose at a frame's mid-exposure. The poses come late by lag_s: the pose that belongs to a frame of time t carries
  // the time t + lag_s.
  [[nodiscard]] At at(std::int64_t frame_ns, double lag_s) const;

  [[nodiscard]] const std::vector<TimedPose>& poses() const { return poses_; }
  // The first pose that is a jump from the one before it; poses().size() where there is none.
  [[nodiscard]] std::size_t first_jump() const;

 private:
  [[nodiscard]] Known known_before(std::size_t pose) const;  // between it and the one before
  std::vector<TimedPose> poses_;
  Limits limits_;
};

}  // namespace lightwell
