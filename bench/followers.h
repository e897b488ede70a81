// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "lighting/decomposition/decompose.h"
#include "lighting/light_set.h"
#include "lighting/polar_map.h"
#include "lighting/temporal/temporal_choice.h"

namespace lightwell::bench {

// Map after map to light sets, with whatever state it keeps. set is reused from frame to frame.
using Stepper = std::function<void(const PolarMap& map, LightSet& set)>;

// One way to make lights. make gives a new stepper, without history, for so many lights.
struct Follower {
  std::string name;
  std::function<Stepper(int count)> make;
  std::vector<std::size_t> prefixes = {};  // also measured: the first n lights of each set
  bool keeps_state = true;                 // else every frame is as the first
};

// A method as a probe runs it, frame after frame: with its state where it has one, without a filter.
Follower method_follower(Method method);
// A sampler with a filter behind it, at the paper's 21 frames a second.
Follower filtered_follower(Method method, TemporalChoice choice);
// Another's lights after the mains' flicker was taken out of the map: frames at 60 a second, exposed 2 ms.
Follower without_flicker(const Follower& follower);

// Every method; and importance sampling as renderers write it, with the paper's own sampler as printed, as peers.
std::vector<Follower> all_methods();
std::vector<Follower> peers();

}  // namespace lightwell::bench
