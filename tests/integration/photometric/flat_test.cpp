// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <limits>
#include <random>

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
  // The error that the report claims: noise of each pixel, and what all share through level, tilt and vignetting. The
  // shared part is one to five normal numbers: its square lies below 10.8 times its mean in 99.9 % of cases, whatever their
  // number (χ² of one degree has the longest tail).
  void expect_offsets(const FlatField& found, const nlohmann::json& report) const {
    const double own = report.at("offset_sigma_codes"), shared = report.at("offset_shared_sigma_codes");
    const double tolerance =
        std::sqrt(1.05 * own * own + 10.8 * shared * shared);  // √(2/12000) of own², and to spare
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
    EXPECT_GT(std::sqrt(square / n), 0.9 * own);
  }
  // Within four of the standard deviations that the report claims for the vignetting; one in 16000 lies beyond.
  void expect_transmission(const FlatField& found, const nlohmann::json& report, double most_sigma) const {
    for (double theta = 0.1; theta < setup_.model.calibration.lens.max_theta_rad; theta += 0.1) {
      double variance = 0;
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
          variance += report.at("covariance")[i][j].get<double>() *
                      std::pow(theta, static_cast<double>(2 * (i + j + 2)));
      const double error = found.transmission(theta) - setup_.model.calibration.flat.transmission(theta);
      EXPECT_LT(std::abs(error), 4 * std::sqrt(variance)) << theta;
      EXPECT_LT(std::sqrt(variance), most_sigma) << theta;
    }
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

// A sensor of its own, as MeanFrames: a take's mean is made without rendering its frames.
struct SyntheticSensor {
  Response response{LinearResponse{100, 2}, 12, 90, 4095, 10000};
  Lens lens;
  FlatField truth;
  double noise_codes = 1;
  std::uint64_t frames = 64;
  std::mt19937 random{3};

  explicit SyntheticSensor(int width, int height) {
    lens = simulator::default_lens(width, height);
    truth.image_size = lens.image_size;
    truth.vignetting = {-0.12, -0.01, 0};
  }
  // luminance of each pixel's direction
  calibration::MeanFrame mean(const std::function<double(const Vec3d&)>& luminance) {
    std::normal_distribution<double> normal;
    calibration::MeanFrame out;
    out.format = {lens.image_size[0], lens.image_size[1], PixelFormat::mono12};
    out.frames = frames;
    out.exposure_us = response.reference_exposure_us;
    for (int y = 0; y < out.format.height; ++y)
      for (int x = 0; x < out.format.width; ++x) {
        const std::size_t i = out.code.size();
        const double theta = std::min(lens.theta_rad(Vec2d(x, y)), lens.max_theta_rad);
        const double gain = truth.gain.empty() ? 1 : static_cast<double>(truth.gain[i]);
        const double offset = truth.offset_codes.empty() ? 0 : static_cast<double>(truth.offset_codes[i]);
        const double seen = gain * truth.transmission(theta) * luminance(lens.unproject(Vec2d(x, y)));
        out.code.push_back(response.code(seen) + offset +
                           noise_codes / std::sqrt(static_cast<double>(frames)) * normal(random));
        out.sigma.push_back(noise_codes);
      }
    return out;
  }
  calibration::MeanFrame even(double level) {
    return mean([=](const Vec3d&) { return level; });
  }
  void give_pattern(double columns, double offsets, double gains) {
    std::normal_distribution<double> normal;
    std::vector<double> column;
    for (int x = 0; x < lens.image_size[0]; ++x) column.push_back(columns * normal(random));
    truth.offset_codes.clear();
    truth.gain.clear();
    for (int i = 0; i < lens.image_size[0] * lens.image_size[1]; ++i) {
      truth.offset_codes.push_back(static_cast<float>(
          column[static_cast<std::size_t>(i % lens.image_size[0])] + offsets * normal(random)));
      if (gains > 0) truth.gain.push_back(static_cast<float>(std::exp(gains * normal(random))));
    }
  }
  // Root mean square of found / true gain − 1 within 80°.
  double gain_error(const FlatField& found) const {
    double square = 0, n = 0;
    for (std::size_t i = 0; i < truth.gain.size(); ++i) {
      const auto width = static_cast<std::size_t>(lens.image_size[0]);
      if (lens.theta_rad(Vec2d(static_cast<double>(i % width), static_cast<double>(i / width))) >
          80 * kPi / 180)
        continue;
      square += std::pow(static_cast<double>(found.gain[i] / truth.gain[i]) - 1, 2);
      ++n;
    }
    return std::sqrt(square / n);
  }
};

TEST(FlatFit, TheClaimedErrorOfVignettingHoldsUnderColumnNoise) {
  constexpr int kSeeds = 200;
  int inside = 0;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    SyntheticSensor sensor(61, 45);
    sensor.random.seed(seed);
    sensor.truth.vignetting = {-0.1, -0.04, 0};  // two terms beyond doubt: how many is not the question here
    sensor.give_pattern(3, 1, 0);
    const auto fit =
        calibration::fit_flat_field({{"even", sensor.even(800)}}, std::nullopt, sensor.lens, sensor.response);
    ASSERT_TRUE(fit) << fit.error().message;
    const double theta = 1.2;
    const Eigen::Vector3d row(std::pow(theta, 2), std::pow(theta, 4), std::pow(theta, 6));
    const double sigma = std::sqrt(row.dot(fit->covariance * row));
    inside += std::abs(fit->flat.transmission(theta) - sensor.truth.transmission(theta)) < 1.96 * sigma;
  }
  // 95 % of 200, and three standard deviations of √(200 · .95 · .05) = 3.1.
  EXPECT_GE(inside, 181);
  EXPECT_LE(inside, 199);
}

