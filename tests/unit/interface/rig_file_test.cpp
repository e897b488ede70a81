// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/rig_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/temporary_folder.h"

namespace lightwell {
namespace {

using testing::HasSubstr;

const std::string kRig = R"(schema = "lightwell.rig/1"
name = "Bike light"

[sampling]
spacing_m = 0.005
filter = "finite"
peak_transmission = 0.8
moves = "lamp"

[measurement]
distance_m = 0.1
low_m = [-0.2, -0.15]
high_m = [0.2, 0.15]
pixels = [200, 150]

[camera]
unit = "codes"
calibration = "camera"
exposure_us = 20000
dark = "dark.exr"

[[marks]]
pixel = [10, 12]
screen_m = [-0.2, -0.15]
[[marks]]
pixel = [210.5, 14]
screen_m = [0.2, -0.15]
[[marks]]
pixel = [208, 160]
screen_m = [0.2, 0.15]
[[marks]]
pixel = [11, 158]
screen_m = [-0.2, 0.15]
)";

std::string with(const std::string& old, const std::string& now) {
  std::string text = kRig;
  const auto at = text.find(old);
  EXPECT_NE(at, std::string::npos) << old;
  return text.replace(at, old.size(), now);
}

void expect_refused(const std::string& text, const std::string& words) {
  const auto rig = parse_rig(text, "rig.toml");
  ASSERT_FALSE(rig) << words;
  EXPECT_EQ(rig.error().kind, ErrorKind::bad_input);
  EXPECT_THAT(rig.error().message, HasSubstr(words));
  EXPECT_THAT(rig.error().message, HasSubstr("rig.toml"));
  EXPECT_EQ(rig.error().message.find('\n'), std::string::npos) << rig.error().message;
}

TEST(RigFile, EveryFieldIsRead) {
  double exposure_us = 0;
  const auto rig = parse_rig(kRig, "rig.toml", &exposure_us);
  ASSERT_TRUE(rig) << rig.error().message;
  EXPECT_EQ(rig->name, "Bike light");
  EXPECT_EQ(rig->spacing_m, 0.005);
  EXPECT_EQ(rig->filter, BellDual::finite);
  EXPECT_EQ(rig->peak_transmission, 0.8);
  EXPECT_EQ(rig->moves, Rig::Moves::lamp);
  EXPECT_EQ(rig->distance_m, 0.1);
  EXPECT_EQ(rig->low_m, Vec2d(-0.2, -0.15));
  EXPECT_EQ(rig->pixels, (std::array<int, 2>{200, 150}));
  EXPECT_EQ(rig->unit, Rig::Unit::codes);
  EXPECT_EQ(exposure_us, 20000);
  EXPECT_EQ(rig->dark_exposure_us, 20000) << "as the pictures'";
  ASSERT_EQ(rig->marks.size(), 4u);
  EXPECT_EQ(rig->marks[1].pixel, Vec2d(210.5, 14));
  EXPECT_FALSE(rig->edges);
  EXPECT_FALSE(rig->reference);
}

TEST(RigFile, PicturesStandInTheLampsFrame) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path() / "rig.toml") << kRig;
  std::ofstream(folder.path() / "positions.csv")
      << "file,x,y,part,exposure_us\na.exr,0.005,-0.01,positive,1000\nb.exr,0,0,negative,2000\n";
  const auto rig = read_rig(folder.path());
  ASSERT_TRUE(rig) << rig.error().message;
  ASSERT_EQ(rig->pictures.size(), 2u);
  EXPECT_EQ(rig->pictures[0].position_m, Vec2d(-0.005, 0.01)) << "a lamp moved right shows its left";
  EXPECT_EQ(rig->pictures[0].part, Rig::Part::positive);
  EXPECT_EQ(rig->pictures[1].exposure_us, 2000);
  std::ofstream(folder.path() / "rig.toml") << with("\"lamp\"", "\"filter\"");
  EXPECT_EQ(read_rig(folder.path())->pictures[0].position_m, Vec2d(0.005, -0.01));
  const auto expect_bad = [&](const std::string& text, const std::string& words) {
    std::ofstream(folder.path() / "positions.csv") << text;
    const auto bad = read_rig(folder.path());
    ASSERT_FALSE(bad) << words;
    EXPECT_THAT(bad.error().message, HasSubstr(words));
  };
  expect_bad("file,x\na.exr,0\n", "y");
  expect_bad("file,x,y\n", "lists no picture");
  expect_bad("file,x,y\n,0,0\n", "line 2: file is empty");
  expect_bad("file,x,y\na.exr,0,nan\n", "line 2");
  expect_bad("file,x,y,part\na.exr,0,0,half\n", "line 2: part is half, allowed: whole, positive, negative");
  expect_bad("file,x,y,exposure_us\na.exr,0,0,0\n", "above 0 to 1e9");
}

