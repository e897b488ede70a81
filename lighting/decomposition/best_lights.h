// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "lighting/decomposition/light_placement.h"
#include "lighting/light_set.h"
#include "lighting/polar_map.h"

namespace lightwell {

inline constexpr int kMostPlacedLights = 512;

// The project's own decomposition: N lights of least cost to show the map by (error_kernel.h), frame by frame.
//
// A light's direction is fixed in the world while it serves: dragging lights makes the edges of shadows crawl and pop,
// fading powers does not. Each frame: map → atoms → powers of least cost at the lights' places, with the last frame's
// error fed back, so that what an exchange changes is spread over the next frames and nothing lags → lights that are
// worth little are exchanged for places that are worth more (light_exchange.h) → powers again. The powers sum to the
// map's total a channel.
//
// A black map gives lights of no power that keep their places. A map of no more atoms than lights gives a light each and
// the rest without power. Where the map has become another one (a cut), lights are placed anew; of 8 lights and fewer
// that is tried whenever the map's moments have changed by 5 %. Once lights have been placed nothing is allocated; the
// first frame with light, a cut and such a trial, a frame after a map of so few atoms, and such a map where it is another
// than before, allocate and take the time of a first frame.
class BestLights {
 public:
  // count: 1 to kMostPlacedLights
  BestLights(const PolarGrid& grid, int count, Effort first = Effort::frame);
  BestLights(BestLights&&) noexcept;
  BestLights& operator=(BestLights&&) noexcept;
  ~BestLights();

  // map: of the grid given. Progressive, with parents; a light keeps its id while it keeps its place. The lights stay
  // valid until the next call.
  std::span<const DirectionalLight> process(const PolarMap& map);
  // The last map's: what its lights sum to.
  [[nodiscard]] Rgbd total_illuminance() const noexcept;
  // Forgets the last frame's error (a gap, another camera); lights keep their places.
  void reset() noexcept;

  // What the last frame did.
  struct Report {
    int exchanges = 0;
    double feedback = 0;  // share of the last frame's error that was kept, 0 to 0.9
  };
  [[nodiscard]] Report report() const noexcept;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// The lights of one map by itself. Above kMostPlacedLights they are median cut's (lighting/decomposition/median_cut.h):
// there placing costs more than it gains. count: 1 to 100,000
std::vector<DirectionalLight> best_lights(const PolarMap& map, int count);

}  // namespace lightwell