TEST(FlatFit, ATiltedSceneIsMultipliedByTheVignetting) {
  SyntheticSensor sensor(161, 120);
  sensor.give_pattern(1, 1, 0);
  const double tilt = 0.15;
  const auto tilted = sensor.mean([&](const Vec3d& d) {
    const Vec2d pixel = sensor.lens.project(d);
    const double x = (pixel.x() - sensor.lens.center.x()) / sensor.lens.focal.x() / sensor.lens.max_theta_rad;
    return 1500 * (1 + tilt * x);
  });
  const auto straight = sensor.even(1500);
  for (const auto& [take, tilt_of_it] : {std::pair{straight, 0.0}, std::pair{tilted, tilt}}) {
    const auto fit =
        calibration::fit_flat_field({{"even", take}}, std::nullopt, sensor.lens, sensor.response);
    ASSERT_TRUE(fit) << fit.error().message;
    EXPECT_NEAR(fit->tilt, tilt_of_it, 1e-3);  // 1.4 codes of 3000, 161 columns
    for (double theta = 0.1; theta < sensor.lens.max_theta_rad; theta += 0.1) {
      const Eigen::Vector3d row(std::pow(theta, 2), std::pow(theta, 4), std::pow(theta, 6));
      const double sigma = std::sqrt(row.dot(fit->covariance * row));
      // One in 16000 lies beyond.
      EXPECT_LT(std::abs(fit->flat.transmission(theta) - sensor.truth.transmission(theta)), 4 * sigma)
          << theta;
      EXPECT_LT(sigma, 1e-3) << theta;  // 1.4 codes of 3000 in some 10⁴ pixels, 161 columns
    }
    double square = 0, n = 0;
    for (std::size_t i = 0; i < sensor.truth.offset_codes.size(); ++i) {
      if (sensor.lens.theta_rad(Vec2d(static_cast<double>(i % 161), static_cast<double>(i / 161))) >
          85 * kPi / 180)
        continue;
      square += std::pow(static_cast<double>(fit->flat.offset_codes[i] - sensor.truth.offset_codes[i]), 2);
      ++n;
    }
    // As expect_offsets has it.
    EXPECT_LT(square / n, 1.05 * std::pow(fit->offset_sigma_codes, 2) +
                              10.8 * std::pow(fit->offset_shared_sigma_codes, 2));
  }
}

