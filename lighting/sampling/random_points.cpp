// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/sampling/random_points.h"

namespace lightwell {
namespace {

class SplitMix64 {
 public:
  explicit SplitMix64(std::uint64_t seed) : state_(seed) {}

  double uniform() {
    state_ += 0x9e3779b97f4a7c15u;
    std::uint64_t x = state_;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    x ^= x >> 31;
    return static_cast<double>(x >> 11) * 0x1p-53;
  }

 private:
  std::uint64_t state_;
};

}  // namespace

std::vector<Vec2d> random_points(std::size_t count, std::uint32_t seed) {
  // Seeds in the upper half: neighbouring seeds' states are never steps of each other's sequence.
  SplitMix64 random(std::uint64_t{seed} << 32);
  std::vector<Vec2d> points(count);
  for (Vec2d& p : points) {
    p.x() = random.uniform();
    p.y() = random.uniform();
  }
  return points;
}

}  // namespace lightwell
