// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "lighting/decomposition/light_powers.h"

namespace lightwell {

// Takes lights away where they are worth least and puts them where they are worth most. Both worths are exact: what the
// quadratic form ½ wᵀGw − wᵀb loses or gains with all other powers free to follow, from the inverse of G and its Schur
// complements; each exchange changes them for the next by rank-one updates.
class LightExchange {
 public:
  struct Options {
    int most = 1;               // exchanges
    double hysteresis = 0.1;    // of what the light that goes is worth
    double threshold = 1e-5;    // of what all lights are worth
    double least_distance = 0;  // between places that are taken in one call
  };
  struct Pair {
    int light;
    int place;  // index of the candidate
  };

  LightExchange(int lights, int most_places);

  // Of all lights at their best powers for b: what each is worth, Σ returned. Lights without power are worth nothing.
  double weigh(const LightPowers& powers, std::span<const double> w, const LightPowers::Dark& dark) noexcept;
  [[nodiscard]] std::span<const double> worth() const { return worth_; }

  // weigh first. places: at most most_places; rest[c]: what b has at place c. The pairs stay valid until the next call.
  std::span<const Pair> choose(std::span<const Vec3d> lights, std::span<const double> w,
                               std::span<const Vec3d> places, std::span<const double> rest,
                               const Options& options) noexcept;

 private:
  void price_lights(double hysteresis) noexcept;
  void remove(int i) noexcept;
  void insert(int c, int i, std::span<const Vec3d> places) noexcept;

  int size_, stride_, most_places_;
  int places_ = 0;
  std::vector<double> inverse_;  // of the lights with power, zero rows elsewhere
  std::vector<double> worth_;
  double all_worth_ = 0;
  std::vector<double> kernel_, by_inverse_;    // [places][stride]: k(place, light), and times the inverse
  std::vector<double> residual_, complement_;  // a place
  std::vector<double> w_, column_, of_places_;
  std::vector<double> step_, inverse_pivot_, price_;  // a light: what its going changes
  std::vector<char> lit_, fresh_, taken_;
  std::vector<Pair> pairs_;
};

}  // namespace lightwell