TEST(FlatFit, AWrongToeOfTheResponseDoesNotBecomeAnOffsetOfEveryPixel) {
  SyntheticSensor sensor(81, 60);
  const Response truth{LogResponse{800, 208, 0.05}, 12, 180, 4095, 10000};
  sensor.response = truth;
  sensor.give_pattern(2, 1, 0);
  const auto dark = sensor.even(0), even = sensor.even(500);
  double mean = 0, inside = 0;  // of the true pattern in the field: of a level, not of the pattern
  const auto in_field = [&](std::size_t i) {
    return sensor.lens.theta_rad(Vec2d(static_cast<double>(i % 81), static_cast<double>(i / 81))) <
           sensor.lens.max_theta_rad;
  };
  for (std::size_t i = 0; i < dark.code.size(); ++i)
    if (in_field(i)) mean += static_cast<double>(sensor.truth.offset_codes[i]), ++inside;
  mean /= inside;
  Response wrong = truth;
  wrong.model = LogResponse{800, 208, 0.02};  // at 500 cd/m² less than a fiftieth of a code
  const double toe_error = 208 * std::log(0.05 / 0.02);
  const auto expect_pattern = [&](const calibration::FlatFit& fit) {
    // The middle half's mean against the mean: their difference is below a fifth of 2.2 codes' scatter, √(81 columns).
    const double level = 2.2 / 9 * 3;
    EXPECT_NEAR(fit.dark_level_error_codes[0], toe_error + mean, level);
    const double taken = fit.dark_level_error_codes[0] - toe_error;
    double worst = 0;
    for (std::size_t i = 0; i < fit.flat.offset_codes.size(); ++i)
      worst = std::max(worst, std::abs(static_cast<double>(fit.flat.offset_codes[i]) + taken -
                                       static_cast<double>(sensor.truth.offset_codes[i])));
    EXPECT_LT(worst, 1.0 / 8 * 5);  // a code of noise over √64, five times: 4860 pixels
    const auto report = calibration::report_to_json(fit);
    EXPECT_EQ(report.at("dark_level_error_codes")[0], fit.dark_level_error_codes[0]);
  };
  const auto fit = calibration::fit_flat_field({{"even", even}}, dark, sensor.lens, wrong);
  ASSERT_TRUE(fit) << fit.error().message;
  expect_pattern(*fit);
  const std::vector<double> angles = {-50, 0, 50};
  std::vector<calibration::FlatTake> turned;
  for (const double angle : angles) turned.push_back({"turned " + std::to_string(angle), even});
  const auto by_turning = calibration::fit_turned_flat_field(turned, angles, dark, sensor.lens, wrong);
  ASSERT_TRUE(by_turning) << by_turning.error().message;
  expect_pattern(*by_turning);

  wrong.model = LogResponse{800, 208, 0};
  for (const auto& refused : {calibration::fit_flat_field({{"even", even}}, dark, sensor.lens, wrong),
                              calibration::fit_turned_flat_field(turned, angles, dark, sensor.lens, wrong)}) {
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().kind, ErrorKind::bad_input);
    EXPECT_THAT(refused.error().message, testing::HasSubstr("parameters.c = 0"));
  }
}

