// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <random>
#include <sstream>

#include "calibration/report/svg_plot.h"
#include "interface/calibration_io.h"
#include "interface/environment_io.h"
#include "interface/jpeg.h"
#include "tests/integration/photometric/photometric_fixture.h"

namespace lightwell {
namespace {

class CalibrateMore : public test::PhotometricTest {
 protected:
  // A smooth scene of five decades through the curve code = 255 x^(1/2.2), as a camera without EXIF saves it.
  std::string photograph(const std::string& name, double exposure_s, int width = 1024) const {
    std::vector<std::uint8_t> rgb;
    for (int y = 0; y < 768; ++y)
      for (int x = 0; x < width; ++x) {
        const double radiance = std::pow(10, 5.0 * x / width - 3) * (1 + 0.5 * y / 768);
        const double code = 255 * std::pow(std::min(1.0, radiance * exposure_s), 1 / 2.2);
        rgb.insert(rgb.end(), 3, static_cast<std::uint8_t>(std::lround(code)));
      }
    return write(name, *encode_jpeg(width, 768, rgb, 98));
  }
  void expect_curve_from(const std::vector<double>& seconds, const std::string& solver) const {
    std::vector<std::string> command = {"brackets"};
    std::string times;
    for (std::size_t i = 0; i < seconds.size(); ++i) {
      command.push_back(photograph("p" + std::to_string(i) + ".jpg", seconds[i]));
      times += (i > 0 ? "," : "") + std::to_string(seconds[i]);
    }
    command.insert(command.end(),
                   {"--exposures", times, "--solver", solver, "--out", path("response.json"), "--json"});
    const auto run = calibrate(command);
    ASSERT_EQ(run.exit_code, 0) << run.err;
    EXPECT_LT(nlohmann::json::parse(run.out).at("median_error").get<double>(), 0.05);
    const auto response = read_response(path("response.json"));
    ASSERT_TRUE(response) << response.error().message;
    EXPECT_EQ(response->bits, 8);
    // A third of a code at code 30, where the curve rises by 7 % a code: medians of thousands of pixels of 8 bits.
    for (double code = 30; code <= 230; code += 10) {
      const double truth = std::pow(code / 118, 2.2);
      EXPECT_NEAR(response->luminance_cd_m2(code) / response->luminance_cd_m2(118) / truth, 1, 0.02) << code;
    }
  }
};

TEST(PlainNumber, HasThreeDigitsAndNoComputersExponent) {
  const struct {
    double value;
    const char* text;
  } cases[] = {{0, "0"},        {0.11, "0.11"},       {6300, "6300"}, {12.34, "12.3"}, {-2, "-2"},
               {100000, "10⁵"}, {123456, "1.23·10⁵"}, {99960, "10⁵"}, {1e-4, "10⁻⁴"},  {0.00123, "0.00123"}};
  for (const auto& c : cases) EXPECT_EQ(calibration::plain_number(c.value), c.text);
}

TEST_F(CalibrateMore, BracketsGiveBackTheCurveTheyWereMadeWith) {
  std::vector<double> seconds;
  for (int i = 0; i < 7; ++i) seconds.push_back(std::pow(4, -i));
  expect_curve_from(seconds, "debevec");
}

// Even steps leave what repeats from step to step undetermined; Debevec's solver smooths it away, this one does not.
TEST_F(CalibrateMore, RobertsonsSolverGivesTheCurveFromUnevenSteps) {
  std::vector<double> seconds;
  for (int i = 0; i < 9; ++i) seconds.push_back(std::pow(2.6, -i) * (i % 2 == 0 ? 1 : 0.7));
  expect_curve_from(seconds, "robertson");
}

TEST_F(CalibrateMore, OfficeBracketsForetellUnseenExposuresToFivePercent) {
  const std::filesystem::path folder = LIGHTWELL_TEST_DATA "/photometric/office_fisheye_brackets";
  if (!std::filesystem::exists(folder / "IMG_6955.JPG")) GTEST_SKIP() << folder << " is not there";
  std::vector<std::string> command = {"brackets"};
  for (int i = 6955; i <= 6971; i += 2)
    command.push_back((folder / ("IMG_" + std::to_string(i) + ".JPG")).string());
  command.insert(command.end(), {"--out", path("response.json"), "--radiance", path("office.exr"), "--json"});
  const auto run = calibrate(command);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto report = nlohmann::json::parse(run.out);
  EXPECT_LE(report.at("median_error").get<double>(), 0.05);
  EXPECT_EQ(report.at("predictions").size(), 7U);
  EXPECT_TRUE(report.at("absolute").get<bool>());
  EXPECT_TRUE(read_response(path("response.json")));
  const auto radiance = read_environment(path("office.exr"));
  ASSERT_TRUE(radiance) << radiance.error().message;
  EXPECT_EQ(radiance->image.width, 1404);
}

TEST_F(CalibrateMore, OfficeBracketsGiveTheResponseThatCameWithThem) {
  const std::filesystem::path folder = LIGHTWELL_TEST_DATA "/photometric/office_fisheye_brackets";
  const auto text = read_text_file(folder / "Response_function.rsp");
  if (!text || !std::filesystem::exists(folder / "IMG_6955.JPG")) GTEST_SKIP() << folder << " is not there";
  // A line a channel: the degree, then the coefficients of exposure(code / 255), the highest first.
  std::istringstream lines(*text);
  std::array<std::vector<double>, 3> polynomials;
  for (auto& polynomial : polynomials) {
    int degree = 0;
    ASSERT_TRUE(lines >> degree);
    polynomial.resize(static_cast<std::size_t>(degree) + 1);
    for (double& coefficient : polynomial) ASSERT_TRUE(lines >> coefficient);
  }
  const auto theirs = [&](double code) {
    double value = 0;
    for (const double coefficient : polynomials[1]) value = value * code / 255 + coefficient;
    return value;
  };
  std::vector<std::string> command = {"brackets"};
  for (int i = 6955; i <= 6971; i += 2)
    command.push_back((folder / ("IMG_" + std::to_string(i) + ".JPG")).string());
  command.insert(command.end(), {"--out", path("response.json")});
  const auto run = calibrate(command);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto response = read_response(path("response.json"));
  ASSERT_TRUE(response) << response.error().message;
  for (double code = 50; code <= 200; code += 10) {
    const double ours = response->luminance_cd_m2(code) / response->luminance_cd_m2(118);
    // Theirs is another program's polynomial for the three channels, fitted to the same photographs: two estimates.
    EXPECT_NEAR(ours / (theirs(code) / theirs(118)), 1, 0.15) << code;
  }
}

TEST_F(CalibrateMore, ThreeBracketsForetellNothingAndSaySo) {
  const auto a = photograph("a.jpg", 1), b = photograph("b.jpg", 0.25), c = photograph("c.jpg", 0.06);
  std::vector<std::string> command = {"brackets",           a, b, c, "--exposures", "1,0.25,0.06", "--out",
                                      path("response.json")};
  const auto text = calibrate(command);
  ASSERT_EQ(text.exit_code, 0) << text.err;
  EXPECT_THAT(text.out, testing::HasSubstr("error unknown: no exposure was kept out"));
  EXPECT_THAT(text.out, testing::Not(testing::HasSubstr("0.00 %")));
  command.emplace_back("--json");
  const auto report = nlohmann::json::parse(calibrate(command).out);
  EXPECT_TRUE(report.at("median_error").is_null());
  EXPECT_TRUE(report.at("channel_median_error").at(1).is_null());
  EXPECT_TRUE(report.at("predictions").empty());
  EXPECT_TRUE(read_json("response.json").at("brackets").at("median_error").is_null());
  ASSERT_EQ(calibrate({"report", path(""), "--out", path("report.html")}).exit_code, 0);
  EXPECT_THAT(*read_text_file(path("report.html")), testing::HasSubstr("says nothing about its error"));
}

TEST_F(CalibrateMore, BracketsThatCannotBeSolvedAreRefused) {
  const auto a = photograph("a.jpg", 1), b = photograph("b.jpg", 0.25), c = photograph("c.jpg", 0.06);
  const auto small = photograph("small.jpg", 0.06, 512);
  const auto out = path("response.json");
  expect_refused({"brackets", a, b, c, "--out", out}, 3, "has no exposure time", "response.json");
  expect_refused({"brackets", a, b, "--exposures", "1,0.25", "--out", out}, 3, "number of photographs = 2",
                 "response.json");
  expect_refused({"brackets", a, b, c, "--exposures", "1,1,0.06", "--out", out}, 3, "allowed different ones",
                 "response.json");
  expect_refused({"brackets", a, b, small, "--exposures", "1,0.25,0.06", "--out", out}, 3, "size differs",
                 "response.json");
  expect_refused({"brackets", a, b, c, "--exposures", "1,2", "--out", out}, 2, "--exposures",
                 "response.json");
  expect_refused({"brackets", a, b, write("x.jpg", "none"), "--exposures", "1,2,3", "--out", out}, 3, "x.jpg",
                 "response.json");
}

TEST_F(CalibrateMore, BracketsWriteBothFilesOrNeitherAndNoneOfTheirInputs) {
  const auto a = photograph("a.jpg", 1), b = photograph("b.jpg", 0.25), c = photograph("c.jpg", 0.06);
  const std::vector<std::string> command = {"brackets", a, b, c, "--exposures", "1,0.25,0.06"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), command.begin(), command.end());
    return more;
  };
  const auto unwritable =
      calibrate(with({"--out", path("absent/response.json"), "--radiance", path("r.exr")}));
  EXPECT_EQ(unwritable.exit_code, 1);
  EXPECT_FALSE(std::filesystem::exists(path("r.exr")));
  const auto other = calibrate(with({"--out", path("response.json"), "--radiance", path("absent/r.exr")}));
  EXPECT_EQ(other.exit_code, 1);
  EXPECT_FALSE(std::filesystem::exists(path("response.json")));
  expect_refused(with({"--out", path("one"), "--radiance", path("one")}), 2, "--radiance and --out name one",
                 "one");
  for (const char* option : {"--out", "--radiance"}) {
    const auto before = *read_text_file(b);
    const auto run =
        calibrate(with({option == std::string("--out") ? "--radiance" : "--out", path("o"), option, b}));
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_THAT(run.err, testing::HasSubstr("is also the input " + b));
    EXPECT_EQ(*read_text_file(b), before);
    EXPECT_FALSE(std::filesystem::exists(path("o")));
  }
}

