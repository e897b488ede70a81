// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "lighting/vector.h"

namespace lightwell {

// Energy of the absolute difference of two pictures, as a part of their mean energy: 0 for equal ones, 2 where they have
// nothing in common. Pictures: radiance of directions that stand for equal solid angles, NaN where nothing was seen;
// only what both saw counts. 0 where that is dark in both.
double picture_difference(std::span<const Rgb> a, std::span<const Rgb> b);

// Which pictures of a sequence are needed: one is redundant where it is like the last one kept and like the next, and
// where without it those two are still near each other. So the density of places never falls below a minimum, and a
// slow drift does not go unseen, for each picture is compared with one that stays.
// source: Löw et al. 2009, section 5.1
class RedundancyFilter {
 public:
  struct Limits {
    double most_difference = 0.05;  // picture_difference
    double most_spacing_m = 0.05;   // between the two that stay
  };
  explicit RedundancyFilter(const Limits& limits) : limits_(limits) {}

  // The next picture of the sequence.
  void add(const Vec3d& position_m, std::vector<Rgb> picture);
  // For every picture so far whether it is kept; the first and the last are.
  [[nodiscard]] const std::vector<bool>& kept() const { return kept_; }

 private:
  struct Picture {
    Vec3d position_m;
    std::vector<Rgb> seen;
  };
  [[nodiscard]] bool is_redundant(const Picture& picture, const Picture& next) const;
  Limits limits_;
  std::optional<Picture> last_kept_, candidate_;
  std::vector<bool> kept_;
};

}  // namespace lightwell