TEST(FlatFit, GainsComeFromSeveralLevelsOfALinearSensor) {
  SyntheticSensor sensor(81, 60);
  sensor.give_pattern(2, 1, 0.02);
  const auto one =
      calibration::fit_flat_field({{"a", sensor.even(1500)}}, std::nullopt, sensor.lens, sensor.response);
  ASSERT_TRUE(one) << one.error().message;
  EXPECT_TRUE(one->flat.gain.empty());
  const std::vector<calibration::FlatTake> levels = {
      {"a", sensor.even(1500)}, {"b", sensor.even(700)}, {"c", sensor.even(150)}};
  const auto several = calibration::fit_flat_field(levels, std::nullopt, sensor.lens, sensor.response);
  ASSERT_TRUE(several) << several.error().message;
  ASSERT_FALSE(several->flat.gain.empty());
  EXPECT_NEAR(several->gain_rms, 0.02, 0.002);  // as made; 3600 pixels
  // Gains count from what the levels and the vignetting took for 1: 2 % of scatter in some 2800 pixels of the field moves
  // eight parameters, .02 √(8/2800) = 0.11 %; in 99.9 % of cases by less than 1.8 times that (χ² of 8 degrees, 26.1).
  EXPECT_NEAR(several->gain_sigma, 0.0011, 0.0006);
  EXPECT_LT(sensor.gain_error(several->flat), 1.8 * several->gain_sigma);

  SyntheticSensor darkened = sensor;
  const auto dark = darkened.even(0);
  const auto with_dark =
      calibration::fit_flat_field({{"a", darkened.even(1500)}}, dark, sensor.lens, sensor.response);
  ASSERT_TRUE(with_dark) << with_dark.error().message;
  ASSERT_FALSE(with_dark->flat.gain.empty());
  EXPECT_LT(sensor.gain_error(with_dark->flat), 1.8 * with_dark->gain_sigma);
}

TEST(FlatFit, GainsThatNoiseHidesAreLeftOut) {
  SyntheticSensor sensor(81, 60);
  sensor.give_pattern(2, 1, 0);
  const std::vector<calibration::FlatTake> levels = {{"a", sensor.even(1500)}, {"b", sensor.even(150)}};
  const auto none = calibration::fit_flat_field(levels, std::nullopt, sensor.lens, sensor.response);
  ASSERT_TRUE(none) << none.error().message;
  EXPECT_TRUE(none->flat.gain.empty());
  EXPECT_TRUE(std::isfinite(none->gain_sigma));  // it could have been told

  sensor.response = {LogResponse{800, 208, 0.05}, 12, 180, 4095,
                     10000};  // offset and gain are the same thing
  sensor.give_pattern(2, 1, 0.02);
  const auto log = calibration::fit_flat_field({{"a", sensor.even(1500)}, {"b", sensor.even(15)}},
                                               std::nullopt, sensor.lens, sensor.response);
  ASSERT_TRUE(log) << log.error().message;
  EXPECT_TRUE(log->flat.gain.empty());
}

TEST(FlatFit, AGainIsWrittenReadAndTakenOutOfTheLight) {
  SyntheticSensor sensor(61, 45);
  sensor.give_pattern(0, 0, 0.1);
  Calibration calibration;
  calibration.response = sensor.response;
  calibration.lens = sensor.lens;
  calibration.flat = sensor.truth;
  const auto read = calibration_from_json(calibration_to_json(calibration), "attached");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_NE(read->id, [&] {
    Calibration other = calibration;
    other.flat.gain.clear();
    return calibration_id(other);
  }());
  Calibration dead = calibration;
  dead.flat.gain[5] = 1000;
  const Status refused = check(dead.flat, dead.lens);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, testing::HasSubstr("flat.gain[5] = 1000"));
  sensor.noise_codes = 0;
  const calibration::MeanFrame even = sensor.even(900);
  std::vector<std::byte> codes;
  for (const double code : even.code) {
    const auto word = static_cast<unsigned>(std::lround(code));
    codes.push_back(static_cast<std::byte>(word & 255));
    codes.push_back(static_cast<std::byte>(word >> 8));
  }
  auto radiometer = Radiometer::create(*read, even.format, {});
  ASSERT_TRUE(radiometer) << radiometer.error().message;
  PolarMap map = radiometer->make_map();
  radiometer->develop(codes, 10000, map);
  for (std::size_t b = 0; b < map.grid.size(); ++b)
    if (map.grid.ring_edge_rad(static_cast<int>(b) / map.grid.sectors) < 80 * kPi / 180) {
      // Half a code of 2 · 900 · T; T falls to 0.76. Gains are stored to 1/16384 of a half.
      ASSERT_NEAR(map.radiance[b] / 900, 1, 6e-4) << b;
    }
}

