// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <cmath>
#include <cstring>
#include <fstream>
#include <optional>
#include <random>

#include "calibration/photometric/grey_chart.h"
#include "interface/calibration_io.h"
#include "interface/recording.h"
#include "lighting/lens.h"
#include "tests/integration/photometric/photometric_fixture.h"

namespace lightwell {
namespace {

using test::PhotometricTest;

// A chart of 4x2 patches before a fisheye, its patches shining over four decades, through a known response into a take.
class RecordedResponse : public PhotometricTest {
 protected:
  static constexpr LogResponse kTruth{900, 160, 0.05};
  static constexpr int kWidth = 400, kHeight = 300, kFrames = 8;
  static constexpr double kNoise_codes = 1.5;
  const calibration::GreyChart chart_{4, 2};
  const std::vector<double> luminances_ = {0.4, 2, 11, 50, 270, 1300, 9, 400};  // of patches 1 to 8
  const Lens lens_{{kWidth, kHeight}, {150, 150}, {200.3, 148.8}, {-0.02, 0.004, 0, 0}, kPi / 2};

  struct View {
    double distance = 4, tilt_deg = 20, turn_deg = 10, off_axis_deg = 15;  // distance in cells
  };
  struct Setup {
    View view;
    std::vector<double> exposures_us = {10000};
    PixelFormat format = PixelFormat::mono12;
    double top = 4095;  // where the sensor clips
    bool chart = true;
    double dust_codes = 0;  // of every fifth pixel column's every fifth row
  };

  // Luminance of the chart's plane: paper of 60, black of 2, patches of their own.
  [[nodiscard]] double chart_luminance(const Vec2d& p,
                                       const std::vector<calibration::ChartSquare>& squares) const {
    if (p.x() < 0 || p.y() < 0 || p.x() > chart_.columns || p.y() > chart_.rows + 2) return 8;
    const int column = static_cast<int>(p.x()), row = static_cast<int>(p.y()) - 1;
    const bool in_patch = std::abs(p.x() - column - 0.5) < 0.43 && std::abs(p.y() - row - 1.5) < 0.43;
    if (in_patch && row >= 0 && row < chart_.rows)
      return luminances_[static_cast<std::size_t>(row * chart_.columns + column)];
    for (const auto& s : squares)
      if (p.x() >= s.x && p.x() < s.x + s.size && p.y() >= s.y && p.y() < s.y + s.size) return 2;
    return 60;
  }

  [[nodiscard]] std::vector<double> picture(const Setup& setup) const {
    const auto rad = [](double deg) { return deg * kPi / 180; };
    const Eigen::Matrix3d facing =
        Eigen::AngleAxisd(rad(setup.view.off_axis_deg), Vec3d::UnitY()).toRotationMatrix();
    const Eigen::Matrix3d turn = (Eigen::AngleAxisd(rad(setup.view.tilt_deg), Vec3d::UnitX()) *
                                  Eigen::AngleAxisd(rad(setup.view.turn_deg), Vec3d::UnitZ()))
                                     .toRotationMatrix();
    const Eigen::Matrix3d camera_from_chart = facing * turn;
    const Vec3d middle = facing * Vec3d(0, 0, setup.view.distance);
    const Vec2d half(chart_.columns / 2.0, (chart_.rows + 2) / 2.0);
    const auto squares = calibration::black_squares(chart_);
    std::vector<double> out;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        double sum = 0;
        for (const double dy : {-0.25, 0.25})
          for (const double dx : {-0.25, 0.25}) {
            const Vec3d d = lens_.unproject(Vec2d(x + dx, y + dy));
            const Vec3d normal = camera_from_chart.col(2);
            const double t = normal.dot(middle) / normal.dot(d);
            const Vec3d p = camera_from_chart.transpose() * (t * d - middle);
            sum += !setup.chart || !(t > 0) ? 8 : chart_luminance(p.head<2>() + half, squares);
          }
        out.push_back(sum / 4);
      }
    return out;
  }

