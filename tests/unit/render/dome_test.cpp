// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/dome.h"

#include <gtest/gtest.h>

#include "tests/support/test_scene.h"

namespace lightwell {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)

constexpr int kWidth = 400;
constexpr int kHeight = 300;
const render::Sphere kDome{{0, 1, 0}, 2};

// Looks along −Z at the dome's centre from 10 m.
render::View front() {
  return render::make_view(camera_at({0, 1, 10}, {0, 1, 0}, 0.6f), kWidth, kHeight);
}

TEST(Dome, LightsStandWhereTheyComeFrom) {
  const auto markers =
      render::dome_markers(light_set({{Vec3f::UnitX(), Rgb(2, 1, 0)}, {Vec3f::UnitY(), Rgb(4, 2, 0)}}).lights,
                           kDome, front(), kWidth, kHeight);
  ASSERT_EQ(markers.size(), 2u);  // dimmest first
  // At distance 10, a metre is 150 / (10 tan 0.3) pixels.
  const float pixels = 150 / (10 * std::tan(0.3f));
  EXPECT_NEAR(markers[0].place.x(), 200 + 2 * pixels, 1e-2f);
  EXPECT_NEAR(markers[0].place.y(), 150, 1e-2f);
  EXPECT_NEAR(markers[1].place.x(), 200, 1e-2f);
  EXPECT_NEAR(markers[1].place.y(), 150 - 2 * pixels, 1e-2f);
  // Areas are as the luminances, 1 : 2, and together a disc of a twentieth of the height.
  EXPECT_NEAR(markers[1].radius_px * markers[1].radius_px, 2 * markers[0].radius_px * markers[0].radius_px,
              1e-2f);
  EXPECT_NEAR(3 * markers[0].radius_px * markers[0].radius_px, 15 * 15, 1e-2f);
  EXPECT_TRUE((markers[0].colour == Rgb(1, 0.5f, 0)).all());
}

TEST(Dome, FrontAndBackAreToldApart) {
  const auto markers = render::dome_markers(
      light_set({{Vec3f::UnitZ(), Rgb::Ones()}, {-Vec3f::UnitZ(), Rgb::Constant(2)}}).lights, kDome, front(),
      kWidth, kHeight);
  ASSERT_EQ(markers.size(), 2u);
  EXPECT_TRUE(markers[0].in_front);
  EXPECT_FALSE(markers[1].in_front);
}

TEST(Dome, WhatIsBehindTheEyeOrDarkHasNoMarker) {
  const render::View inside = render::make_view(camera_at({0, 1, 0.1f}, {0, 1, -5}), kWidth, kHeight);
  EXPECT_EQ(
      render::dome_markers(light_set({{Vec3f::UnitZ(), Rgb::Ones()}, {-Vec3f::UnitZ(), Rgb::Zero()}}).lights,
                           kDome, inside, kWidth, kHeight)
          .size(),
      0u);
  EXPECT_TRUE(render::dome_markers({}, kDome, inside, kWidth, kHeight).empty());
  EXPECT_FALSE(render::dome_lines(kDome, inside, kWidth, kHeight).empty());
}

TEST(Dome, LinesAreTheHorizonAndFourMeridians) {
  const auto lines = render::dome_lines(kDome, front(), kWidth, kHeight);
  ASSERT_EQ(lines.size(), 5u);
  for (const auto& p : lines[0]) EXPECT_NEAR(p.y(), 150, 1e-2f);  // seen from its own height
  for (std::size_t k = 1; k < 5; ++k)
    for (const auto& p : lines[k]) EXPECT_LE(p.y(), 150 + 1e-2f) << "the upper half";
}

}  // namespace
}  // namespace lightwell