TEST_F(CalibrateMore, MoreBracketsThanCanBeComparedAreRefusedUnread) {
  std::vector<std::string> command = {"brackets"};
  for (int i = 0; i < 31; ++i) command.push_back(path("absent.jpg"));
  command.insert(command.end(), {"--out", path("response.json")});
  expect_refused(command, 3, "number of photographs = 31: allowed 3 to 30", "response.json");
}

TEST_F(CalibrateMore, ColourAndReportDoNotOverwriteWhatTheyRead) {
  write("response.json",
        R"({"schema":"lightwell.response/1","model":"linear","parameters":{"black":0,"gain":10},)"
        R"("bits":12,"black_code":0,"clip_code":4095,"reference_exposure_us":10000})");
  const std::string chart =
      "name,camera_r,camera_g,camera_b,rec709_r,rec709_g,rec709_b\n"
      "white,50,100,80,100,100,100\nred,20,5,2,40,5,2.5\ngreen,4,40,10,8,40,12.5\nblue,3,10,32,6,10,40\n";
  write("chart.csv", chart);
  const auto colour = calibrate(
      {"colour", path("chart.csv"), "--response", path("response.json"), "--out", path("chart.csv")});
  EXPECT_EQ(colour.exit_code, 2);
  EXPECT_THAT(colour.err, testing::HasSubstr("is also the input"));
  EXPECT_EQ(*read_text_file(path("chart.csv")), chart);
  const std::string response = *read_text_file(path("response.json"));
  const auto report = calibrate({"report", path(""), "--out", path("response.json")});
  EXPECT_EQ(report.exit_code, 2);
  EXPECT_THAT(report.err, testing::HasSubstr("is also the input"));
  EXPECT_EQ(*read_text_file(path("response.json")), response);
  EXPECT_EQ(calibrate({"colour", path("chart.csv"), "--response", path("response.json"), "--out",
                       path("response.json")})
                .exit_code,
            0);  // the documented way
}