  void record(const std::string& name, const Setup& setup) {
    const FrameFormat format{kWidth, kHeight, setup.format};
    auto writer = RecordingWriter::create(path(name), {.format = format,
                                                       .rate_hz = 30,
                                                       .source = "simulated",
                                                       .calibration_json = "",
                                                       .start_utc_ns = 1'700'000'000'000'000'000});
    ASSERT_TRUE(writer) << writer.error().message;
    const std::vector<double> luminance = picture(setup);
    std::mt19937 random(5);
    std::normal_distribution<double> normal;
    std::vector<double> column;  // fixed pattern
    for (int x = 0; x < kWidth; ++x) column.push_back(0.7 * normal(random));
    for (std::size_t i = 0; i < kFrames * setup.exposures_us.size(); ++i) {
      RecordedFrame info;
      info.sequence = i;
      info.capture_mono_ns = static_cast<std::int64_t>(i) * 33'000'000;
      info.exposure_us = setup.exposures_us[i % setup.exposures_us.size()];
      info.temperature_c = 30;
      std::vector<std::uint16_t> words;
      for (std::size_t p = 0; p < luminance.size(); ++p) {
        const std::size_t x = p % kWidth, y = p / kWidth;
        double code =
            kTruth.code(luminance[p] * info.exposure_us / 10000) + column[x] + kNoise_codes * normal(random);
        if (x % 5 == 0 && y % 5 == 0) code += setup.dust_codes;
        words.push_back(static_cast<std::uint16_t>(std::lround(std::clamp(code, 0.0, setup.top))));
      }
      std::vector<std::byte> codes(2 * words.size());
      std::memcpy(codes.data(), words.data(), codes.size());
      ASSERT_TRUE((*writer)->write(info, codes));
    }
    ASSERT_TRUE((*writer)->close());
  }

  void SetUp() override {
    std::string csv = "patch,luminance_cd_m2,use\n";
    for (std::size_t i = 0; i < luminances_.size(); ++i)
      csv += std::to_string(i + 1) + "," + std::to_string(luminances_[i]) + (i < 6 ? ",fit\n" : ",check\n");
    write("patches.csv", csv);
    Calibration calibration;
    calibration.lens = lens_;
    calibration.response.model = kTruth;
    ASSERT_TRUE(write_calibration(path("truth"), calibration));
  }

