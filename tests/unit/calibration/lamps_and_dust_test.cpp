// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

#include "calibration/photometric/flat_fit.h"
#include "calibration/photometric/take_level.h"

namespace lightwell {
namespace {

constexpr int kWidth = 161, kHeight = 120;
constexpr double kNoise = 1 / 8.0;  // codes, of the mean of 64 frames with one code each

std::size_t at(int x, int y) {
  return static_cast<std::size_t>(y * kWidth + x);
}

// A logarithmic sensor under an even sky, patterned by columns and pixels.
struct Probe {
  Response response{LogResponse{800, 208, 0.05}, 12, 0, 4095, 10000};
  Lens lens;
  std::vector<double> pattern;
  std::mt19937 random{7};

  Probe() {
    lens.image_size = {kWidth, kHeight};
    lens.focal = Vec2d(38, 38);
    lens.center = Vec2d(80, 59.5);
    lens.max_theta_rad = kPi / 2;
    std::normal_distribution<double> normal;
    std::vector<double> column;
    for (int x = 0; x < kWidth; ++x) column.push_back(1.5 * normal(random));
    for (std::size_t i = 0; i < at(0, kHeight); ++i) pattern.push_back(column[i % kWidth] + normal(random));
  }
  [[nodiscard]] calibration::MeanFrame take(double level) {
    std::normal_distribution<double> normal;
    calibration::MeanFrame out;
    out.format = {kWidth, kHeight, PixelFormat::mono12};
    out.frames = 64;
    out.exposure_us = 10000;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        const double theta = std::min(lens.theta_rad(Vec2d(x, y)), lens.max_theta_rad);
        out.code.push_back(response.code(level * (1 - 0.1 * theta * theta)) + pattern[at(x, y)] +
                           kNoise * normal(random));
        out.sigma.push_back(1);
      }
    return out;
  }
  // Root mean square error of the offsets within 85°, `where` or elsewhere.
  [[nodiscard]] double offset_error(const FlatField& found, const std::set<std::size_t>& where,
                                    bool elsewhere) const {
    double square = 0, n = 0;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x)
        if (lens.theta_rad(Vec2d(x, y)) < 85 * kPi / 180 && where.contains(at(x, y)) != elsewhere) {
          square += std::pow(static_cast<double>(found.offset_codes[at(x, y)]) - pattern[at(x, y)], 2);
          ++n;
        }
    return std::sqrt(square / n);
  }
};

// A lamp of 30 pixels with a glow about it, a dark piece of dust of 20.
std::set<std::size_t> add_lamp_and_dust(calibration::MeanFrame& mean) {
  std::set<std::size_t> touched;
  for (int y = 36; y < 52; ++y)
    for (int x = 56; x < 74; ++x) {
      const double off = std::max({0.0, 60.0 - x, x - 65.0, 42.0 - y, y - 46.0});  // six by five
      if (off < 4) mean.code[at(x, y)] += 600 * std::pow(0.1, off), touched.insert(at(x, y));
    }
  for (int y = 80; y < 84; ++y)
    for (int x = 95; x < 100; ++x) mean.code[at(x, y)] -= 80, touched.insert(at(x, y));
  return touched;
}

TEST(LampsAndDust, AreMaskedAndTheOffsetsElsewhereAreAsGoodAsWithout) {
  Probe probe;
  calibration::MeanFrame even = probe.take(500);
  const auto plain = calibration::fit_flat_field({{"plain", even}}, std::nullopt, probe.lens, probe.response);
  ASSERT_TRUE(plain) << plain.error().message;
  EXPECT_EQ(plain->masked_pixels, 0U);
  const std::set<std::size_t> touched = add_lamp_and_dust(even);
  const auto fit = calibration::fit_flat_field({{"lamp", even}}, std::nullopt, probe.lens, probe.response);
  ASSERT_TRUE(fit) << fit.error().message;
  EXPECT_GE(fit->masked_pixels, 50U);  // all of the two, and no more than a few pixels about them
  EXPECT_LT(fit->masked_pixels, 450U);
  EXPECT_EQ(report_to_json(*fit).at("masked_pixels"), fit->masked_pixels);
  // The bound of the plain case: noise of each pixel, and what all share, with 99.9 % of χ² of one degree.
  EXPECT_LT(probe.offset_error(fit->flat, touched, true),
            std::sqrt(1.05 * std::pow(fit->offset_sigma_codes, 2) +
                      10.8 * std::pow(fit->offset_shared_sigma_codes, 2)));
  // Where they are, an offset is its column's: the pixels' own part is missing, a code, and the shared one.
  EXPECT_LT(probe.offset_error(fit->flat, touched, false), 1.3 + 3.3 * fit->offset_shared_sigma_codes);
  for (double theta = 0.2; theta < 1.5; theta += 0.2)  // a thousandth: 0.2 codes of 208 an e-fold
    EXPECT_NEAR(fit->flat.transmission(theta), plain->flat.transmission(theta), 1e-3);
}