TEST_F(CalibrateMore, ColourChartGivesTheMatrixAndKeepsTheRestOfTheFile) {
  write("response.json",
        R"({"schema":"lightwell.response/1","model":"linear","parameters":{"black":0,"gain":10},)"
        R"("bits":12,"black_code":0,"clip_code":4095,"reference_exposure_us":10000,"fit":{"kept":1},)"
        R"("rec709_from_camera":[[2,0,0],[0,1,0],[0,0,3]],"rec709_from_camera_is":"grey balance"})");
  std::string csv = "name,camera_r,camera_g,camera_b,rec709_r,rec709_g,rec709_b\n";
  csv += "white,50,100,80,100,100,100\nred,20,5,2,40,5,2.5\ngreen,4,40,10,8,40,12.5\nblue,3,10,32,6,10,40\n";
  write("chart.csv", csv);
  const auto run = calibrate(
      {"colour", path("chart.csv"), "--response", path("response.json"), "--out", path("made.json")});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto made = read_json("made.json");
  EXPECT_NEAR(made.at("rec709_from_camera")[0][0].get<double>(), 2, 1e-9);
  EXPECT_NEAR(made.at("rec709_from_camera")[2][2].get<double>(), 1.25, 1e-9);
  EXPECT_EQ(made.at("fit").at("kept"), 1);
  EXPECT_EQ(made.at("rec709_from_camera_is"), "colour chart");  // no longer a grey balance
  EXPECT_TRUE(read_response(path("made.json")));
  write("chart.csv", csv + "x,1,nan,2,3,4,5\n");
  expect_refused({"colour", path("chart.csv"), "--response", path("response.json"), "--out", path("o.json")},
                 3, "line 6: camera_g = nan", "o.json");
}

