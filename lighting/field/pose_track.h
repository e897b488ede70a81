// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <optional>
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
//
// A step between two poses that goes or turns faster than the limits is a jump. Poses between two jumps are left out as
// outliers, as though they had never come, where nothing speaks for them: where it is one alone, or where there are
// fewer of them than before and after them, the path over them is no jump, and no longer than most_gap_s.
class PoseTrack {
 public:
  struct Limits {
    double most_gap_s = 0.1;     // between two poses, above which what is between them is not known
    double most_speed_m_s = 20;  // a faster step is a fault of the tracker: what is between is not known
    double most_turn_rad_s = 4 * kPi;  // likewise: two turns a second
    // By how much a step may be more than that: trackers' noise, and times of arrival that lie closer than the samples.
    double noise_m = 0.02, noise_rad = 0.035;
  };
  struct Jump {
    std::size_t from = 0, to = 0;  // of the given poses
    double metres = 0, radians = 0, seconds = 0;
  };
  // poses: one or more, times rising.
  PoseTrack(const std::vector<TimedPose>& poses, const Limits& limits);

  enum class Known { yes, outside, in_gap, in_jump };
  struct At {
    Known known = Known::yes;
    ProbePose pose;  // where known
  };
  // The pose at a frame's mid-exposure. The poses come late by lag_s: the pose that belongs to a frame of time t carries
  // the time t + lag_s.
  [[nodiscard]] At at(std::int64_t frame_ns, double lag_s) const;

  [[nodiscard]] std::int64_t first_ns() const { return first_ns_; }
  [[nodiscard]] std::int64_t last_ns() const { return last_ns_; }
  // Of the given poses, those that are left out, rising.
  [[nodiscard]] const std::vector<std::size_t>& outliers() const { return outliers_; }
  [[nodiscard]] const std::optional<Jump>& first_outlier()
      const {  // the step to it, or from it where it is the first pose
    return first_outlier_;
  }
  // The first step between poses that count, and are in sequence, that is a jump.
  [[nodiscard]] std::optional<Jump> first_jump() const;

 private:
  struct Kept {
    TimedPose timed;
    std::size_t given = 0;
  };
  [[nodiscard]] bool is_jump(const TimedPose& from, const TimedPose& to) const;
  [[nodiscard]] static Jump step(const Kept& from, const Kept& to);
  void leave_out_outliers(const std::vector<TimedPose>& poses);

  Limits limits_;
  std::int64_t first_ns_, last_ns_;
  std::vector<Kept> kept_;
  std::vector<std::size_t> outliers_;
  std::optional<Jump> first_outlier_;
};

}  // namespace lightwell
