// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "daemon/simulator/frame_generator.h"
#include "daemon/simulator/probe_setup.h"
#include "interface/calibration_io.h"
#include "interface/environment_io.h"
#include "interface/recording.h"
#include "lighting/flat_field.h"
#include "tests/integration/photometric/photometric_fixture.h"

namespace lightwell::test {

inline constexpr float kSky_cd_m2 = 500;
inline constexpr std::uint64_t kFlatFrames = 40;

// The simulated camera under a constant sky, recorded without waiting for real time.
class CalibrateFlat : public PhotometricTest {
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
    for (std::uint64_t i = 0; i < kFlatFrames; ++i) {
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

}  // namespace lightwell::test
