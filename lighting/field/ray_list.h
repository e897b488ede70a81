// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "lighting/field/field_kernel/kernel.h"

namespace lightwell {

// Memory for the rays that kernels read and write, kept from one use to the next.
class RayList {
 public:
  // Room for so many, one more, and the lanes behind the last.
  void reserve(std::size_t count) {
    if (count + 1 + field_kernel::kLanes <= room_) return;
    room_ = count + 1 + field_kernel::kLanes;
    values_.assign(5 * room_, 0.0f);
  }
  [[nodiscard]] field_kernel::Rays rays() {
    float* first = values_.data();
    return {first, first + room_, first + 2 * room_, first + 3 * room_, first + 4 * room_};
  }
  [[nodiscard]] field_kernel::Rays rays_from(std::size_t at) {
    const field_kernel::Rays all = rays();
    return {all.x + at, all.y + at, all.red + at, all.green + at, all.blue + at};
  }
  // Fills the last lanes behind `count` rays; returns how many there are then.
  int pad(int count) {
    const field_kernel::Rays all = rays();
    for (; count % field_kernel::kLanes != 0; ++count) {
      all.x[count] = all.y[count] = field_kernel::kNowhere;
      all.red[count] = all.green[count] = all.blue[count] = 0;
    }
    return count;
  }

 private:
  std::vector<float> values_;  // [x, y, R, G, B][room]
  std::size_t room_ = 0;
};

}  // namespace lightwell
