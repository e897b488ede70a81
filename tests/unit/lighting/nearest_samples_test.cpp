// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/nearest_samples.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace lightwell {
namespace {

enum class Lay { everywhere, on_a_line, in_one_place, two_heaps };

std::vector<PlaneSample> samples_of(Lay lay, std::size_t count) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> along(0, 20);
  std::vector<PlaneSample> samples(count);
  for (PlaneSample& s : samples) {
    const float t = along(random);
    if (lay == Lay::everywhere) s.at = {t, along(random)};
    if (lay == Lay::on_a_line) s.at = {t, 0.5f * t};
    if (lay == Lay::in_one_place) s.at = {3, 4};
    if (lay == Lay::two_heaps) s.at = {t < 10 ? 0.01f * t : 500 + 0.01f * t, 0.01f * along(random)};
  }
  return samples;
}

TEST(NearestSamples, AreThoseOfASearchThroughAll) {
  for (const Lay lay : {Lay::everywhere, Lay::on_a_line, Lay::in_one_place, Lay::two_heaps})
    for (const std::size_t count : {1u, 2u, 30u, 700u}) {
      const auto samples = samples_of(lay, count);
      NearestSamples nearest;
      nearest.build(samples);
      std::mt19937 random(8);
      std::uniform_real_distribution<float> along(-15, 35);
      for (int i = 0; i < 50; ++i) {
        const Eigen::Vector2f at(along(random), along(random));
        std::vector<float> all;
        for (const PlaneSample& s : samples) all.push_back((s.at - at).squaredNorm());
        std::sort(all.begin(), all.end());
        for (const std::size_t wanted : {1u, 4u, 19u}) {
          const auto found = nearest.find(at, wanted);
          ASSERT_GE(found.size(), std::min(wanted + 1, count));
          std::vector<float> first;
          for (std::size_t k = 0; k < std::min(wanted, count); ++k) first.push_back(found[k].square_distance);
          std::sort(first.begin(), first.end());
          for (std::size_t k = 0; k < first.size(); ++k) ASSERT_EQ(first[k], all[k]);
          if (count > wanted) {
            ASSERT_EQ(found[wanted].square_distance, all[wanted]);
          }
        }
      }
    }
}

}  // namespace
}  // namespace lightwell