TEST(RigFile, BadFieldsAreNamedWithLineValueAndRange) {
  expect_refused("", "schema is missing");
  expect_refused("a = [", "line 1");
  expect_refused(with("lightwell.rig/1", "lightwell.rig/9"),
                 "line 1: schema is not known, allowed: lightwell.rig/1");
  expect_refused(with("spacing_m = 0.005", "spacing_m = 0"),
                 "line 5: sampling.spacing_m is 0, allowed: 0.0001 to 1000 metres");
  expect_refused(with("spacing_m = 0.005", "spacing_m = nan"), "sampling.spacing_m is nan");
  expect_refused(with("spacing_m = 0.005", ""), "sampling.spacing_m is missing");
  expect_refused(with("\"finite\"", "\"gauss\""), "sampling.filter is gauss, allowed: finite, canonical");
  expect_refused(with("0.8", "1.2"), "sampling.peak_transmission is 1.2, allowed: above 0 to 1");
  expect_refused(with("\"lamp\"", "3"), "sampling.moves is 3, allowed: a text in quotes");
  expect_refused(with("[0.2, 0.15]", "[0.2]"), "measurement.high_m is no list of 2 numbers");
  expect_refused(with("[0.2, 0.15]", "[-0.3, 0.15]"), "measurement.high_m is not above low_m");
  expect_refused(with("[200, 150]", "[200, 150.5]"), "measurement.pixels is not whole, allowed: 4 to 4096");
  expect_refused(with("[200, 150]", "[200, 99999]"), "measurement.pixels is 99999, allowed: 4 to 4096");
  expect_refused(with("\"codes\"", "\"volts\""),
                 "camera.unit is volts, allowed: lux, cd/m2, codes, relative");
  expect_refused(with("calibration = \"camera\"", ""),
                 "camera.calibration is missing, unit codes needs a folder");
  expect_refused(with("\"codes\"", "\"relative\""), "reference is missing, unit relative needs");
  expect_refused(with("dark = ", "darkness = "), "camera.darkness is not known, allowed: calibration, dark,");
  expect_refused(with("[[marks]]\npixel = [11, 158]\nscreen_m = [-0.2, 0.15]\n", ""),
                 "marks are 3, allowed: four or more");
  expect_refused(with("pixel = [210.5, 14]", "pixel = [1e300, 14]"),
                 "marks 2: pixel is 1e+300, allowed: -1e6 to 1e6");
  expect_refused(kRig + "[picture]\nfirst_m = [0, 0]\nlast_m = [1, 1]\n",
                 "and [[marks]]: one of them is needed");
  expect_refused(kRig + "[reference]\nat_m = [0, 0, 1]\ntoward = [0, 0, 1]\nlux = 3\n",
                 "reference.at_m does not lie before the lamp");
  expect_refused(kRig + "[reference]\nat_m = [0, 0, -1]\ntoward = [0, 0, 0]\nlux = 3\n",
                 "reference.toward is 0, allowed: any length but 0");
}

}  // namespace
}  // namespace lightwell
