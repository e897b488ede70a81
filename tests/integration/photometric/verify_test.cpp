// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "lighting/direction.h"
#include "tests/integration/photometric/flat_fixture.h"

namespace lightwell {
namespace {

using test::CalibrateFlat;
using test::kFlatFrames;
using test::kSky_cd_m2;

TEST_F(CalibrateFlat, VerifyAgreesWithAMeterUnderTheSameSky) {
  // A level meter under a constant sky of luminance L reads πL.
  const auto lux = std::to_string(3.14159265358979 * kSky_cd_m2);
  const auto take = calibrate({"verify", "--lux", lux, "--recording", path("even.mkv"), "--json"});
  ASSERT_EQ(take.exit_code, 0) << take.err;
  const auto of_take = nlohmann::json::parse(take.out);
  EXPECT_NEAR(of_take.at("error").get<double>(), 0, 2e-3);  // noise, kernel, bins of a degree
  EXPECT_EQ(of_take.at("frames"), kFlatFrames);
  const auto map = calibrate({"verify", "--lux", lux, "--environment", sky_, "--json"});
  ASSERT_EQ(map.exit_code, 0) << map.err;
  EXPECT_NEAR(nlohmann::json::parse(map.out).at("error").get<double>(), 0, 5e-3);  // 16 rows: (π/16)²/8
  const auto half = calibrate({"verify", "--lux", std::to_string(3.14159265358979 * kSky_cd_m2 / 2),
                               "--environment", sky_, "--json"});
  EXPECT_NEAR(nlohmann::json::parse(half.out).at("stops").get<double>(), 1, 0.01);
}

TEST_F(CalibrateFlat, VerifyFailsBeyondTheToleranceAndSaysHowFarTheMapGoes) {
  const double lux = 3.14159265358979 * kSky_cd_m2;
  const auto verify = [&](double meter_lux, const std::string& environment, const std::string& tolerance) {
    return calibrate({"verify", "--lux", std::to_string(meter_lux), "--environment", environment,
                      "--tolerance", tolerance, "--json"});
  };
  const auto good = verify(lux / 1.04, sky_, "5");  // and 0.5 % of the 16 rows
  EXPECT_EQ(good.exit_code, 0) << good.err;
  EXPECT_EQ(nlohmann::json::parse(good.out).at("tolerance"), 0.05);
  for (const double factor : {1.07, 0.93}) {
    const auto bad = verify(lux / factor, sky_, "5");
    EXPECT_EQ(bad.exit_code, 3);
    EXPECT_EQ(std::count(bad.err.begin(), bad.err.end(), '\n'), 1) << bad.err;
    EXPECT_THAT(bad.err, testing::HasSubstr("allowed up to 5 %"));
    EXPECT_NEAR(nlohmann::json::parse(bad.out).at("error").get<double>(), factor - 1, 6e-3);
  }
  for (const char* tolerance : {"0", "-1", "nan", "101"})
    EXPECT_EQ(verify(lux, sky_, tolerance).exit_code, 2) << tolerance;
  // A map of the half that a camera saw.
  LatLongImage half{32, 16, std::vector<Rgb>(32 * 16, Rgb(0, 0, 0))};
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 16; ++x) half.pixels[static_cast<std::size_t>(32 * y + x)] = Rgb(500, 500, 500);
  ASSERT_TRUE(write_environment(path("half_map.exr"), half));
  const auto part = verify(lux / 2, path("half_map.exr"), "5");
  ASSERT_EQ(part.exit_code, 0) << part.err;
  EXPECT_NEAR(nlohmann::json::parse(part.out).at("measured_part").get<double>(), 0.5, 1e-9);
  EXPECT_EQ(nlohmann::json::parse(good.out).at("measured_part"), 1);
}

TEST_F(CalibrateFlat, VerifyReadsTheOneLuxSourceThatFacesTheMeter) {
  const std::string file = LIGHTWELL_TEST_DATA "/env/spot1Lux_1k.hdr";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not there";
  const auto image = read_environment(file);
  ASSERT_TRUE(image);
  std::size_t brightest = 0;
  for (std::size_t i = 0; i < image->image.pixels.size(); ++i)
    if (image->image.pixels[i].sum() > image->image.pixels[brightest].sum()) brightest = i;
  const Vec3d d = direction_from_lat_long((static_cast<double>(brightest % 1024) + 0.5) / 1024,
                                          (static_cast<double>(brightest / 1024) + 0.5) / 512);
  const std::string toward =
      std::to_string(d.x()) + "," + std::to_string(d.y()) + "," + std::to_string(d.z());
  const auto run = calibrate({"verify", "--lux", "1", "--environment", file, "--toward", toward, "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NEAR(nlohmann::json::parse(run.out).at("map_lux").get<double>(), 0.959,
              1e-3);  // with exact solid angles
}

TEST_F(CalibrateFlat, VerifyRefusesWhatItCannotCompare) {
  EXPECT_EQ(calibrate({"verify", "--lux", "0", "--environment", sky_}).exit_code, 2);
  EXPECT_EQ(calibrate({"verify", "--lux", "nan", "--environment", sky_}).exit_code, 2);
  EXPECT_EQ(calibrate({"verify", "--lux", "5"}).exit_code, 2);
  EXPECT_EQ(calibrate({"verify", "--lux", "5", "--environment", path("absent.exr")}).exit_code, 3);
  EXPECT_EQ(calibrate({"verify", "--lux", "5", "--environment", constant(0, "black.exr")}).exit_code, 3);
  record(constant(0, "night.exr"), "black.mkv", 9000);
  const auto black = calibrate({"verify", "--lux", "903", "--recording", path("black.mkv")});
  EXPECT_EQ(black.exit_code, 3) << black.out;
  EXPECT_THAT(black.err, testing::HasSubstr("black.mkv"));
  EXPECT_THAT(black.err, testing::HasSubstr("which is dark"));
  const std::string whole = *read_text_file(path("even.mkv"));
  const auto cut =
      calibrate({"verify", "--lux", "5", "--recording", write("cut.mkv", whole.substr(0, whole.size() / 2)),
                 "--calibration", path("truth")});
  EXPECT_EQ(cut.exit_code, 3);
  EXPECT_THAT(cut.err, testing::HasSubstr("cut.mkv"));
}

}  // namespace
}  // namespace lightwell
