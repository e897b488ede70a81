// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/ray_consistency.h"

#include <gtest/gtest.h>

#include "lighting/field/direction_estimator.h"
#include "tests/support/analytic_fields.h"

namespace lightwell {
namespace {

// What is said of probes in a field, each seen at its place as `seen` has it.
struct Said {
  std::vector<DoubtfulProbe> doubtful;
  double close_difference = 0;
};
using SeenByProbe = std::function<Rgbd(std::size_t probe, const Vec3d& at, const Vec3d& toward)>;

Said said_of(const SeenByProbe& seen, const std::vector<Vec3d>& places, const std::vector<Vec3d>& stated) {
  const FieldGrid grid{{16, 16, 16}, Vec3d::Zero(), Vec3d::Ones()};
  const DirectionBins bins(LatLongProbe{}, 64, 32, 600, 1);
  RayConsistency consistency(places.size());
  DirectionEstimator estimator(grid, stated, FieldMethod::best, 9);
  for (std::size_t d = 0; d < bins.directions().size(); d += 6) {
    std::vector<Rgb> radiance;
    for (std::size_t p = 0; p < places.size(); ++p)
      radiance.push_back(seen(p, places[p], bins.directions()[d].direction).cast<float>());
    estimator.check(bins.directions()[d], radiance, consistency);
  }
  return {consistency.doubtful(), consistency.close_difference()};
}
SeenByProbe all_see(const test::AnalyticField& field) {
  return [field](std::size_t, const Vec3d& at, const Vec3d& toward) { return field(at, toward); };
}

TEST(RayConsistency, ProbesOfOneFieldAreNotDoubted) {
  for (const std::size_t count : {20u, 100u, 600u}) {
    const auto places = test::random_positions(count, 5);
    for (const auto& field : {test::linear_field, test::box_of_lamps, test::beam_edge}) {
      const Said said = said_of(all_see(field), places, places);
      EXPECT_TRUE(said.doubtful.empty()) << count << " probes, " << said.doubtful.size()
                                         << " doubted, the worst " << said.doubtful.front().share;
    }
  }
}

TEST(RayConsistency, AProbeBehindSomethingIsNamed) {
  const auto places = test::random_positions(100, 6);
  const Said said = said_of(
      [](std::size_t probe, const Vec3d& at, const Vec3d& toward) -> Rgbd {
        // A black card beside probe 17 hides more than half of what it sees.
        if (probe == 17 && toward.x() > -0.2) return Rgbd::Zero();
        return test::box_of_lamps(at, toward);
      },
      places, places);
  ASSERT_EQ(said.doubtful.size(), 1u);
  EXPECT_EQ(said.doubtful[0].probe, 17u);
  EXPECT_GT(said.doubtful[0].share, 0.4);
}

TEST(RayConsistency, ProbesFromBeforeALampWasMovedAreNamed) {
  const auto places = test::random_positions(200, 7);
  const Said said = said_of(
      [](std::size_t probe, const Vec3d& at, const Vec3d& toward) -> Rgbd {
        return test::box_of_lamps(at, toward) * (probe % 50 == 3 ? 0.6 : 1.0);
      },
      places, places);
  ASSERT_EQ(said.doubtful.size(), 4u);
  for (const DoubtfulProbe& probe : said.doubtful) EXPECT_EQ(probe.probe % 50, 3u);
}

TEST(RayConsistency, RaysThatPassTogetherAndDifferAreMeasured) {
  const auto places = test::random_positions(2000, 8);
  const Said good = said_of(all_see(test::box_of_lamps), places, places);
  EXPECT_LT(good.close_difference, 0.12) << "the lamps' soft edges";
  // Every other probe saw light a third weaker: differences of .4 of their mean in half of the pairs.
  const Said changed = said_of(
      [](std::size_t probe, const Vec3d& at, const Vec3d& toward) -> Rgbd {
        return test::box_of_lamps(at, toward) * (probe % 2 == 0 ? 1.0 : 0.667);
      },
      places, places);
  EXPECT_NEAR(changed.close_difference, 0.4 * std::sqrt(0.5), 0.06);
  EXPECT_EQ(said_of(all_see(test::box_of_lamps), test::random_positions(5, 8), test::random_positions(5, 8))
                .close_difference,
            0)
      << "too few to say";
}

TEST(RayConsistency, DarknessContradictsNothing) {
  const auto places = test::random_positions(50, 9);
  const Said said =
      said_of([](std::size_t, const Vec3d&, const Vec3d&) { return Rgbd(Rgbd::Zero()); }, places, places);
  EXPECT_TRUE(said.doubtful.empty());
  EXPECT_EQ(said.close_difference, 0);
}

}  // namespace
}  // namespace lightwell
