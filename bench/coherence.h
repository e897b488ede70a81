// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "bench/sequences.h"
#include "bench/suite.h"
#include "lighting/evaluation/coherence.h"
#include "lighting/light_set.h"

namespace lightwell::bench {

// Map after map to light sets, with whatever state it keeps. set is reused from frame to frame.
using Stepper = std::function<void(const PolarMap& map, LightSet& set)>;

// One way to follow a sequence: a new stepper, without history, for each.
struct Follower {
  std::string name;  // "best, 64 lights"
  std::function<Stepper()> make;
  std::vector<std::size_t> prefixes = {};  // also measured: the first n lights of each set
};

// What a follower did on a sequence. prefix 0: the whole set.
struct FollowedRow {
  std::string sequence, follower;
  std::size_t prefix = 0;
  Coherence coherence;
  Timing timing;  // of the step, the first frame (cold) left out
  double cold_ms = 0;
};

// Draws every frame once, and has all followers follow it.
std::vector<FollowedRow> follow(const Sequence& sequence, const std::vector<Follower>& followers);

// Followers of all methods without state, of the samplers with their filter, at a count of lights.
std::vector<Follower> all_followers(int count);

std::vector<Row> coherence_suite(const Options& options);

}  // namespace lightwell::bench
