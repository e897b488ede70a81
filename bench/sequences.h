// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "lighting/polar_map.h"

namespace lightwell::bench {

// A moving light, frame by frame: 90 × 360 over the hemisphere, three channels. Frames may be asked for in any
// order and are the same every time.
struct Sequence {
  std::string name;
  int frames = 0;
  std::function<void(int frame, PolarMap& map)> draw;  // map: of sequence_map(); every bin is written
};

PolarMap sequence_map();

// Those of the coherence tables (noise on a map, a sun that moves, a sun that crosses azimuth 0, a pulsing lamp,
// a turning map, 40 lamps switching, a turning map with noise), then clouds over the sun, a person crossing the
// windows, a wall playing video, dusk with lamps switched on, a hand-held probe, and lamps on the mains seen at
// 60 frames a second. The turning maps and the hand-held probe are a painted room; with a folder of real maps
// (Radiance HDR or EXR, latitude–longitude, 2:1) also those found there of the few named in the source.
std::vector<Sequence> sequences(const std::filesystem::path& maps = {});

// Of those, the lamps on the mains: 100 Hz, 60 frames a second, exposed 2 ms; one of them goes dark in a frame and
// comes back 24 frames later.
Sequence mains_flicker();
inline constexpr int kMainsSwitchedFrame = 48;

// Two seconds and a half, at most 120 frames, of a sun that moves by 30 degrees a second over a sky with 1 % noise.
Sequence sun_at_rate(double rate_hz);

}  // namespace lightwell::bench
