// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/luminaire/far_field.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lightwell {
namespace {

constexpr std::array<PhotometricSystem, 3> kSystems = {PhotometricSystem::c, PhotometricSystem::b,
                                                       PhotometricSystem::a};

// A table of f(direction) over all that a system can count.
template <class F>
FarField table_of(PhotometricSystem system, int horizontals, int verticals, const F& f) {
  FarField lamp;
  lamp.system = system;
  lamp.horizontal_deg.clear();
  const bool c = system == PhotometricSystem::c;
  const double h0 = c ? 0 : system == PhotometricSystem::b ? -90 : -180;
  const double h1 = c ? 360 : -h0;
  const double v0 = c ? 0 : system == PhotometricSystem::b ? -180 : -90;
  const double v1 = c ? 180 : -v0;
  for (int i = 0; i < horizontals; ++i)
    lamp.horizontal_deg.push_back(h0 + (h1 - h0) * i / (c ? horizontals : horizontals - 1));
  for (int j = 0; j < verticals; ++j) lamp.vertical_deg.push_back(v0 + (v1 - v0) * j / (verticals - 1));
  for (const double h : lamp.horizontal_deg)
    for (const double v : lamp.vertical_deg) lamp.candela.push_back(f(photometric_direction(system, {h, v})));
  return lamp;
}

double uneven(const Vec3d& d) {
  return 100 + 40 * d.x() - 25 * d.y() * d.z() + 60 * d.z() * d.z();
}

TEST(PhotometricAngles, AreInDirectionsAndBack) {
  for (const PhotometricSystem system : kSystems)
    for (double x = -0.95; x < 1; x += 0.19)
      for (double y = -0.95; y < 1; y += 0.21)
        for (double z = -0.9; z < 1; z += 0.17) {
          const Vec3d d = Vec3d(x, y, z).normalized();
          EXPECT_LT((photometric_direction(system, photometric_angles(system, d)) - d).norm(), 1e-14);
        }
}

TEST(PhotometricAngles, AxesAreThoseOfTheLampsFrame) {
  using S = PhotometricSystem;
  for (const S system : kSystems)
    EXPECT_LT((photometric_direction(system, {0, 0}) - Vec3d(0, 0, -1)).norm(), 1e-15);
  EXPECT_LT((photometric_direction(S::c, {0, 90}) - Vec3d::UnitX()).norm(), 1e-15);
  EXPECT_LT((photometric_direction(S::c, {90, 90}) - Vec3d::UnitY()).norm(), 1e-15);
  EXPECT_LT((photometric_direction(S::b, {90, 0}) - Vec3d::UnitX()).norm(), 1e-15);
  EXPECT_LT((photometric_direction(S::b, {0, 90}) - Vec3d::UnitY()).norm(), 1e-15);
  EXPECT_LT((photometric_direction(S::a, {90, 0}) - Vec3d::UnitX()).norm(), 1e-15);
  EXPECT_LT((photometric_direction(S::a, {0, 90}) - Vec3d::UnitY()).norm(), 1e-15);
}

TEST(FarField, AnEvenLampSendsFourPiTimesItsIntensity) {
  for (const PhotometricSystem system : kSystems)
    EXPECT_NEAR(luminous_flux(table_of(system, 7, 9, [](const Vec3d&) { return 3.0; })), 12 * kPi, 1e-12);
  FarField round;
  round.vertical_deg = {0, 30, 180};
  round.candela = {3, 3, 3};
  EXPECT_NEAR(luminous_flux(round), 12 * kPi, 1e-12);
}

// ∫ is exact for what interpolation gives: against brute force over it.
TEST(FarField, FluxIsTheIntegralOfWhatIsInterpolated) {
  for (const PhotometricSystem system : kSystems) {
    const FarField lamp = table_of(system, 8, 7, uneven);
    double sum = 0;
    constexpr int kRows = 600;
    for (int i = 0; i < kRows; ++i) {
      const double cosine = 1 - (2 * i + 1.0) / kRows, sine = std::sqrt(1 - cosine * cosine);
      for (int j = 0; j < 2 * kRows; ++j) {
        const double turn = kPi * (j + 0.5) / kRows;
        sum += intensity(lamp, Vec3d(sine * std::cos(turn), sine * std::sin(turn), cosine));
      }
    }
    EXPECT_NEAR(luminous_flux(lamp) / (sum * 4 * kPi / (2.0 * kRows * kRows)), 1, 2e-5);
  }
}

TEST(FarField, TabulatedAnglesAreExactThroughDirectionsToo) {
  for (const PhotometricSystem system : kSystems) {
    const FarField lamp = table_of(system, 9, 11, uneven);
    for (std::size_t h = 0; h < lamp.horizontal_deg.size(); ++h)
      for (std::size_t v = 0; v < lamp.vertical_deg.size(); ++v) {
        const PhotometricAngles angles{lamp.horizontal_deg[h], lamp.vertical_deg[v]};
        EXPECT_EQ(intensity(lamp, angles), lamp.at(h, v));
        EXPECT_NEAR(intensity(lamp, photometric_direction(system, angles)), lamp.at(h, v), 1e-9);
      }
  }
}

TEST(FarField, TheCircleClosesBetweenTheLastPlaneAndTheFirst) {
  FarField lamp;
  lamp.horizontal_deg = {0, 90, 180, 270};
  lamp.vertical_deg = {0, 180};
  lamp.candela = {10, 10, 20, 20, 30, 30, 40, 40};
  EXPECT_DOUBLE_EQ(intensity(lamp, PhotometricAngles{315, 90}), 25);
  EXPECT_DOUBLE_EQ(intensity(lamp, PhotometricAngles{-45, 90}), 25);
  EXPECT_DOUBLE_EQ(intensity(lamp, PhotometricAngles{360, 90}), 10);
  EXPECT_DOUBLE_EQ(intensity(lamp, PhotometricAngles{359.99999999, 90}), 10 + 30 * 1e-8 / 90);
}

TEST(FarField, IsDarkBeyondItsAnglesAndBehindTheSurface) {
  FarField lamp;
  lamp.vertical_deg = {0, 90};
  lamp.candela = {100, 100};
  EXPECT_EQ(intensity(lamp, Vec3d(0, 0.1, 1).normalized()), 0);
  EXPECT_NEAR(intensity(lamp, Vec3d::UnitX()), 100, 1e-9) << "the last angle itself";
  EXPECT_NEAR(illuminance(lamp, Vec3d(0, 0, -2), Vec3d::UnitZ()), 25, 1e-12);
  EXPECT_NEAR(illuminance(lamp, Vec3d(0, 2, -2), Vec3d::UnitZ()), 100 / 8.0 * std::sqrt(0.5), 1e-12);
  EXPECT_EQ(illuminance(lamp, Vec3d(0, 0, -2), -Vec3d::UnitZ()), 0);
  EXPECT_EQ(illuminance(lamp, Vec3d::Zero(), Vec3d::UnitZ()), 0) << "in the lamp's centre";
}

}  // namespace
}  // namespace lightwell
