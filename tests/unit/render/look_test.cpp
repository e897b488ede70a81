// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/look.h"

#include <gtest/gtest.h>

#include "interface/atomic_file.h"
#include "render/false_colour.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/render/render_fixture.h"

namespace lightwell {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)
using render::Adaptation;
using render::Display;
using render::FalseColour;
using render::Look;
using render::ToneMap;

TEST(Adaptation, AStepWithinTheLimitIsFollowedExponentially) {
  Adaptation a;
  a.follow(0, 1, 0.04);
  EXPECT_EQ(a.average_cd_m2(), 1);
  const double step = 1.9 * std::log(2.0);
  a.follow(step, 1, 0.1);
  EXPECT_NEAR(std::log(a.average_cd_m2()), step * (1 - std::exp(-0.1 / 0.4)), 1e-12);
  a.follow(step, 1, 0);
  EXPECT_NEAR(std::log(a.average_cd_m2()), step * (1 - std::exp(-0.1 / 0.4)), 1e-12) << "no time went by";
}

TEST(Adaptation, ACutIsFollowedAtOnce) {
  for (const double sign : {1.0, -1.0}) {
    Adaptation a;
    a.follow(0, 0, 0.04);
    a.follow(sign * 2.1 * std::log(2.0), 5, 0.001);
    EXPECT_NEAR(std::log2(a.average_cd_m2()), sign * 2.1, 1e-12);
    EXPECT_NEAR(std::log(a.white_cd_m2()), 5, 1e-12);
  }
}

// A picture of one colour, as codes. Look with an exposure shows radiance whatever else is in the picture.
class Looks : public Rendering {
 protected:
  static render::DisplayPicture shown(const Look& look, const Rgb& radiance, int width = 8, int height = 8) {
    Scene scene;
    add_ground(scene, lambertian(Rgb::Ones()), false, 50);
    render::RendererOptions options;
    options.width = width;
    options.height = height;
    auto renderer = render::Renderer::create(scene, options);
    EXPECT_TRUE(renderer.ok()) << renderer.error().message;
    EXPECT_TRUE(renderer->render(light_set({{Vec3f::UnitY(), radiance * static_cast<float>(kPi)}}),
                                 camera_at({0, 3, 0.01f}, {0, 0, 0})));
    renderer->set_look(look);
    renderer->tone_map(0.04);
    return renderer->display();
  }
  static void expect_codes(const render::DisplayPicture& p, const Rgb& codes) {
    // Rounding to 8 bits, and the G-buffer's half floats.
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(p.rgba[static_cast<std::size_t>(c)], 255 * codes[c], 1.0) << c;
  }
};

TEST_F(Looks, ReinhardAtAnExposureIsEquationFour) {
  // EV 10 meters 128 cd/m² as middle grey; white is five stops above.
  Look look;
  look.exposure_ev100 = 10;
  for (const double luminance : {20.0, 128.0, 1000.0, 4096.0}) {
    const double l = 0.18 * luminance / 128;
    const double white = 0.18 * 32;
    const double display = l * (1 + l / (white * white)) / (1 + l);
    const double code = 1.055 * std::pow(display, 1 / 2.4) - 0.055;
    expect_codes(shown(look, Rgb::Constant(static_cast<float>(luminance))),
                 Rgb::Constant(static_cast<float>(code)));
  }
  expect_codes(shown(look, Rgb::Constant(4096)), Rgb::Ones());
}

TEST_F(Looks, TransferFunctionsAreTheStandards) {
  Look look;
  look.operation = ToneMap::none;
  const Rgb radiance(0.5f, 0.01f, 0.002f);
  look.display = Display::linear;
  expect_codes(shown(look, radiance), radiance);
  look.display = Display::rec709;
  expect_codes(shown(look, radiance), Rgb(1.099f * std::pow(0.5f, 0.45f) - 0.099f, 0.045f, 0.009f));
  look.display = Display::srgb;
  expect_codes(shown(look, radiance),
               Rgb(0.7354f, 1.055f * std::pow(0.01f, 1 / 2.4f) - 0.055f, 12.92f * 0.002f));
}

TEST_F(Looks, WithoutAnOperatorTheSaturatingLuminanceIsWhite) {
  Look look;
  look.operation = ToneMap::none;
  look.display = Display::linear;
  look.exposure_ev100 = 3;  // 1.2 · 8 cd/m²
  expect_codes(shown(look, Rgb(9.6f, 4.8f, 0.96f)), Rgb(1, 0.5f, 0.1f));
}

