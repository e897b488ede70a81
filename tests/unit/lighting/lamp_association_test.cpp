// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/lamp_association.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>
#include <vector>

#include "lighting/field/located_lamps.h"

namespace lightwell {
namespace {

constexpr double kSigma = 0.2 * kPi / 180;
constexpr double kCandela = 500;

class Stage {
 public:
  Stage(std::vector<Vec3d> probes, std::vector<Vec3d> lamps)
      : probes_(std::move(probes)), lamps_(std::move(lamps)) {
    std::mt19937 random(5);
    std::normal_distribution<double> error(0, kSigma);
    for (const Vec3d& probe : probes_) {
      sightings_.emplace_back();
      for (const Vec3d& lamp : lamps_) {
        const Vec3d toward = lamp - probe;
        LampSighting sighting;
        sighting.direction = toward.normalized();
        const Vec3d across = sighting.direction.unitOrthogonal();
        sighting.direction =
            (sighting.direction + error(random) * across + error(random) * sighting.direction.cross(across))
                .normalized();
        sighting.illuminance = Rgbd::Constant(kCandela / toward.squaredNorm());
        sightings_.back().push_back(sighting);
      }
    }
    for (std::size_t n = 0; n < probes_.size(); ++n) seen_.push_back({probes_[n], true, kPi, sightings_[n]});
  }
  // What one probe does not tell.
  void drop(std::size_t probe, std::size_t sighting) {
    sightings_[probe].erase(sightings_[probe].begin() + static_cast<std::ptrdiff_t>(sighting));
    seen_[probe].lamps = sightings_[probe];
  }
  void turn_toward(std::size_t probe, std::size_t sighting, const Vec3d& place) {
    sightings_[probe][sighting].direction = (place - probes_[probe]).normalized();
  }
  [[nodiscard]] std::vector<LocatedLamp> located() const { return locate_lamps(seen_, kSigma); }
  void expect_all_located(const std::vector<LocatedLamp>& found) const {
    ASSERT_EQ(found.size(), lamps_.size());
    for (const Vec3d& lamp : lamps_) {
      const bool any = std::any_of(found.begin(), found.end(), [&](const LocatedLamp& f) {
        return f.location.is_near() && (f.location.position - lamp).norm() < 0.05 * lamp.norm() &&
               std::abs(f.intensity[0] / kCandela - 1) < 0.1;
      });
      EXPECT_TRUE(any) << lamp.transpose();
    }
  }

 private:
  std::vector<Vec3d> probes_, lamps_;
  std::vector<std::vector<LampSighting>> sightings_;
  std::vector<ProbeSightings> seen_;
};

const std::vector<Vec3d> kTwo = {{0, 1, 0}, {1, 1, 0}};
const std::vector<Vec3d> kThree = {{0, 1, 0}, {1, 1, 0}, {0.5, 1, 0.8}};
const std::vector<Vec3d> kFour = {{0, 1, 0}, {1, 1, 0}, {0.5, 1.5, -0.6}, {0.3, 0.4, 0.7}};

// Equal lamps in the plane of two probes cross in two ways, both as good: neither is claimed. A third probe tells.
TEST(LampAssociation, WhatCrossesInTwoWaysIsNotClaimed) {
  const std::vector<Vec3d> lamps = {{0, 3, 0}, {0.8, 3, 0}};
  const auto two = Stage(kTwo, lamps).located();
  EXPECT_EQ(two.size(), 4u);
  for (const LocatedLamp& lamp : two) {
    EXPECT_FALSE(lamp.location.is_near());
    EXPECT_TRUE(lamp.ambiguous);
    EXPECT_EQ(lamp.location.distance().near_m, 0);
  }
  const Stage three(kThree, lamps);
  three.expect_all_located(three.located());
}

TEST(LampAssociation, LampsOutOfLineAreToldByTwo) {
  const Stage stage(kTwo, {{0, 3, 0.3}, {0.8, 2.6, -0.9}, {-1, 2, 1.5}});
  stage.expect_all_located(stage.located());
}

TEST(LampAssociation, RowsAndGridsAreToldByProbesOutOfLine) {
  const Stage row(kThree, {{-1.2, 3, 0.3}, {-0.4, 3, 0.3}, {0.4, 3, 0.3}, {1.2, 3, 0.3}});
  row.expect_all_located(row.located());
  std::vector<Vec3d> lamps;
  for (int i = 0; i < 8; ++i) lamps.emplace_back(0.8 * (i % 3) - 0.8, 1 + 0.8 * (i / 3), -3);
  const Stage grid(kFour, lamps);
  grid.expect_all_located(grid.located());
}

TEST(LampAssociation, TwoInOneLineShareASighting) {
  // The first probe sees both as one, twice as bright as the nearer alone would be at that place.
  const Vec3d near(0.3, 2, 0.4), far = kFour[0] + 1.8 * (near - kFour[0]);
  Stage stage(kFour, {near, far});
  stage.drop(0, 1);
  const auto found = stage.located();
  ASSERT_EQ(found.size(), 2u);
  for (const LocatedLamp& lamp : found) EXPECT_TRUE(lamp.location.is_near());
}

TEST(LampAssociation, ALampThatAThirdProbeDoesNotSeeIsNoLampOfTwo) {
  Stage stage(kThree, {{0.2, 3, 0.3}});
  stage.drop(2, 0);
  for (const LocatedLamp& lamp : stage.located()) EXPECT_FALSE(lamp.location.is_near());
}

TEST(LampAssociation, NothingToSee) {
  EXPECT_TRUE(locate_lamps({}, kSigma).empty());
  EXPECT_TRUE(Stage(kTwo, {}).located().empty());
}

}  // namespace
}  // namespace lightwell