  [[nodiscard]] std::vector<std::string> command(const std::string& take,
                                                 const std::vector<std::string>& more) const {
    std::vector<std::string> out = {"response", path("patches.csv"),   "--recording", path(take),
                                    "--out",    path("response.json"), "--json"};
    out.insert(out.end(), more.begin(), more.end());
    return out;
  }
  [[nodiscard]] std::vector<std::string> by_chart(const std::string& take) const {
    return command(take, {"--chart", "4x2", "--lens", path("truth/lens.json")});
  }
  // Relative; over the patches' range.
  void expect_truth(double low, double high, double tolerance) const {
    const auto response = read_response(path("response.json"));
    ASSERT_TRUE(response) << response.error().message;
    ASSERT_EQ(response->reference_exposure_us, 10000);  // the first frame's, the truth's too
    for (double l = low; l < high; l *= 1.5)
      EXPECT_NEAR(response->luminance_cd_m2(kTruth.code(l)) / l, 1, tolerance) << l;
  }
};

// The luminances are exact: what is left is the columns' pattern, 0.7 codes over some ten columns of a patch, of 160
// codes an e-fold: 0.14 %, times three and twice that at the ends.
constexpr double kPatternError = 0.01;

TEST_F(RecordedResponse, AChartSeenByAFisheyeGivesTheTrueResponse) {
  record("chart.mkv", {});
  const auto run = calibrate(by_chart("chart.mkv"));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  expect_truth(0.4, 1300, kPatternError);
  const auto report = nlohmann::json::parse(run.out);
  EXPECT_EQ(report.at("model"), "log");
  EXPECT_EQ(report.at("bits"), 12);
  EXPECT_EQ(report.at("assumed"),
            nlohmann::json::parse(R"({"clip_code": 4095})"));  // the take says the others
  EXPECT_EQ(report.at("measured_in").at("frames"), kFrames);
  EXPECT_EQ(report.at("measured_in").at("exposures_us"), nlohmann::json::array({10000}));
  EXPECT_EQ(report.at("check").size(), 2U);
  for (const auto& check : report.at("check")) EXPECT_TRUE(check.at("inside_95").get<bool>()) << check;
  EXPECT_TRUE(report.at("rejected").empty());
}

TEST_F(RecordedResponse, ASmallChartInTheMiddleNeedsNoLens) {
  Setup setup;
  setup.view = {7, 10, 5, 0};
  record("chart.mkv", setup);
  const auto run = calibrate(command("chart.mkv", {"--chart", "4x2"}));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  expect_truth(0.4, 1300, kPatternError);
}

TEST_F(RecordedResponse, PositionsFindPatchesWithoutMarkersAndDustIsLeftOut) {
  Setup setup;
  setup.dust_codes = -200;
  record("chart.mkv", setup);
  const auto chart = calibrate(by_chart("chart.mkv"));
  ASSERT_EQ(chart.exit_code, 0) << chart.err;
  std::string csv = "patch,x,y,w,h\n";
  const auto report = nlohmann::json::parse(chart.out);
  for (const auto& region : report.at("measured_in").at("regions")) {
    double x = 0, y = 0;
    for (const auto& c : region.at("corners")) x += c[0].get<double>() / 4, y += c[1].get<double>() / 4;
    csv += region.at("patch").get<std::string>() + "," + std::to_string(x - 5) + "," + std::to_string(y - 5) +
           ",11,11\n";
  }
  write("positions.csv", csv);
  const auto run = calibrate(command("chart.mkv", {"--positions", path("positions.csv")}));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  expect_truth(0.4, 1300, kPatternError);
}

TEST_F(RecordedResponse, SeveralExposuresReachFartherThanTheChart) {
  Setup setup;
  setup.exposures_us = {10000, 500, 200000};
  record("chart.mkv", setup);
  const auto run = calibrate(by_chart("chart.mkv"));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  expect_truth(0.4 / 20, 1300 * 20, 2 * kPatternError);
  EXPECT_EQ(nlohmann::json::parse(run.out).at("measured_in").at("exposures_us").size(), 3U);
}

TEST_F(RecordedResponse, WhereTheSensorClipsIsSeenAndAPatchThereIsLeftOutOfThatExposure) {
  Setup setup;
  setup.exposures_us = {10000, 500};
  setup.top = 2000;  // of patch 6, 1300 cd/m², code 2047 at 10 ms
  record("chart.mkv", setup);
  const auto run = calibrate(by_chart("chart.mkv"));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  expect_truth(0.4 / 20, 900, 2 * kPatternError);
  EXPECT_THAT(run.err, testing::HasSubstr("patch 6 at 10000 us: clipped, left out"));
  EXPECT_THAT(run.err, testing::HasSubstr("clip_code = 2000 is assumed, as pixels stand still there"));
  EXPECT_EQ(read_response(path("response.json"))->clip_code, 2000);
}

TEST_F(RecordedResponse, TheMosaicGivesAChannelForEachColour) {
  Setup setup;
  setup.format = PixelFormat::bayer_rg12;
  record("chart.mkv", setup);
  const auto run = calibrate(by_chart("chart.mkv"));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto report = nlohmann::json::parse(run.out);
  EXPECT_EQ(report.at("channel"), "G");
  ASSERT_EQ(report.at("channels").size(), 2U);
  for (const auto& c : report.at("channels"))
    EXPECT_NEAR(c.at("gain").get<double>(), 1, kPatternError);  // the simulated light is grey
}

TEST_F(RecordedResponse, WhatCannotBeMeasuredIsRefusedInOneLineAndNothingIsChanged) {
  const auto refused = [&](const std::vector<std::string>& arguments, const std::string& names) {
    SCOPED_TRACE(names);
    expect_refused(arguments, 3, names, "response.json");
  };
  record("chart.mkv", {});
  Setup none;
  none.chart = false;
  record("none.mkv", none);
  refused(by_chart("none.mkv"),
          "none.mkv: the chart was not found: of the markers 0 to 3 at its corners 0, 1, 2, 3 are missing");
  refused(by_chart("absent.mkv"), "absent.mkv");
  write("text.mkv", "no take");
  refused(by_chart("text.mkv"), "text.mkv");
  {  // a take that was cut within a frame
    const std::string whole = *read_text_file(path("chart.mkv"));
    std::ofstream(path("cut.mkv"), std::ios::binary) << whole.substr(0, whole.size() * 2 / 3);
    refused(by_chart("cut.mkv"), "cut.mkv");
    std::ofstream(path("header.mkv"), std::ios::binary) << whole.substr(0, 900);
    refused(by_chart("header.mkv"), "header.mkv");
  }
  refused(command("chart.mkv", {"--chart", "6x3", "--lens", path("truth/lens.json")}), "lie up to");
  Setup clipped;
  clipped.top = 2000;
  record("clipped.mkv", clipped);
  refused(by_chart("clipped.mkv"), "patch 6: code = 2000 is clipped");
  auto arguments = by_chart("chart.mkv");
  arguments.insert(arguments.end(), {"--bits", "10"});
  refused(arguments, "codes of 12 bits");

  const auto by_positions = command("chart.mkv", {"--positions", path("positions.csv")});
  const struct {
    const char *csv, *names;
  } positions[] = {
      {"patch,x,y,w,h\n1,390,10,30,30\n", "patch 1 reaches from (389.5, 9.5) to (419.5, 39.5)"},
      {"patch,x,y,w,h\n1,10,10,3,3\n", "patch 1 has 9 pixels: allowed at least 16"},
      {"patch,x,y,w,h\n1,10,10,3,nan\n", "line 2: h = nan"},
      {"patch,x,y,w\n1,10,10,3\n", "column h is missing"},
      {"patch,x,y,w,h\n1,10,10,30,30\n1,50,50,30,30\n", "line 3: patch = 1: allowed a name, once"},
      {"patch,x,y,w,h\nA,10,10,30,30\n", "patch = 1: allowed one of"},
  };
  for (const auto& p : positions) {
    std::string csv = p.csv;
    if (std::string(p.names).find("reaches") != std::string::npos ||
        std::string(p.names).find("pixels") != std::string::npos)
      for (int i = 2; i <= 8; ++i) csv += std::to_string(i) + ",10,10,30,30\n";
    write("positions.csv", csv);
    refused(by_positions, p.names);
  }
  write("patches.csv", "patch,luminance_cd_m2\n9,5\n");
  refused(by_chart("chart.mkv"), "patches.csv: patch = 9: allowed 1 to 8");
  write("patches.csv", "patch,luminance_cd_m2\n1,nan\n");
  refused(by_chart("chart.mkv"), "line 2: luminance_cd_m2 = nan");
  write("patches.csv", "patch,luminance_cd_m2\n1,5\n1,6\n");
  refused(by_chart("chart.mkv"), "line 3: patch = 1 stands there twice");
}

TEST_F(RecordedResponse, WrongUsageNamesTheOption) {
  expect_refused(command("chart.mkv", {}), 2, "--recording needs one of --positions and --chart",
                 "response.json");
  expect_refused({"response", path("patches.csv"), "--out", path("response.json"), "--chart", "4x2"}, 2,
                 "--chart needs --recording", "response.json");
  expect_refused(command("chart.mkv", {"--chart", "1x9"}), 2, "--chart = 1x9: allowed COLSxROWS",
                 "response.json");
}

TEST_F(RecordedResponse, ThePrintedChartHasItsMarkersAndPatches) {
  const auto run = calibrate({"chart", "--patches", "4x2", "--cell-mm", "50", "--out", path("chart.svg")});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const std::string svg = *read_text_file(path("chart.svg"));
  EXPECT_THAT(svg, testing::HasSubstr("width=\"200mm\" height=\"200mm\""));
  EXPECT_THAT(svg, testing::HasSubstr(">8</text>"));
  EXPECT_EQ(svg.find(">9</text>"), std::string::npos);
  expect_refused({"chart", "--patches", "0x2", "--out", path("chart.svg")}, 2, "allowed COLSxROWS",
                 "chart.svg");
  expect_refused({"chart", "--cell-mm", "nan", "--out", path("chart.svg")}, 2, "--cell-mm", "chart.svg");
}

}  // namespace
}  // namespace lightwell
