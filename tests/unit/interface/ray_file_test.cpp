// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/ray_file.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>

namespace lightwell {
namespace {

const std::filesystem::path kData = LIGHTWELL_TEST_DATA;

// A file of TM-25, field by field; what a test wants otherwise is set before bytes().
struct Tm25 {
  std::int32_t version = 2013;
  float luminous = 100, radiant = 2;
  std::array<std::int32_t, 8> flags = {1, 1, 1, 0, 0, 0, 0, 0};
  std::int32_t tables = 0, more_items = 0, text = 0;
  std::uint64_t stated_rays = 0;  // 0: as many as there are
  std::vector<std::vector<float>> rays;

  [[nodiscard]] std::vector<std::uint8_t> bytes() const {
    std::vector<std::uint8_t> out = {'T', 'M', '2', '5'};
    const auto put = [&](const auto& value) {
      const auto* raw = reinterpret_cast<const std::uint8_t*>(&value);
      out.insert(out.end(), raw, raw + sizeof value);
    };
    put(version);
    put(std::int32_t{1});
    put(luminous);
    put(radiant);
    put(stated_rays > 0 ? stated_rays : static_cast<std::uint64_t>(rays.size()));
    out.resize(out.size() + 28 + 20);
    put(tables);
    put(more_items);
    put(text);
    out.resize(out.size() + 168);
    for (const std::int32_t flag : flags) put(flag);
    for (const char32_t letter : U"Lamp") put(letter);
    out.resize(288 + 9 * 4000);
    for (std::int32_t i = 0; i < tables; ++i) {  // of one pair: 12 bytes
      put(std::int32_t{1});
      put(std::array<float, 2>{500, 1});
    }
    out.resize((out.size() + 31) / 32 * 32);
    out.resize(out.size() + 512 * static_cast<std::size_t>(std::max(more_items, 0)) +
               static_cast<std::size_t>(std::max(text, 0)));
    for (const auto& ray : rays)
      for (const float item : ray) put(item);
    return out;
  }
};

Tm25 two_rays() {
  Tm25 file;
  file.rays = {{1, 2, 3, 0, 0, 1, 0.5f}, {0, 0, 0, 0.6f, 0, 0.8f, 1.5f}};
  return file;
}
void expect_bad(const std::vector<std::uint8_t>& bytes, const std::string& words) {
  const auto file = parse_tm25(bytes, "lamp.tm25ray");
  ASSERT_FALSE(file) << words;
  EXPECT_EQ(file.error().kind, ErrorKind::bad_input);
  EXPECT_NE(file.error().message.find(words), std::string::npos) << file.error().message;
}

TEST(RayFile, RaysStandInTheLampsFrameInMetresAndLumens) {
  const auto file = parse_tm25(two_rays().bytes(), "lamp.tm25ray");
  ASSERT_TRUE(file) << file.error().message;
  ASSERT_EQ(file->rays.size(), 2u);
  EXPECT_EQ(file->name, "Lamp");
  EXPECT_LT((file->rays[0].origin_m - Vec3d(0.001, -0.002, -0.003)).norm(), 1e-12);
  EXPECT_LT((file->rays[0].direction - Vec3d(0, 0, -1)).norm(), 1e-12) << "a file's +z is the lamp's aim";
  EXPECT_LT((file->rays[1].direction - Vec3d(0.6, 0, -0.8)).norm(), 1e-7);
  EXPECT_DOUBLE_EQ(file->rays[0].flux_lm, 25) << "a quarter of the header's 100 lm";
  EXPECT_DOUBLE_EQ(file->rays[1].flux_lm, 75);
}

TEST(RayFile, TablesAndOtherItemsAreStepedOver) {
  Tm25 file = two_rays();
  file.tables = 3;
  file.more_items = 2;
  file.text = 64;
  file.flags = {1, 1, 1, 1, 1, 0, 0, 0};
  for (auto& ray : file.rays) ray.insert(ray.end(), {500, 7, 1, 2});
  const auto read = parse_tm25(file.bytes(), "lamp.tm25ray");
  ASSERT_TRUE(read) << read.error().message;
  ASSERT_EQ(read->rays.size(), 2u);
  EXPECT_EQ(read->rays[0].flux_lm, 7) << "a ray's own luminous flux";
}

TEST(RayFile, UnknownFluxAndDarkRaysAreSaid) {
  Tm25 file = two_rays();
  file.luminous = std::nanf("");
  file.rays.push_back({0, 0, 0, 0, 0, 1, 0});
  const auto read = parse_tm25(file.bytes(), "lamp.tm25ray");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->rays.size(), 2u);
  EXPECT_EQ(read->rays[0].flux_lm, 0.5);
  ASSERT_EQ(read->remarks.size(), 2u);
}

TEST(RayFile, BadInputIsRefusedInOneLine) {
  const std::vector<std::uint8_t> good = two_rays().bytes();
  for (const std::size_t length : {0ul, 3ul, 40ul, 200ul, 300ul, 36000ul}) {
    const std::vector<std::uint8_t> cut(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(length));
    EXPECT_FALSE(parse_tm25(cut, "lamp.tm25ray")) << length;
  }
  expect_bad({good.begin(), good.end() - 4}, "has 1 rays where its header says 2: the file is cut short");
  const auto with = [](const auto& change) {
    Tm25 file = two_rays();
    change(file);
    return file.bytes();
  };
  expect_bad(with([](Tm25& f) { f.version = 2020; }), "version is 2020, allowed: 2013");
  expect_bad(with([](Tm25& f) { f.stated_rays = std::uint64_t{1} << 60; }), "the file is cut short");
  expect_bad(with([](Tm25& f) { f.more_items = -1; }), "additional items is -1, allowed: 0 to");
  expect_bad(with([](Tm25& f) { f.flags[2] = 0; }), "rays have no flux");
  expect_bad(with([](Tm25& f) { f.flags[3] = 5; }), "flag is neither 0 nor 1");
  expect_bad(with([](Tm25& f) { f.rays[1][6] = -1; }), "ray 2: its flux is negative");
  expect_bad(with([](Tm25& f) { f.rays[0][5] = 0; }), "ray 1: its direction is no unit vector");
  expect_bad(with([](Tm25& f) { f.rays[0][0] = std::nanf(""); }), "ray 1: a position is no number");
  expect_bad(with([](Tm25& f) { f.rays[0][6] = f.rays[1][6] = 0; }), "no ray has any flux");
  expect_bad(with([](Tm25& f) { f.rays.clear(); }), "number of rays is 0");
}

TEST(RayFile, ARealLedReads) {
  const auto path = kData / "luminaires" / "rayfile_LERTDUW_S2WP_blue_100k.TM25RAY";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no " << path;
  const auto file = read_tm25(path);
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(file->rays.size(), 100000u);
  double flux = 0;
  Vec3d mean = Vec3d::Zero();
  for (const LampRay& ray : file->rays) {
    flux += ray.flux_lm;
    mean += ray.direction / 1e5;
  }
  EXPECT_NEAR(flux, 54.644, 1e-3);
  EXPECT_LT(mean.z(), -0.6) << "it shines along its aim";
}

// Reach: 3 % on planes at .1, .3 and 1 m; the rays' own noise in a bin is 4 %.
TEST(RayFile, ARealLedLightsPlanesAsItsRaysDo) {
  const auto path = kData / "luminaires" / "rayfile_LERTDUW_S2WP_blue_100k.TM25RAY";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no " << path;
  const auto file = read_tm25(path);
  ASSERT_TRUE(file) << file.error().message;
  const Luminaire lamp = bin_rays(file->rays, {});
  double flux = 0;
  for (const LampRay& ray : file->rays) flux += ray.flux_lm;
  EXPECT_NEAR(luminous_flux(lamp)[1] / flux, 1, 1e-4);
  constexpr int kBins = 10, kPoints = 4;
  for (const double distance : {0.1, 0.3, 1.0}) {
    const double bin = 2 * distance / kBins;
    std::array<double, kBins * kBins> exact{};
    for (const LampRay& ray : file->rays) {
      if (!(ray.direction.z() < 0)) continue;
      const Vec3d at = ray.origin_m + ray.direction * ((-distance - ray.origin_m.z()) / ray.direction.z());
      const int x = static_cast<int>(std::floor((at.x() + distance) / bin));
      const int y = static_cast<int>(std::floor((at.y() + distance) / bin));
      if (x >= 0 && y >= 0 && x < kBins && y < kBins)
        exact[static_cast<std::size_t>(y * kBins + x)] += ray.flux_lm / (bin * bin);
    }
    double error = 0, norm = 0;
    for (int y = 0; y < kBins; ++y)
      for (int x = 0; x < kBins; ++x) {
        double mean = 0;
        for (int k = 0; k < kPoints * kPoints; ++k) {
          const Vec3d point((x + (k % kPoints + 0.5) / kPoints) * bin - distance,
                            (y + (k / kPoints + 0.5) / kPoints) * bin - distance, -distance);
          mean += illuminance(lamp, point, Vec3d::UnitZ())[1] / (kPoints * kPoints);
        }
        const double rays = exact[static_cast<std::size_t>(y * kBins + x)];
        error += (mean - rays) * (mean - rays);
        norm += rays * rays;
      }
    EXPECT_LT(std::sqrt(error / norm), 0.03) << distance;
  }
}

}  // namespace
}  // namespace lightwell
