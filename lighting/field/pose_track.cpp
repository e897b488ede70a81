// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/pose_track.h"

#include <algorithm>
#include <cmath>

#include "lighting/result.h"

namespace lightwell {
namespace {

double seconds_between(const TimedPose& from, const TimedPose& to) {
  return static_cast<double>(to.time_ns - from.time_ns) * 1e-9;
}
double metres_between(const TimedPose& from, const TimedPose& to) {
  return (to.pose.position_m - from.pose.position_m).norm();
}
double radians_between(const TimedPose& from, const TimedPose& to) {
  return to.pose.world_from_probe.angularDistance(from.pose.world_from_probe);
}

}  // namespace

PoseTrack::PoseTrack(const std::vector<TimedPose>& poses, const Limits& limits) : limits_(limits) {
  verify_bug(!poses.empty(), "a track of no poses");
  for (std::size_t i = 1; i < poses.size(); ++i)
    verify_bug(poses[i].time_ns > poses[i - 1].time_ns, "a track whose times do not rise");
  first_ns_ = poses.front().time_ns;
  last_ns_ = poses.back().time_ns;
  leave_out_outliers(poses);
}

bool PoseTrack::is_jump(const TimedPose& from, const TimedPose& to) const {
  const double seconds = seconds_between(from, to);
  return metres_between(from, to) > limits_.most_speed_m_s * seconds + limits_.noise_m ||
         radians_between(from, to) > limits_.most_turn_rad_s * seconds + limits_.noise_rad;
}

PoseTrack::Jump PoseTrack::step(const Kept& from, const Kept& to) {
  return {from.given, to.given, metres_between(from.timed, to.timed), radians_between(from.timed, to.timed),
          seconds_between(from.timed, to.timed)};
}

void PoseTrack::leave_out_outliers(const std::vector<TimedPose>& poses) {
  std::vector<std::size_t> starts = {0};  // of the stretches between jumps
  for (std::size_t i = 1; i < poses.size(); ++i)
    if (is_jump(poses[i - 1], poses[i])) starts.push_back(i);
  starts.push_back(poses.size());
  const std::size_t stretches = starts.size() - 1;
  const auto size = [&](std::size_t stretch) { return starts[stretch + 1] - starts[stretch]; };
  for (std::size_t s = 0; s < stretches; ++s) {
    const std::size_t first = starts[s], end = starts[s + 1];
    const bool alone = size(s) == 1 && stretches > 1;
    const bool between = s > 0 && s + 1 < stretches && size(s) < size(s - 1) && size(s) < size(s + 1);
    const bool passed = between && seconds_between(poses[first - 1], poses[end]) <= limits_.most_gap_s &&
                        !is_jump(poses[first - 1], poses[end]);
    for (std::size_t i = first; i < end; ++i) {
      if (alone || passed)
        outliers_.push_back(i);
      else
        kept_.push_back({poses[i], i});
    }
  }
  if (outliers_.empty()) return;
  const std::size_t to = std::max<std::size_t>(outliers_.front(), 1);
  first_outlier_ = step({poses[to - 1], to - 1}, {poses[to], to});
}

PoseTrack::At PoseTrack::at(std::int64_t frame_ns, double lag_s) const {
  const std::int64_t time_ns = frame_ns + std::llround(lag_s * 1e9);
  if (time_ns < first_ns_ || time_ns > last_ns_) return {Known::outside, {}};
  const auto after =
      std::lower_bound(kept_.begin(), kept_.end(), time_ns,
                       [](const Kept& pose, std::int64_t time) { return pose.timed.time_ns < time; });
  if (after != kept_.end() && after->timed.time_ns == time_ns) return {Known::yes, after->timed.pose};
  if (after == kept_.begin() || after == kept_.end()) return {Known::in_jump, {}};
  const TimedPose &a = (after - 1)->timed, &b = after->timed;
  if (is_jump(a, b)) return {Known::in_jump, {}};
  if (seconds_between(a, b) > limits_.most_gap_s) return {Known::in_gap, {}};
  const double part = static_cast<double>(time_ns - a.time_ns) / static_cast<double>(b.time_ns - a.time_ns);
  return {Known::yes,
          {a.pose.position_m + part * (b.pose.position_m - a.pose.position_m),
           a.pose.world_from_probe.slerp(part, b.pose.world_from_probe)}};
}

std::optional<PoseTrack::Jump> PoseTrack::first_jump() const {
  for (std::size_t i = 1; i < kept_.size(); ++i)
    if (is_jump(kept_[i - 1].timed, kept_[i].timed)) return step(kept_[i - 1], kept_[i]);
  return std::nullopt;
}

}  // namespace lightwell
