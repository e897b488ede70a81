// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>

#include "calibration/photometric/flat_fit.h"
#include "daemon/simulator/frame_generator.h"
#include "daemon/simulator/probe_setup.h"
#include "interface/calibration_io.h"
#include "interface/environment_io.h"
#include "interface/recording.h"
#include "lighting/radiometer.h"
#include "tests/integration/photometric/photometric_fixture.h"

namespace lightwell {
namespace {

constexpr float kSky_cd_m2 = 500;
constexpr std::uint64_t kFrames = 40;

// The simulated camera under a constant sky, recorded without waiting for real time.
class CalibrateFlat : public test::PhotometricTest {
 protected:
  void SetUp() override {
    sky_ = constant(kSky_cd_m2, "sky.exr");
    record(sky_, "even.mkv", 0);
    ASSERT_TRUE(write_calibration(path("truth"), setup_.model.calibration));
  }

  std::string constant(float radiance, const std::string& name) const {
    LatLongImage image{32, 16, {}};
    image.pixels.assign(32 * 16, Rgb(radiance, radiance, radiance));
    EXPECT_TRUE(write_environment(path(name), image));
    return path(name);
  }

  void record(const std::string& environment, const std::string& take, std::uint64_t first,
              const std::string& pixel_format = "Mono12", double exposure_us = 0) {
    simulator::ProbeOptions options;
    options.environments = {environment};
    options.width = 161;
    options.height = 120;
    options.pixel_format = pixel_format;
    options.exposure_us = exposure_us;
    auto setup = simulator::set_up_probe(options);
    ASSERT_TRUE(setup) << setup.error().message;
    setup_ = *setup;
    simulator::FrameGenerator generator(setup_.scene, setup_.model);
    const FrameFormat format = setup_.model.format;
    auto writer = RecordingWriter::create(path(take),
                                          {.format = format,
                                           .rate_hz = 30,
                                           .source = "simulated",
                                           .calibration_json = calibration_to_json(setup_.model.calibration),
                                           .start_utc_ns = 1'700'000'000'000'000'000});
    ASSERT_TRUE(writer) << writer.error().message;
    std::vector<std::byte> codes(format.bytes());
    for (std::uint64_t i = 0; i < kFrames; ++i) {
      generator.render(1, setup_.exposure_us, first + i, format.pixel_format, codes);
      RecordedFrame info;
      info.sequence = i;
      info.capture_mono_ns = static_cast<std::int64_t>(i) * 33'000'000;
      info.exposure_us = setup_.exposure_us;
      info.temperature_c = 38.5f;
      ASSERT_TRUE((*writer)->write(info, codes));
    }
    ASSERT_TRUE((*writer)->close());
  }

  std::vector<std::string> command(const std::string& take) const {
    return {"flat",       path(take),
            "--lens",     path("truth/lens.json"),
            "--response", path("truth/response.json"),
            "--out",      path("flat.json"),
            "--json"};
  }
  // Root mean square and mean of (found − true) offsets well inside the field.
  void expect_offsets(const FlatField& found, double tolerance) const {
    const FlatField& truth = setup_.model.calibration.flat;
    const Lens& lens = setup_.model.calibration.lens;
    double square = 0, n = 0;
    for (int y = 0; y < 120; ++y)
      for (int x = 0; x < 161; ++x) {
        if (lens.theta_rad(Vec2d(x, y)) > 85 * kPi / 180) continue;
        const auto i = static_cast<std::size_t>(y) * 161 + static_cast<std::size_t>(x);
        const double d =
            static_cast<double>(found.offset_codes[i]) - static_cast<double>(truth.offset_codes[i]);
        square += d * d;
        ++n;
      }
    EXPECT_LT(std::sqrt(square / n), tolerance);
  }

