// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/luminaire_file.h"

#include <gtest/gtest.h>

#include <array>
#include <fstream>
#include <string>

#include "interface/atomic_file.h"
#include "interface/exr_file.h"
#include "tests/support/temporary_folder.h"

namespace lightwell {
namespace {

Luminaire lamp_of_both() {
  Luminaire lamp;
  lamp.name = "Lamp \xC3\xA4";
  LampImages& images = lamp.near.emplace().intensity;
  images.planes.map = LampMap::hemisphere;
  images.planes.positions = {3, 2};
  images.planes.pixels = {4, 5};
  images.planes.spacing_m = 0.1 / 3;
  images.planes.first_m = {-0.01, 0.02};
  images.planes.z_m = 1e-3;
  images.planes.low_m = Vec2d::Constant(-1);
  images.planes.high_m = Vec2d::Constant(1);
  for (std::size_t i = 0; i < images.planes.images() * images.planes.image_size(); ++i)
    images.values.emplace_back(static_cast<float>(i), 0.5f, -0.25f);
  FarField& far = lamp.far.emplace();
  far.horizontal_deg = {0, 120.1, 240};
  far.vertical_deg = {0, 0.1, 90};
  far.candela = {1, 2, 3, 1.0 / 3, 5, 6, 7, 8, 1e9};
  return lamp;
}

void expect_bad(const Result<Luminaire>& lamp, const std::string& words) {
  ASSERT_FALSE(lamp) << words;
  EXPECT_EQ(lamp.error().kind, ErrorKind::bad_input);
  EXPECT_NE(lamp.error().message.find(words), std::string::npos) << lamp.error().message;
  EXPECT_EQ(lamp.error().message.find('\n'), std::string::npos);
}

TEST(LuminaireFile, WhatIsWrittenReadsBackToTheBit) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "lamp.exr";
  for (const int parts : {1, 2, 3}) {
    Luminaire lamp = lamp_of_both();
    if (parts == 1) lamp.far.reset();
    if (parts == 2) lamp.near.reset();
    ASSERT_TRUE(write_luminaire(file, lamp));
    const auto back = read_luminaire(file);
    ASSERT_TRUE(back) << back.error().message;
    EXPECT_EQ(back->name, lamp.name);
    ASSERT_EQ(back->near.has_value(), lamp.near.has_value());
    ASSERT_EQ(back->far.has_value(), lamp.far.has_value());
    if (lamp.near) {
      const LampPlanes &a = back->near->intensity.planes, &b = lamp.near->intensity.planes;
      EXPECT_EQ(a.map, b.map);
      EXPECT_EQ(a.positions, b.positions);
      EXPECT_EQ(a.pixels, b.pixels);
      EXPECT_EQ(a.spacing_m, b.spacing_m);
      EXPECT_EQ(a.first_m, b.first_m);
      EXPECT_EQ(a.z_m, b.z_m);
      ASSERT_EQ(back->near->intensity.values.size(), lamp.near->intensity.values.size());
      for (std::size_t i = 0; i < lamp.near->intensity.values.size(); ++i)
        EXPECT_TRUE((back->near->intensity.values[i] == lamp.near->intensity.values[i]).all()) << i;
    }
    if (lamp.far) {
      EXPECT_EQ(back->far->horizontal_deg, lamp.far->horizontal_deg);
      EXPECT_EQ(back->far->vertical_deg, lamp.far->vertical_deg);
      EXPECT_EQ(back->far->candela, lamp.far->candela);
    }
  }
}

TEST(LuminaireFile, BadInputIsRefusedInOneLine) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "lamp.exr";
  expect_bad(read_luminaire(file), "cannot read");
  std::ofstream(file) << "no picture";
  expect_bad(read_luminaire(file), "is no EXR file");
  const std::array<float, 12> pixels{};
  const auto picture_with = [&](const std::string& text) {
    ExrFacts facts;
    if (!text.empty()) facts.texts = {{"lightwell_luminaire", text}};
    const auto bytes = exr_from_floats(2, 2, "RGB", pixels, ExrContent::picture, facts);
    EXPECT_TRUE(bytes && write_file_atomically(file, *bytes));
    return read_luminaire(file);
  };
  expect_bad(picture_with(""), "has no attribute lightwell_luminaire");
  expect_bad(picture_with("[1"), "is no JSON object");
  expect_bad(picture_with(R"({"schema": "lightwell.luminaire/9"})"), "schema");
  const std::string head = R"({"schema": "lightwell.luminaire/1", "name": "", )";
  expect_bad(picture_with(head + R"("x": 1})"), "far is missing, and near too");
  expect_bad(picture_with(head + R"("far": {"system": "D"}})"), "far.system is D, allowed: A, B, C");
  expect_bad(
      picture_with(
          head +
          R"("far": {"system": "C", "horizontal_deg": [0, 0], "vertical_deg": [0, 90], "candela": []}})"),
      "far.horizontal_deg[1] = 0 does not increase: allowed increasing angles");
  expect_bad(
      picture_with(
          head +
          R"("far": {"system": "C", "horizontal_deg": [0], "vertical_deg": [0, 90], "candela": [1, -2]}})"),
      "far.candela");
  const auto with_angles = [&](const std::string& system, const std::string& across,
                               const std::string& along) {
    return picture_with(head + R"("far": {"system": ")" + system + R"(", "horizontal_deg": )" + across +
                        R"(, "vertical_deg": )" + along + R"(, "candela": [1, 2, 3, 4]}})");
  };
  expect_bad(with_angles("C", "[0]", "[30]"), "far.vertical_deg = an array of 1: allowed at least 2 angles");
  expect_bad(with_angles("C", "[]", "[0, 90]"),
             "far.horizontal_deg = an array of 0: allowed at least 1 angles");
  expect_bad(with_angles("C", "[0, 360]", "[0, 90]"), "far.horizontal_deg[1] = 360: allowed 0 to below 360");
  expect_bad(with_angles("C", "[-1, 10]", "[0, 90]"), "far.horizontal_deg[0] = -1: allowed 0 to below 360");
  expect_bad(with_angles("C", "[0, 90]", "[0, 180.5]"), "far.vertical_deg[1] = 180.5: allowed 0 to 180");
  expect_bad(with_angles("B", "[-91, 0]", "[0, 90]"), "far.horizontal_deg[0] = -91: allowed -90 to 90");
  expect_bad(with_angles("B", "[0, 1]", "[0, 181]"), "far.vertical_deg[1] = 181: allowed -180 to 180");
  expect_bad(with_angles("A", "[-181, 0]", "[0, 90]"), "far.horizontal_deg[0] = -181: allowed -180 to 180");
  expect_bad(with_angles("A", "[0, 1]", "[-91, 90]"), "far.vertical_deg[0] = -91: allowed -90 to 90");
  EXPECT_TRUE(with_angles("C", "[0, 359.9]", "[0, 180]"));
  EXPECT_TRUE(with_angles("B", "[-90, 90]", "[-180, 180]"));
  EXPECT_TRUE(with_angles("A", "[-180, 180]", "[-90, 90]"));
  const std::string near =
      R"("near": {"map": "plane", "positions": [1, 1], "spacing_m": 0.01, "first_m": [0, 0], "z_m": 0, "distance_m": 0.1, )";
  expect_bad(picture_with(head + near + R"("pixels": [3, 2], "low_m": [-1, -1], "high_m": [1, 1]}})"),
             "near.pixels ask for a picture of 3x2, it is 2x2");
  expect_bad(picture_with(head + near + R"("pixels": [2, 0], "low_m": [-1, -1], "high_m": [1, 1]}})"),
             "near.pixels");
  expect_bad(picture_with(head + near + R"("pixels": [2, 2], "low_m": [-1, 1], "high_m": [1, 1]}})"),
             "near.high_m is not above low_m");
  EXPECT_TRUE(picture_with(head + near + R"("pixels": [2, 2], "low_m": [-1, -1], "high_m": [1, 1]}})"));
  // Truncated anywhere: refused, never read beyond its end.
  ASSERT_TRUE(write_luminaire(file, lamp_of_both()));
  const std::string good = *read_text_file(file);
  for (std::size_t length = 0; length < good.size(); length += 37) {
    std::ofstream(file, std::ios::binary) << good.substr(0, length);
    EXPECT_FALSE(read_luminaire(file)) << length;
  }
}

}  // namespace
}  // namespace lightwell