TEST_F(Looks, FalseColourOfLuminanceIsTheScales) {
  Look look;
  look.false_colour = FalseColour::luminance;
  const render::FalseColourScale scale{FalseColour::luminance};
  for (const float luminance : {0.05f, 1.0f, 300.0f, 2e5f}) {
    const auto p = shown(look, Rgb::Constant(luminance));
    const render::Rgb8 expected = scale.colour(std::log2(luminance));
    // A table of 1024 colours over 8 decades: a step is at most 255 · 8 / 1024 codes.
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(p.rgba[c], expected[c], 2.5) << luminance;
  }
  const auto below = shown(look, Rgb::Constant(1e-4f));
  EXPECT_EQ(below.rgba[0] + below.rgba[1] + below.rgba[2], 0);
  const auto above = shown(look, Rgb::Constant(1e7f));
  EXPECT_EQ(above.rgba[0] + above.rgba[1] + above.rgba[2], 3 * 255);
}

TEST_F(Looks, FalseColourInStopsCountsFromMiddleGreyAtTheExposure) {
  Look look;
  look.false_colour = FalseColour::stops;
  look.exposure_ev100 = 6;  // middle grey is 8 cd/m²
  const render::FalseColourScale scale{FalseColour::stops};
  for (const int stop : {-8, -3, 0, 1, 8}) {
    const auto p = shown(look, Rgb::Constant(8 * std::exp2(static_cast<float>(stop))));
    const render::Rgb8 expected = scale.colour(stop);
    for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(p.rgba[c], expected[c]) << stop;
  }
  EXPECT_EQ(scale.colour(0), (render::Rgb8{119, 119, 119}));
}

TEST(LooksOfFiles, APngSaysWhichCurveItsCodesHave) {
  const TemporaryFolder folder;
  const auto holds = [&](Display display, const std::string& chunk) {
    EXPECT_TRUE(render::write_png(folder.path() / "a.png", {1, 1, {1, 2, 3, 255}, display}));
    return read_text_file(folder.path() / "a.png").value().find(chunk) != std::string::npos;
  };
  EXPECT_TRUE(holds(Display::srgb, "sRGB"));
  // gAMA is 100000 times the exponent of the codes, big-endian.
  EXPECT_TRUE(holds(Display::linear, std::string("gAMA\x00\x01\x86\xA0", 8)));
  EXPECT_TRUE(holds(Display::rec709, std::string("gAMA\x00\x00\xC7\x38", 8)));
  EXPECT_FALSE(holds(Display::rec709, "sRGB"));
}

TEST(FalseColourScale, EveryStopHasItsOwnColourAndBoundsAreBlackAndWhite) {
  const render::FalseColourScale scale{FalseColour::stops};
  for (int a = -8; a <= 8; ++a) {
    for (int b = a + 1; b <= 8; ++b) EXPECT_NE(scale.colour(a), scale.colour(b)) << a << " " << b;
    EXPECT_EQ(scale.colour(a + 0.45), scale.colour(a - 0.45));
  }
  EXPECT_EQ(scale.colour(-9), (render::Rgb8{0, 0, 0}));
  EXPECT_EQ(scale.colour(9), (render::Rgb8{255, 255, 255}));
  EXPECT_EQ(scale.colour(std::nan("")), (render::Rgb8{0, 0, 0}));
}

TEST_F(Looks, TheLegendStandsInTheUpperRightCorner) {
  for (const FalseColour kind : {FalseColour::luminance, FalseColour::stops}) {
    Look look;
    look.false_colour = kind;
    look.exposure_ev100 = 0;
    const auto p = shown(look, Rgb::Constant(1), 200, 150);
    const render::Legend legend = render::make_legend({kind}, 150);
    ASSERT_GT(legend.width, 0);
    for (int y = 0; y < legend.height; ++y)
      for (int x = 0; x < legend.width; ++x)
        for (int c = 0; c < 3; ++c)
          ASSERT_EQ(p.rgba[static_cast<std::size_t>(4 * (y * 200 + 200 - legend.width + x) + c)],
                    legend.rgba[static_cast<std::size_t>(4 * (y * legend.width + x) + c)]);
  }
  EXPECT_EQ(render::make_legend({FalseColour::stops}, 50).width, 0) << "numbers of less than five pixels";
}

}  // namespace
}  // namespace lightwell
