// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/evaluation/latency.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "lighting/result.h"

namespace lightwell {
namespace {

constexpr int kLeast = -2;
constexpr int kMost = 12;
constexpr std::size_t kFewestFrames = 20;

struct Match {
  double difference = 0;  // mean square of follower(t) − reference(t − lag), means taken out
  double variance = 0;    // of the reference over the same frames
};

// Over frames that have a partner at every lag, so that all lags are judged by the same follower.
Match match_at(std::span<const Vec3d> follower, std::span<const Vec3d> reference, int lag) {
  const auto begin = static_cast<std::size_t>(kMost);
  const std::size_t end = follower.size() - static_cast<std::size_t>(-kLeast);
  const auto at = [&](std::size_t t) {
    return reference[static_cast<std::size_t>(static_cast<int>(t) - lag)];
  };
  const auto count = static_cast<double>(end - begin);
  Vec3d mean_difference = Vec3d::Zero();
  Vec3d mean = Vec3d::Zero();
  for (std::size_t t = begin; t < end; ++t) {
    mean_difference += (follower[t] - at(t)) / count;
    mean += at(t) / count;
  }
  Match match;
  for (std::size_t t = begin; t < end; ++t) {
    match.difference += (follower[t] - at(t) - mean_difference).squaredNorm() / count;
    match.variance += (at(t) - mean).squaredNorm() / count;
  }
  return match;
}

}  // namespace

double lag_frames(std::span<const Vec3d> follower, std::span<const Vec3d> reference) {
  verify_bug(follower.size() == reference.size(), "series of two lengths");
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  if (follower.size() < kFewestFrames) return kNone;
  double largest = 0;
  for (const Vec3d& r : reference) largest = std::max(largest, r.squaredNorm());
  std::array<Match, kMost - kLeast + 1> matches;
  for (int lag = kLeast; lag <= kMost; ++lag)
    matches[static_cast<std::size_t>(lag - kLeast)] = match_at(follower, reference, lag);
  const auto best = static_cast<std::size_t>(
      std::min_element(matches.begin(), matches.end(),
                       [](const Match& a, const Match& b) { return a.difference < b.difference; }) -
      matches.begin());
  const Match& least = matches[best];
  // Standing still: changes are rounding of the sums.
  if (!(least.variance > 1e-16 * largest) || !(least.difference <= 0.5 * least.variance)) return kNone;
  if (best == 0 || best + 1 == matches.size()) return kNone;  // still falling: the valley is elsewhere
  const double before = matches[best - 1].difference - least.difference;
  const double after = matches[best + 1].difference - least.difference;
  const double fraction = before + after > 0 ? (before - after) / (2 * (before + after)) : 0;
  return kLeast + static_cast<double>(best) + fraction;
}

}  // namespace lightwell
