// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/pose_track.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lighting/result.h"

namespace lightwell {

PoseTrack::PoseTrack(std::vector<TimedPose> poses, const Limits& limits)
    : poses_(std::move(poses)), limits_(limits) {
  verify_bug(!poses_.empty(), "a track of no poses");
  for (std::size_t i = 1; i < poses_.size(); ++i)
    verify_bug(poses_[i].time_ns > poses_[i - 1].time_ns, "a track whose times do not rise");
}

PoseTrack::Known PoseTrack::known_before(std::size_t pose) const {
  const TimedPose &from = poses_[pose - 1], &to = poses_[pose];
  const double seconds = static_cast<double>(to.time_ns - from.time_ns) * 1e-9;
  if (seconds > limits_.most_gap_s) return Known::in_gap;
  const double metres = (to.pose.position_m - from.pose.position_m).norm();
  return metres > limits_.most_speed_m_s * seconds ? Known::in_jump : Known::yes;
}

PoseTrack::At PoseTrack::at(std::int64_t frame_ns, double lag_s) const {
  const std::int64_t time_ns = frame_ns + std::llround(lag_s * 1e9);
  const auto after =
      std::lower_bound(poses_.begin(), poses_.end(), time_ns,
                       [](const TimedPose& pose, std::int64_t time) { return pose.time_ns < time; });
  if (after == poses_.end() || (after == poses_.begin() && after->time_ns != time_ns))
    return {Known::outside, {}};
  if (after->time_ns == time_ns) return {Known::yes, after->pose};
  const Known known = known_before(static_cast<std::size_t>(after - poses_.begin()));
  if (known != Known::yes) return {known, {}};
  const TimedPose &a = *(after - 1), &b = *after;
  const double part = static_cast<double>(time_ns - a.time_ns) / static_cast<double>(b.time_ns - a.time_ns);
  return {Known::yes,
          {a.pose.position_m + part * (b.pose.position_m - a.pose.position_m),
           a.pose.world_from_probe.slerp(part, b.pose.world_from_probe)}};
}

std::size_t PoseTrack::first_jump() const {
  for (std::size_t i = 1; i < poses_.size(); ++i)
    if (known_before(i) == Known::in_jump) return i;
  return poses_.size();
}

}  // namespace lightwell