TEST_F(CalibrateMore, ReportIsOnePageWithTheVerdictAndNothingToLoad) {
  std::string csv = "name,luminance_cd_m2,code,code_sigma,use\n";
  for (const double l : {0.1, 1.6, 25.0, 400.0, 6300.0, 1e5})
    csv += "grey <" + std::to_string(l) + ">," + std::to_string(l) + "," +
           std::to_string(800 + 208 * std::log(l + 0.05)) + ",0.5,fit\n";
  write("patches.csv", csv);
  std::filesystem::create_directory(path("dir"));
  ASSERT_EQ(calibrate({"response", path("patches.csv"), "--out", path("dir/response.json")}).exit_code, 0);
  write("dir/lens.json",
        R"({"schema":"lightwell.lens/1","model":"kannala-brandt","image_size":[640,480],"focal":[150,150],)"
        R"("center":[320,240],"k":[0,0,0,0],"max_theta_deg":90,"rms_px":0.31,"held_out_rms_px":null,)"
        R"("views":[{"name":"a&b","used":true,"points":2,"rms_px":0.3,"rejected":[],"reason":"",)"
        R"("residuals_px":[[10,20,0.1,-0.2],[30,40,0.3,0.1]]}],)"
        R"("coverage":{"ring_deg":10,"sector_deg":180,"points":[[1,2],[3,0],[0,0]]}})");
  const auto run = calibrate({"report", path("dir"), "--out", path("report.html")});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const std::string page = *read_text_file(path("report.html"));
  EXPECT_NE(page.find("Good to 0.31 px and "), std::string::npos);
  EXPECT_NE(page.find("no points beyond 20°"), std::string::npos);
  EXPECT_NE(page.find(" from 0.1 to 10⁵ cd/m²"), std::string::npos);
  EXPECT_NE(page.find("bits = 12, clip_code = 4095, reference_exposure_us = 10000 were assumed, not stated"),
            std::string::npos);
  EXPECT_NE(page.find("a&amp;b"), std::string::npos);
  EXPECT_EQ(page.find("grey <"), std::string::npos);  // escaped
  for (const char* loaded : {"<script", "src=", "href=", "url(", "@import"})
    EXPECT_EQ(page.find(loaded), std::string::npos) << loaded;
}

TEST_F(CalibrateMore, ReportOfNothingOrOfDamageIsRefused) {
  std::filesystem::create_directory(path("dir"));
  expect_refused({"report", path("dir"), "--out", path("r.html")}, 3, "holds no response.json", "r.html");
  write("dir/response.json", "{");
  expect_refused({"report", path("dir"), "--out", path("r.html")}, 3, "response.json", "r.html");
}

}  // namespace
}  // namespace lightwell
