// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lighting/field/ray_list.h"
#include "lighting/field/shear_plane.h"

namespace lightwell {

// The nearest of many places in a plane, by square bins of about two places each. For use by one thread at a time.
class NearestSamples {
 public:
  struct Neighbour {
    float square_distance;  // cells²
    std::uint32_t sample;
  };
  // samples: at least one; must outlive the searches. Memory is kept from one set to the next.
  void build(std::span<const PlaneSample> samples);
  // At least the `count` nearest, or all where there are no more; among them exactly `count` stand first, in no order,
  // and the one after them is the nearest of the rest. Valid until the next call.
  std::span<const Neighbour> find(const Eigen::Vector2f& at, std::size_t count);

  // All samples within a distance, cells, to the beginning of `to`, which has room for all samples; returns their number.
  int within(const Eigen::Vector2f& at, float distance, const field_kernel::Rays& to);

  // Side of a square that holds one sample in the mean.
  [[nodiscard]] float spacing() const;

  [[nodiscard]] std::span<const PlaneSample> samples() const { return samples_; }

 private:
  [[nodiscard]] int bin_along(int axis, float value) const;
  void gather(int x0, int x1, int y, const Eigen::Vector2f& at);
  std::span<const PlaneSample> samples_;
  std::vector<std::uint32_t> first_, order_, bin_;
  RayList sorted_;  // in the bins' order
  std::vector<Neighbour> found_;
  Eigen::Vector2f low_ = Eigen::Vector2f::Zero();
  float width_ = 1;
  std::array<int, 2> size_ = {1, 1};
};

}  // namespace lightwell