// A room with structure on every scale: nothing even in it.
double room(const Vec3d& d) {
  return 400 * (1 + 0.5 * std::sin(3 * d.x() + 1) + 0.3 * std::sin(5 * d.y()) * std::cos(4 * d.z()) +
                (d.x() > 0.3 && d.y() < 0.2 ? 0.6 : 0));
}

std::vector<calibration::FlatTake> turned_takes(SyntheticSensor& sensor, const std::vector<double>& angles,
                                                const Vec3d& axis) {
  std::vector<calibration::FlatTake> takes;
  for (const double angle : angles) {
    const Eigen::Matrix3d scene_from_camera = Eigen::AngleAxisd(angle * kPi / 180, axis).toRotationMatrix();
    takes.push_back({"turned " + std::to_string(angle),
                     sensor.mean([&](const Vec3d& d) { return room(scene_from_camera * d); })});
  }
  return takes;
}

TEST(FlatFit, TurningTellsVignettingFromAnUnevenScene) {
  const std::vector<double> angles = {-60, -30, 0, 30, 60};
  int inside = 0, all = 0;
  const std::vector<std::array<double, 3>> lenses = {
      {-0.12, -0.01, 0.0}, {-0.2, 0.0, 0.0}, {-0.05, -0.04, 0.006}};
  for (const std::array<double, 3>& vignetting : lenses) {
    SyntheticSensor sensor(161, 120);
    sensor.truth.vignetting = vignetting;
    const auto fit = calibration::fit_turned_flat_field(turned_takes(sensor, angles, Vec3d::UnitY()), angles,
                                                        std::nullopt, sensor.lens, sensor.response);
    ASSERT_TRUE(fit) << fit.error().message;
    for (double theta = 0.2; theta < 1.5; theta += 0.1) {
      const Eigen::Vector3d row(std::pow(theta, 2), std::pow(theta, 4), std::pow(theta, 6));
      const double sigma = std::sqrt(row.dot(fit->covariance * row));
      // Pixels of 1.1 degrees sample cells of two unevenly: 2 % of scatter, over some 5000 cells and three terms.
      EXPECT_NEAR(fit->flat.transmission(theta), sensor.truth.transmission(theta), 0.01) << theta;
      EXPECT_LT(sigma, 0.01);
      ++all;
      inside += std::abs(fit->flat.transmission(theta) - sensor.truth.transmission(theta)) < 4 * sigma + 1e-3;
    }
    EXPECT_TRUE(fit->flat.offset_codes.empty());
  }
  EXPECT_EQ(inside, all);
}

TEST(FlatFit, TurnsThatTellNothingAreRefused) {
  SyntheticSensor sensor(81, 60);
  const auto refused = [&](const std::vector<calibration::FlatTake>& takes, const std::vector<double>& angles,
                           const std::string& says) {
    const auto fit =
        calibration::fit_turned_flat_field(takes, angles, std::nullopt, sensor.lens, sensor.response);
    ASSERT_FALSE(fit) << says;
    EXPECT_EQ(fit.error().kind, ErrorKind::bad_input);
    EXPECT_NE(fit.error().message.find(says), std::string::npos) << fit.error().message;
  };
  refused(turned_takes(sensor, {0, 0, 0}, Vec3d::UnitY()), {0, 0, 0}, "turn the camera farther");
  refused(turned_takes(sensor, {0}, Vec3d::UnitY()), {0}, "number of turned takes = 1");
  refused(turned_takes(sensor, {0, 30, 60}, Vec3d::UnitY()), {0, -30, -60}, "are the angles right");
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