  std::string sky_;
  simulator::ProbeSetup setup_;
};

TEST_F(CalibrateFlat, RecoversFixedPatternAndVignettingWithinTheStatedError) {
  const auto run = calibrate(command("even.mkv"));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto report = nlohmann::json::parse(run.out);
  const auto flat = read_flat_field(path("flat.json"));
  ASSERT_TRUE(flat) << flat.error().message;
  const FlatField& truth = setup_.model.calibration.flat;
  const double edge = setup_.model.calibration.lens.max_theta_rad;
  // 12,000 pixels with 2.9 codes of pattern, of 208 an e-fold: 1.4 % / √12000 each, times what the terms share.
  for (double theta = 0; theta < edge; theta += 0.1)
    EXPECT_NEAR(flat->transmission(theta) / truth.transmission(theta), 1, 2e-3) << theta;
  const double sigma = std::sqrt(report.at("covariance")[0][0].get<double>());
  EXPECT_LT(std::abs(flat->vignetting[0] - truth.vignetting[0]), 4 * sigma);
  EXPECT_GT(sigma, 1e-5);
  EXPECT_NEAR(report.at("temperature_c").get<double>(), 38.5, 1e-4);
  // One code of noise over √40, and 0.29 of rounding, dithered by it. What of the pattern looks like level and
  // vignetting cannot be told from them: 1.5 codes over √161 columns, times three for the few terms: 0.36.
  const double noise = report.at("offset_sigma_codes").get<double>();
  EXPECT_NEAR(noise, 1.04 / std::sqrt(40), 0.01);
  expect_offsets(*flat, 0.5);
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
  for (std::uint64_t i = 0; i < kFrames; ++i) {
    const auto frame = (*reader)->read(codes);
    ASSERT_TRUE(frame && *frame);
    radiometer->develop(codes, (*frame)->exposure_us, map);
    for (std::size_t b = 0; b < mean.size(); ++b) mean[b] += static_cast<double>(map.radiance[b]) / kFrames;
  }
  for (std::size_t b = 0; b < mean.size(); ++b)
    if (map.grid.ring_edge_rad(static_cast<int>(b) / 360) < 84 * kPi / 180) {
      // Two means of 40 frames: √(2/40) of 1.04 codes, 0.5 % an e-fold a code: 0.11 %; five of them, the kernel's
      // 0.05 % and the fit's 0.2 %.
      ASSERT_NEAR(mean[b] / kSky_cd_m2, 1, 0.008) << b;
    }
}

TEST_F(CalibrateFlat, DarkFramesGiveThePatternWhereTheLensSeesNothing) {
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
  const auto fit = calibration::fit_flat_field(even, *dark, *lens, *response, "even.mkv");
  ASSERT_TRUE(fit) << fit.error().message;
  EXPECT_TRUE(fit->from_dark);
  double square = 0;
  for (std::size_t i = 0; i < truth.offset_codes.size(); ++i)
    square += std::pow(static_cast<double>(fit->flat.offset_codes[i] - truth.offset_codes[i]), 2);
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
  const auto fit = calibration::fit_flat_field(*even, std::nullopt, *lens, *response, "even.mkv");
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
  // A colour has 80 columns of 1.5 codes, 208 an e-fold: 0.08 %, four times that at the edge, three deviations.
  for (double theta = 0; theta < 1.5; theta += 0.1)
    EXPECT_NEAR(flat->transmission(theta) / setup_.model.calibration.flat.transmission(theta), 1, 1e-2)
        << theta;
}

TEST_F(CalibrateFlat, BadInputIsRefusedInOneLineAndNothingIsChanged) {
  auto refused = [&](std::vector<std::string> arguments, const std::string& names) {
    SCOPED_TRACE(names);
    expect_refused(arguments, 3, names, "flat.json");
  };
  refused(command("absent.mkv"), "absent.mkv");
  write("text.mkv", "no take");
  refused(command("text.mkv"), "text.mkv");
  auto arguments = command("even.mkv");
  write("lens.json", R"({"schema":"lightwell.lens/1","model":"kannala-brandt","image_size":[160,120],)"
                     R"("focal":[38,38],"center":[80,60],"k":[0,0,0,0],"max_theta_deg":90})");
  arguments[3] = path("lens.json");
  refused(arguments, "frames of 161x120: allowed 160x120");
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

TEST_F(CalibrateFlat, VerifyAgreesWithAMeterUnderTheSameSky) {
  // A level meter under a constant sky of luminance L reads πL.
  const auto lux = std::to_string(3.14159265358979 * kSky_cd_m2);
  const auto take = calibrate({"verify", "--lux", lux, "--recording", path("even.mkv"), "--json"});
  ASSERT_EQ(take.exit_code, 0) << take.err;
  const auto of_take = nlohmann::json::parse(take.out);
  EXPECT_NEAR(of_take.at("error").get<double>(), 0, 2e-3);  // noise, kernel, bins of a degree
  EXPECT_EQ(of_take.at("frames"), kFrames);
  const auto map = calibrate({"verify", "--lux", lux, "--environment", sky_, "--json"});
  ASSERT_EQ(map.exit_code, 0) << map.err;
  EXPECT_NEAR(nlohmann::json::parse(map.out).at("error").get<double>(), 0, 5e-3);  // 16 rows: (π/16)²/8
  const auto half = calibrate({"verify", "--lux", std::to_string(3.14159265358979 * kSky_cd_m2 / 2),
                               "--environment", sky_, "--json"});
  EXPECT_NEAR(nlohmann::json::parse(half.out).at("stops").get<double>(), 1, 0.01);
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
}

}  // namespace
}  // namespace lightwell
