// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "bench/followers.h"
#include "bench/sequences.h"
#include "bench/suite.h"
#include "lighting/evaluation/coherence.h"

namespace lightwell::bench {

// What a follower did on a sequence. prefix 0: the whole set.
struct FollowedRow {
  std::string sequence, follower;
  std::size_t prefix = 0;
  Coherence coherence;
  Timing timing;  // of the step, the first frame (cold) left out
  double cold_ms = 0;
};

// Draws every frame once, and has all followers follow it with so many lights.
std::vector<FollowedRow> follow(const Sequence& sequence, const std::vector<Follower>& followers, int lights);

// Every method, the samplers with every filter, and one behind the mains filter.
std::vector<Follower> all_followers();

// One row a sequence and follower.
std::vector<Row> coherence_suite(const Options& options);

// One row a follower, 64 lights, means over all sequences: rows "temporal" with shadow_error, shadow_excess,
// shadow_change_error, shadow_largest_excess (the largest), latency_frames (of power, where sequences tell).
std::vector<Row> temporal_rows(const Options& options);

// What each makes of lamps that flicker at 100 Hz, one of them switched, at 60 frames a second: rows "flicker" with
// swing (half of largest less least total power, relative, once settled), suppression_db against the map's own,
// passed_in_frame (the part of the switched lamp's step that is there in its frame), latency_frames until half of
// it is.
std::vector<Row> flicker_rows(const Options& options);

// A sun of 30 degrees a second over noise of 1 %, at 15 to 240 frames a second, 64 lights: rows "growth, rate" with
// rate_hz, share_of_core, shadow_error, shadow_excess.
std::vector<Row> rate_rows(const Options& options);

}  // namespace lightwell::bench
