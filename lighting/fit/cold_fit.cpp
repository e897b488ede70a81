// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/fit/cold_fit.h"

#include <algorithm>

namespace lightwell {
namespace {

constexpr double kCoarse = 1e-3;
constexpr double kGain = 1e-3;  // of the cost, for which an exchange is kept

bool cheaper(const LightsTrial& a, const LightsTrial& b) {
  return a.cost < b.cost;
}

}  // namespace

ColdFit::ColdFit(const FaceObservations& faces, LightSearch& search)
    : faces_(faces), fine_(search), coarse_(bands_, kCoarse) {}

void ColdFit::observations_changed() noexcept {
  bands_.set(faces_);
}

void ColdFit::keep_best(std::size_t count) noexcept {
  std::sort(trials_.begin(), trials_.begin() + static_cast<std::ptrdiff_t>(count_), cheaper);
  count_ = std::min(count, count_);
}

int ColdFit::different() const noexcept {
  int optima = 0;
  double last = -1;
  for (std::size_t i = 0; i < count_; ++i) {
    if (last >= 0 && trials_[i].cost <= last * 1.02) continue;
    last = trials_[i].cost;
    ++optima;
  }
  return optima;
}

ColdFit::Found ColdFit::fit(int lights, Effort effort) noexcept {
  // The shadow is not in the harmonics.
  LightSearch& search = faces_.with_shadow() ? fine_ : coarse_;
  const bool quick = effort == Effort::quick;
  Found found;
  std::uint64_t random = 1;  // the same starts for every map: the same map, the same lights
  count_ = quick ? 32 : kMostStarts;
  for (std::size_t i = 0; i < count_; ++i) {
    trials_[i] = random_directions(lights, random);
    search.refine(trials_[i], quick ? 5 : 40);
  }
  if (quick) {
    keep_best(6);
    for (std::size_t i = 0; i < count_; ++i) search.refine(trials_[i], 12);
  } else {
    found.starts = static_cast<int>(count_);
    keep_best(count_);
    found.optima = different();
    keep_best(12);
  }
  LightsTrial& pursued = trials_[count_++];
  pursued = {};
  search.solve_powers(pursued);
  for (int k = 0; k < lights; ++k) pursued = search.with_one_more(pursued);
  search.exchange(pursued, quick ? 1 : 3, kGain);

  for (std::size_t i = 0; i < count_; ++i) fine_.refine(trials_[i], 6);
  keep_best(quick ? 6 : 8);
  for (std::size_t i = 0; i < count_; ++i) fine_.refine(trials_[i], 15);
  keep_best(1);
  fine_.exchange(trials_[0], quick ? 1 : 3, kGain);
  fine_.refine(trials_[0], 60);
  found.trial = trials_[0];
  return found;
}

}  // namespace lightwell
