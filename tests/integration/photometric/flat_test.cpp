// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "calibration/photometric/flat_fit.h"
#include "lighting/radiometer.h"
#include "tests/integration/photometric/flat_fixture.h"
#include "tests/integration/photometric/synthetic_sensor.h"

namespace lightwell {
namespace {

using test::CalibrateFlat;
using test::kFlatFrames;
using test::kSky_cd_m2;
using test::SyntheticSensor;
using test::turned_takes;

TEST_F(CalibrateFlat, RecoversFixedPatternAndVignettingWithinTheStatedError) {
  const auto run = calibrate(command("even.mkv"));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto report = nlohmann::json::parse(run.out);
  const auto flat = read_flat_field(path("flat.json"));
  ASSERT_TRUE(flat) << flat.error().message;
  const FlatField& truth = setup_.model.calibration.flat;
  // The pattern goes by columns, 1.5 codes of 208 an e-fold: 161 of them know the light to 0.72 % / √161 = 0.06 % in the
  // middle, and four times worse at the edge, where few columns reach and the terms lean on each other.
  expect_transmission(*flat, report, 3e-3);
  EXPECT_EQ(truth.gain.size(), flat->gain.size());  // none: one light on a logarithm does not tell them
  EXPECT_TRUE(report.at("gain_sigma").is_null());
  EXPECT_NEAR(report.at("temperature_c").get<double>(), 38.5, 1e-4);
  // One code of noise over √40, and 0.29 of rounding, dithered by it.
  const double noise = report.at("offset_sigma_codes").get<double>();
  EXPECT_NEAR(noise, 1.04 / std::sqrt(40), 0.01);
  expect_offsets(*flat, report);
  // What of the pattern looks like level, tilt and vignetting cannot be told from them: 1.5 codes over √161 columns, √5
  // parameters: 0.26; the fewer columns at the edge make it a little more.
  EXPECT_NEAR(report.at("offset_shared_sigma_codes").get<double>(), 0.26, 0.13);
}

TEST_F(CalibrateFlat, AConstantSkyIsConstantWithWhatWasWritten) {
  ASSERT_EQ(calibrate(command("even.mkv")).exit_code, 0);
  record(sky_, "other.mkv", 1000);  // other noise
  ASSERT_TRUE(write_calibration(path("made"), setup_.model.calibration));
  std::filesystem::copy_file(path("flat.json"), path("made/flat.json"),
                             std::filesystem::copy_options::overwrite_existing);
  const auto made = read_calibration(path("made"));
  ASSERT_TRUE(made) << made.error().message;
  auto radiometer = Radiometer::create(*made, setup_.model.format, {});
  ASSERT_TRUE(radiometer) << radiometer.error().message;
  PolarMap map = radiometer->make_map();
  auto reader = RecordingReader::open(path("other.mkv"));
  ASSERT_TRUE(reader);
  std::vector<std::byte> codes(setup_.model.format.bytes());
  std::vector<double> mean(map.grid.size(), 0);
  for (std::uint64_t i = 0; i < kFlatFrames; ++i) {
    const auto frame = (*reader)->read(codes);
    ASSERT_TRUE(frame && *frame);
    radiometer->develop(codes, (*frame)->exposure_us, map);
    for (std::size_t b = 0; b < mean.size(); ++b)
      mean[b] += static_cast<double>(map.radiance[b]) / kFlatFrames;
  }
  for (std::size_t b = 0; b < mean.size(); ++b)
    if (map.grid.ring_edge_rad(static_cast<int>(b) / 360) < 84 * kPi / 180) {
      // Two means of 40 frames: √(2/40) of 1.04 codes, 0.5 % an e-fold a code: 0.11 %; five of them, the kernel's
      // 0.05 % and the fit's 0.2 %.
      ASSERT_NEAR(mean[b] / kSky_cd_m2, 1, 0.008) << b;
    }
}

TEST_F(CalibrateFlat, DarkFlatFramesGiveThePatternWhereTheLensSeesNothing) {
  record(constant(0, "black.exr"), "dark.mkv", 5000);
  // The scene's brightness chooses the simulated sensor; the dark frames must come from the same one.
  ASSERT_TRUE(write_calibration(path("truth"), setup_.model.calibration));
  const auto lens = read_lens(path("truth/lens.json"));
  const auto response = read_response(path("truth/response.json"));
  const auto dark = calibration::mean_frame(path("dark.mkv"));
  ASSERT_TRUE(lens && response && dark);
  calibration::MeanFrame even = *dark;  // an even scene of the same sensor, from its definition
  const FlatField& truth = setup_.model.calibration.flat;
  const double level = response->luminance_cd_m2(2500);
  for (int y = 0; y < 120; ++y)
    for (int x = 0; x < 161; ++x) {
      const auto i = static_cast<std::size_t>(y) * 161 + static_cast<std::size_t>(x);
      const double theta = std::min(lens->theta_rad(Vec2d(x, y)), lens->max_theta_rad);
      even.code[i] =
          response->code(level * truth.transmission(theta)) + static_cast<double>(truth.offset_codes[i]);
    }
  const auto fit = calibration::fit_flat_field({{"even.mkv", even}}, *dark, *lens, *response);
  ASSERT_TRUE(fit) << fit.error().message;
  EXPECT_TRUE(fit->from_dark);
  // What all pixels add alike is the response's, and said apart.
  const double level_error = fit->dark_level_error_codes[0];
  double square = 0;
  for (std::size_t i = 0; i < truth.offset_codes.size(); ++i)
    square +=
        std::pow(static_cast<double>(fit->flat.offset_codes[i] - truth.offset_codes[i]) + level_error, 2);
  EXPECT_LT(std::sqrt(square / static_cast<double>(truth.offset_codes.size())), 0.25);  // 1.04 / √40 = 0.16
  for (double theta = 0; theta < lens->max_theta_rad; theta += 0.1)
    EXPECT_NEAR(fit->flat.transmission(theta) / truth.transmission(theta), 1, 1e-3);
}

TEST_F(CalibrateFlat, ALampInTheSceneAndDeadPixelsChangeNothing) {
  auto even = calibration::mean_frame(path("even.mkv"));
  const auto lens = read_lens(path("truth/lens.json"));
  const auto response = read_response(path("truth/response.json"));
  ASSERT_TRUE(even && lens && response);
  for (int y = 40; y < 50; ++y)
    for (int x = 60; x < 70; ++x) even->code[static_cast<std::size_t>(y * 161 + x)] += 500;
  for (std::size_t i = 0; i < 50; ++i) even->code[60 * 161 + 20 + 2 * i] = 700;
  const auto fit = calibration::fit_flat_field({{"even.mkv", *even}}, std::nullopt, *lens, *response);
  ASSERT_TRUE(fit) << fit.error().message;
  for (double theta = 0; theta < lens->max_theta_rad; theta += 0.1)
    EXPECT_NEAR(fit->flat.transmission(theta) / setup_.model.calibration.flat.transmission(theta), 1, 3e-3);
}

TEST_F(CalibrateFlat, BayerMosaicHasALevelForEachColourAndOneVignetting) {
  record(sky_, "bayer.mkv", 0, "BayerRG12");
  const auto run = calibrate(command("bayer.mkv"));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto flat = read_flat_field(path("flat.json"));
  ASSERT_TRUE(flat) << flat.error().message;
  // The same columns as without a mosaic, but each colour's level leans on 80 of them: √2 of that.
  expect_transmission(*flat, nlohmann::json::parse(run.out), 4.5e-3);
}

TEST_F(CalibrateFlat, TurnedTakesGiveTheVignettingThroughTheCommand) {
  SyntheticSensor sensor(161, 120);
  Calibration calibration;
  calibration.response = sensor.response;
  calibration.lens = sensor.lens;
  ASSERT_TRUE(write_calibration(path("turned"), calibration));
  const std::vector<double> angles = {-50, 0, 50};
  std::vector<std::string> arguments = {"flat"};
  for (const auto& take : turned_takes(sensor, angles, Vec3d::UnitY())) {
    arguments.push_back(path("turned" + std::to_string(arguments.size()) + ".mkv"));
    auto writer = RecordingWriter::create(arguments.back(), {.format = take.mean.format,
                                                             .rate_hz = 30,
                                                             .source = "simulated",
                                                             .calibration_json = "",
                                                             .start_utc_ns = 1'700'000'000'000'000'000});
    ASSERT_TRUE(writer) << writer.error().message;
    std::vector<std::byte> codes;
    for (const double code : take.mean.code) {
      const auto word = static_cast<unsigned>(std::lround(code));
      codes.push_back(static_cast<std::byte>(word & 255));
      codes.push_back(static_cast<std::byte>(word >> 8));
    }
    for (std::uint64_t i = 0; i < 2; ++i) {
      RecordedFrame info;
      info.sequence = i;
      info.capture_mono_ns = static_cast<std::int64_t>(i) * 33'000'000;
      info.exposure_us = 10000;
      info.temperature_c = 41;
      ASSERT_TRUE((*writer)->write(info, codes));
    }
    ASSERT_TRUE((*writer)->close());
  }
  arguments.insert(arguments.end(),
                   {"--lens", path("turned/lens.json"), "--response", path("turned/response.json"), "--out",
                    path("flat.json"), "--json", "--turning=-50,0,50"});
  const auto run = calibrate(arguments);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto report = nlohmann::json::parse(run.out);
  EXPECT_EQ(report.at("vignetting_from"), "turning");
  EXPECT_EQ(report.at("takes").at(2).at("turned_deg"), 50);
  EXPECT_EQ(report.at("temperature_c"), 41);
  const auto flat = read_flat_field(path("flat.json"));
  ASSERT_TRUE(flat) << flat.error().message;
  for (double theta = 0.2; theta < 1.5; theta += 0.1)  // as in the test above
    EXPECT_NEAR(flat->transmission(theta), sensor.truth.transmission(theta), 0.015) << theta;
  arguments.back() = "--turning=-50,0";
  expect_refused(arguments, 2, "--turning: 2 angles: allowed one for each of the 3 recordings", "flat.json");
  arguments.back() = "--turning=0,0,0";
  expect_refused(arguments, 3, "turn the camera farther", "flat.json");
}

TEST_F(CalibrateFlat, BadInputIsRefusedInOneLineAndNothingIsChanged) {
  auto refused = [&](std::vector<std::string> arguments, const std::string& names) {
    SCOPED_TRACE(names);
    expect_refused(arguments, 3, names, "flat.json");
  };
  refused(command("absent.mkv"), "absent.mkv");
  write("text.mkv", "no take");
  refused(command("text.mkv"), "text.mkv");
  {  // a take that was cut within a frame
    const std::string whole = *read_text_file(path("even.mkv"));
    write("cut.mkv", whole.substr(0, whole.size() * 2 / 3));
    refused(command("cut.mkv"), "cut.mkv");
  }
  auto arguments = command("even.mkv");
  write("lens.json", R"({"schema":"lightwell.lens/1","model":"kannala-brandt","image_size":[160,120],)"
                     R"("focal":[38,38],"center":[80,60],"k":[0,0,0,0],"max_theta_deg":90})");
  arguments[3] = path("lens.json");
  refused(arguments, "frames of 161x120: allowed 160x120");
  write("empty.json", R"({"schema":"lightwell.lens/1","model":"kannala-brandt","image_size":[161,120],)"
                      R"("focal":[1,1],"center":[80,60],"k":[0,0,0,0],"max_theta_deg":0.001})");
  arguments[3] = path("empty.json");
  refused(arguments, "empty.json: max_theta_deg = 0.001");
  arguments = command("even.mkv");
  arguments.insert(arguments.end(), {"--dark", path("even.mkv")});
  refused(arguments, "even.mkv: not dark");
  record(sky_, "eight.mkv", 0, "Mono8");
  refused(command("eight.mkv"), "codes of 8 bits: allowed 12");
  // A sky that is bright on one side.
  LatLongImage image{32, 16, {}};
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 32; ++x) image.pixels.push_back(x < 16 ? Rgb(500, 500, 500) : Rgb(250, 250, 250));
  ASSERT_TRUE(write_environment(path("half.exr"), image));
  record(path("half.exr"), "half.mkv", 0);
  refused(command("half.mkv"), "the scene changes by");
}

}  // namespace
}  // namespace lightwell
