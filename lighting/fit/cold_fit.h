// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lighting/fit/fit_observations.h"
#include "lighting/fit/light_search.h"

namespace lightwell {

// A number of lights without a guess: pursuit with exchanges and random starts, which compete in ever fewer and finer
// descents. All but the last happen on the probe's harmonics, at a third of the cost, where no shadow is fitted.
class ColdFit {
 public:
  enum class Effort {
    quick,    // 32 starts of which the best six go on: four lights in about 4 ms
    thorough  // 64 starts that all go to their ends
  };
  // faces and search, which is of these faces, outlive it.
  ColdFit(const FaceObservations& faces, LightSearch& search);
  // After faces has changed.
  void observations_changed() noexcept;

  struct Found {
    LightsTrial trial;  // the best
    int starts = 0;     // random ones that went to their ends
    int optima = 0;     // different ones among them: costs more than 2 % apart
  };
  Found fit(int lights, Effort effort) noexcept;

 private:
  static constexpr std::size_t kMostStarts = 64;
  void keep_best(std::size_t count) noexcept;
  [[nodiscard]] int different() const noexcept;

  const FaceObservations& faces_;
  LightSearch& fine_;
  BandObservations bands_;
  LightSearch coarse_;
  std::array<LightsTrial, kMostStarts + 1> trials_;
  std::size_t count_ = 0;
};

}  // namespace lightwell