TEST(LampsAndDust, HotPixelsAndLinesArePattern) {
  Probe probe;
  for (int k = 0; k < 40; ++k) probe.pattern[at(30 + 7 * (k % 14), 30 + 20 * (k / 14))] += 900;
  for (int y = 20; y < 100; ++y) probe.pattern[at(90, y)] += 60;
  const auto fit =
      calibration::fit_flat_field({{"even", probe.take(500)}}, std::nullopt, probe.lens, probe.response);
  ASSERT_TRUE(fit) << fit.error().message;
  EXPECT_EQ(fit->masked_pixels, 0U);
  EXPECT_LT(probe.offset_error(fit->flat, {}, true),
            std::sqrt(1.05 * std::pow(fit->offset_sigma_codes, 2) +
                      10.8 * std::pow(fit->offset_shared_sigma_codes, 2)));
}

TEST(LampsAndDust, DoNotMatterWhereDarknessOrAnotherTakeTellsTheOffset) {
  Probe probe;
  const calibration::MeanFrame dark = probe.take(0), clean = probe.take(50);
  calibration::MeanFrame lamp = probe.take(500);
  const std::set<std::size_t> touched = add_lamp_and_dust(lamp);
  const auto from_dark = calibration::fit_flat_field({{"lamp", lamp}}, dark, probe.lens, probe.response);
  ASSERT_TRUE(from_dark) << from_dark.error().message;
  EXPECT_GE(from_dark->masked_pixels, 50U);
  const auto two = calibration::fit_flat_field({{"lamp", lamp}, {"clean", clean}}, std::nullopt, probe.lens,
                                               probe.response);
  ASSERT_TRUE(two) << two.error().message;
  EXPECT_EQ(two->takes[1].masked_pixels, 0U);
  // Of one take there, 1/8 of a code in 50 pixels or more, and what all share or the darkness' own mean, √161 columns.
  for (const auto& fit : {from_dark, two})
    EXPECT_LT(probe.offset_error(fit->flat, touched, false),
              0.2 + 3.3 * std::max(0.15, fit->offset_shared_sigma_codes));
}

TEST(LampsAndDust, TooManyAreRefusedWithTheirShare) {
  Probe probe;
  calibration::MeanFrame even = probe.take(500);
  for (int y = 30; y < 90; ++y)
    for (int x = 60; x < 80; ++x) even.code[at(x, y)] += 300;  // 1200 of some 10⁴
  const auto fit =
      calibration::fit_flat_field({{"even.mkv", even}}, std::nullopt, probe.lens, probe.response);
  ASSERT_FALSE(fit);
  EXPECT_EQ(fit.error().kind, ErrorKind::bad_input);
  EXPECT_EQ(fit.error().message.rfind("even.mkv: lamps, dust", 0), 0U) << fit.error().message;
}

TEST(TakeLevel, ACappedTakeIsNoEvenSceneAndABrightOneIsNotDark) {
  Probe probe;
  const auto refused = [&](const calibration::MeanFrame& even,
                           const std::optional<calibration::MeanFrame>& dark, const char* says) {
    const auto fit = calibration::fit_flat_field({{"even.mkv", even}}, dark, probe.lens, probe.response);
    ASSERT_FALSE(fit) << says;
    EXPECT_EQ(fit.error().kind, ErrorKind::bad_input);
    EXPECT_EQ(fit.error().message.rfind(says, 0), 0U) << fit.error().message;
  };
  calibration::MeanFrame bright = probe.take(50);
  bright.name = "bright.mkv";
  refused(probe.take(0), std::nullopt, "even.mkv: too dark for an even scene");
  refused(probe.take(500), bright, "bright.mkv: not dark");
  bright.format.width = 160;
  refused(probe.take(500), bright, "bright.mkv: frames of 160x120");
  // A toe that is a few codes wrong is darkness all the same.
  calibration::MeanFrame dark = probe.take(0);
  for (double& code : dark.code) code += 8;
  const auto fit =
      calibration::fit_flat_field({{"even.mkv", probe.take(500)}}, dark, probe.lens, probe.response);
  EXPECT_TRUE(fit) << fit.error().message;
}

TEST(TakeLevel, AFieldWithoutPixelsIsNamed) {
  Lens lens = Probe().lens;
  EXPECT_TRUE(calibration::check_field(lens, true));
  lens.max_theta_rad = 0.001 * kPi / 180;
  const Status few = calibration::check_field(lens, false);
  ASSERT_FALSE(few);
  EXPECT_EQ(few.error().message.rfind("max_theta_deg = 0.001 with focal = [38, 38]", 0), 0U)
      << few.error().message;
}

}  // namespace
}  // namespace lightwell
