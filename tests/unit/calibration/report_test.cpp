// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "calibration/report/html_report.h"
#include "calibration/report/svg_plot.h"
#include "interface/atomic_file.h"
#include "tests/support/temporary_folder.h"

namespace lightwell::calibration {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

json a_lens() {
  return json::parse(R"({"schema":"lightwell.lens/1","model":"kannala-brandt","image_size":[640,480],
    "focal":[150,150],"center":[320,240],"k":[0,0,0,0],"max_theta_deg":80,"supported_theta_deg":71.2,
    "rms_px":0.3,"held_out_rms_px":0.31,
    "projection_uncertainty":{"theta_deg":[0,40,80],"azimuth_deg":[0,180],
      "sigma_px":[[0.01,0.01],[0.04,0.06],[0.5,1.3]],"largest_sigma_px":1.3},
    "coverage":{"ring_deg":40,"sector_deg":180,"points":[[1,2],[3,1]]},
    "views":[{"name":"a","used":true,"points":3,"rms_px":0.3,"rejected":[1],"reason":"",
      "residuals_px":[[10,20,0.3,0.4],[30,40,300,400],[50,60,0.3,0.4]]},
     {"name":"b","used":false,"points":3,"rms_px":200,"rejected":[],"reason":"blurred",
      "residuals_px":[[1,2,90,90],[3,4,90,90],[5,6,90,90]]}]})");
}

json a_response() {
  return json::parse(R"({"schema":"lightwell.response/1","model":"linear",
    "parameters":{"black":0,"gain":10},"bits":12,"black_code":0,"clip_code":4095,
    "reference_exposure_us":10000,
    "table":{"code":[10,1000,4000],"luminance_cd_m2":[1,100,400],"relative_sigma":[0.02,0.01,0.01]},
    "fit":{"t95":2.1,"parameters":{"black":0,"gain":10},"parameter_order":["black","gain"],
      "covariance":[[0.1,0],[0,0.2]],"usable_range":{"luminance_cd_m2":[1,400]},"rejected":["x"],
      "fit":[{"patch":"p","luminance_cd_m2":100,"code":1000,"relative_error":0.01,"stops":0.01,"used":true,
              "measured_cd_m2":101,"interval_95_cd_m2":[98,102]}],
      "check":[{"patch":"q","luminance_cd_m2":200,"code":2000,"relative_error":0.01,"stops":0.01,
                "measured_cd_m2":201,"inside_95":true,"interval_95_cd_m2":[190,210]}]}})");
}

class CalibrationPage : public testing::Test {
 protected:
  [[nodiscard]] Result<std::string> page_of(const char* name, const json& file) const {
    EXPECT_TRUE(write_file_atomically(folder_.path() / name, file.dump()));
    return calibration_page(folder_.path());
  }
  [[nodiscard]] std::string lens_page(const json& file) const {
    const auto page = page_of("lens.json", file);
    EXPECT_TRUE(page.ok()) << (page.ok() ? "" : page.error().message);
    return page.ok() ? *page : "";
  }
  // One line that names the file, whatever stands in place of the field.
  void expect_damage_is_refused(const char* name, const json& good, const std::string& field,
                                const std::vector<const char*>& values) const {
    ASSERT_TRUE(page_of(name, good).ok()) << page_of(name, good).error().message;
    for (const char* value : values) {
      json damaged = good;
      damaged.at(json::json_pointer(field)) = json::parse(value);
      const auto page = page_of(name, damaged);
      ASSERT_FALSE(page.ok()) << field << " = " << value;
      EXPECT_EQ(page.error().kind, ErrorKind::bad_input);
      EXPECT_THAT(page.error().message, HasSubstr(name));
      EXPECT_EQ(page.error().message.find('\n'), std::string::npos);
    }
  }

 private:
  test::TemporaryFolder folder_;
};

TEST_F(CalibrationPage, DamageInTheLensIsRefusedFieldByField) {
  const auto refused = [&](const std::string& field, const std::vector<const char*>& values) {
    expect_damage_is_refused("lens.json", a_lens(), field, values);
  };
  const std::vector<const char*> no_list = {"null", "7", "\"x\"", "{}"};
  for (const char* field : {"/views", "/views/0/residuals_px", "/views/0/rejected", "/coverage/points",
                            "/coverage/points/1", "/projection_uncertainty/sigma_px",
                            "/projection_uncertainty/sigma_px/1", "/projection_uncertainty/theta_deg"})
    refused(field, no_list);
  refused("/views/0/residuals_px/0", {"[]", "[1,2,3]", "[1,2,\"x\",4]", "[null,2,3,4]", "7"});
  refused("/views/0", {"null", "7", "[]"});
  refused("/views/0/name", {"7"});
  refused("/views/0/used", {"\"yes\""});
  refused("/views/0/reason", {"[]"});
  refused("/views/0/rejected", {"[\"x\"]", "[null]"});
  refused("/coverage", {"null", "7", "[]", "{}"});
  refused("/coverage/ring_deg", {"null", "\"x\""});
  refused("/coverage/points/0", {"[null]", "[[]]"});
  refused("/projection_uncertainty", {"null", "7", "[]", "{}"});
  refused("/projection_uncertainty/sigma_px", {"[[1,1],[1],[1,1]]", "[[1,1],[],[1,1]]", "[[1],[2],[null]]"});
  refused("/projection_uncertainty/theta_deg", {"[]", "[0,40]", "[0,40,null]"});
  refused("/projection_uncertainty/largest_sigma_px", {"null", "[]"});
  refused("/supported_theta_deg", {"null", "\"x\"", "[]"});
}

TEST_F(CalibrationPage, DamageInTheResponseIsRefusedFieldByField) {
  const auto refused = [&](const std::string& field, const std::vector<const char*>& values) {
    expect_damage_is_refused("response.json", a_response(), field, values);
  };
  refused("/fit", {"7", "\"x\"", "[1]"});
  refused("/fit/usable_range/luminance_cd_m2", {"null", "[]", "[1]", "[1,null]"});
  refused("/fit/parameter_order", {"null", "7", "[1,2]", "[\"a\",\"b\",\"c\"]"});
  refused("/fit/covariance", {"null", "7", "[]", "[[1,0]]", "[[1,0],[0]]", "[[1,0],[0,null]]"});
  refused("/fit/rejected", {"[7]"});
  for (const std::string patch : {"/fit/fit/0", "/fit/check/0"}) {
    refused(patch, {"null", "7", "[]"});
    refused(patch + "/patch", {"7"});
    refused(patch + "/interval_95_cd_m2", {"7", "{}", "[]", "[1]", "[1,\"x\"]"});
  }
  refused("/fit/fit/0/used", {"7"});
  refused("/fit/check/0/inside_95", {"7"});
  refused("/table/relative_sigma", {"null", "7", "[0.02,0.01,0.01,0.01,0.01]"});
}

std::size_t count_of(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

TEST_F(CalibrationPage, ShowsTheSixWorstViewsBesideAllAndNoFolders) {
  json file = a_lens();
  file["views"].clear();
  for (int v = 0; v < 9; ++v) {
    const std::string name = "/home/somebody/pictures/board_" + std::to_string(v) + ".png";
    file["views"].push_back({{"name", name},
                             {"used", v != 8},
                             {"points", 2},
                             {"rms_px", 0.1 * (v + 1)},
                             {"rejected", json::array()},
                             {"reason", ""},
                             {"residuals_px", {{100, 200, 0.3, 0.4}, {300, 40, -0.3, 0.2}}}});
  }
  file["views"][7]["repeats"] = "/home/somebody/pictures/board_1.png";
  const std::string page = lens_page(file);
  EXPECT_THAT(page, Not(HasSubstr("somebody")));
  EXPECT_EQ(count_of(page, "<figcaption>board_"), 6U);
  EXPECT_THAT(page, HasSubstr("<figcaption>board_7.png, 0.800 px</figcaption>"));
  EXPECT_THAT(page, Not(HasSubstr("<figcaption>board_8")));  // was not used
  EXPECT_THAT(page, Not(HasSubstr("<figcaption>board_1")));  // among the best
  EXPECT_THAT(page, HasSubstr("the pose of board_1.png again"));
  EXPECT_THAT(page, HasSubstr("1 view shows the board where another does"));
  EXPECT_THAT(page,
              HasSubstr("Each arrow goes from where a picture shows a point to where the lens puts it, "));
}

TEST_F(CalibrationPage, SaysThatTheProjectionWasHeldGrowing) {
  json file = a_lens();
  file["constrained"] = {{"theta_deg", 78.4}, {"least_slope", 0.02}, {"shift_sigma", 3.0}};
  EXPECT_THAT(lens_page(file), HasSubstr("stop growing at 78.4°, where it is held"));
  expect_damage_is_refused("lens.json", file, "/constrained", {"7", "[]", "{}"});
}

TEST_F(CalibrationPage, SaysHowManyPixelsWereNoPartOfAnEvenScene) {
  const json flat = {{"schema", "lightwell.flat/1"},
                     {"image_size", {640, 480}},
                     {"vignetting", {-0.1, 0, 0}},
                     {"fit", {{"masked_pixels", 312}}}};
  const auto page = page_of("flat.json", flat);
  ASSERT_TRUE(page.ok()) << page.error().message;
  EXPECT_THAT(*page, HasSubstr("312 pixels of lamps or dust were left out"));
}

TEST_F(CalibrationPage, HugeAndTinyNumbersMakeAPage) {
  for (const char* luminance : {"1e308", "5e-324", "1e-310", "1.7e308"}) {
    json file = a_response();
    for (const char* list : {"fit", "check"})
      file["fit"][list][0]["luminance_cd_m2"] = json::parse(luminance);
    EXPECT_TRUE(page_of("response.json", file).ok()) << luminance;
  }
  json lens = a_lens();
  lens["views"][0]["residuals_px"][0] = {1e308, -1e308, 1e308, 1e308};
  lens["views"][0]["rejected"] = {1e300, -1e300, -1, 0.5};
  lens["projection_uncertainty"]["sigma_px"][1] = {1e308, -1e308};
  lens["coverage"]["ring_deg"] = 1e308;
  EXPECT_THAT(lens_page(lens), HasSubstr("Kannala"));
}

// The number of ticks is that of the lines of the grid.
std::size_t grid_lines(const Axis& x, const Axis& y) {
  const std::string svg = SvgPlot(600, 300, x, y).svg();
  EXPECT_EQ(svg.find("nan"), std::string::npos) << svg;
  EXPECT_EQ(svg.find("inf"), std::string::npos) << svg;
  std::size_t count = 0;
  for (auto at = svg.find("class=\"grid\""); at != std::string::npos; at = svg.find("class=\"grid\"", at + 1))
    ++count;
  return count;
}

TEST(SvgPlot, HasAFewTicksWhateverItsLimits) {
  constexpr double kInf = std::numeric_limits<double>::infinity(),
                   kNan = std::numeric_limits<double>::quiet_NaN();
  const Axis plain{0, 1, false, ""};
  for (const auto& [low, high] : std::initializer_list<std::pair<double, double>>{{0, kInf},
                                                                                  {-kInf, kInf},
                                                                                  {kNan, 1},
                                                                                  {0, kNan},
                                                                                  {1e17, 1e17 + 16},
                                                                                  {0, 5e-324},
                                                                                  {3, 3},
                                                                                  {5, -5},
                                                                                  {-1e308, 1e308},
                                                                                  {1e308, 1e308}}) {
    const std::size_t lines = grid_lines({low, high, false, ""}, plain);
    EXPECT_GE(lines, 8u) << low << " " << high;
    EXPECT_LE(lines, 40u) << low << " " << high;
  }
  for (const auto& [low, high] : std::initializer_list<std::pair<double, double>>{
           {0, kInf}, {5e-324, 1e308}, {kNan, kNan}, {1, 1}, {1e308, kInf}, {-1, 10}})
    EXPECT_LE(grid_lines({low, high, true, ""}, plain), 40u) << low << " " << high;
}

TEST_F(CalibrationPage, SaysUpToWhereTheLensIsHeldAndHowUncertainItIsThereAndBeyond) {
  const std::string page = lens_page(a_lens());
  // Between 40 and 80 degrees: 0.06 + (71.2 - 40) / 40 · 1.24 = 1.027.
  EXPECT_THAT(page, HasSubstr("Good to 0.31 px, projection uncertain by 1.03 px up to 71.2°."));
  EXPECT_THAT(page,
              HasSubstr("no points beyond 71.2°, extrapolated to 80.0°, where projection is uncertain by "
                        "1.30 px or more."));
  json whole = a_lens();
  whole["supported_theta_deg"] = 80;
  EXPECT_THAT(lens_page(whole), HasSubstr("Good to 0.31 px, projection uncertain by 1.30 px."));
  EXPECT_THAT(lens_page(whole), Not(HasSubstr("beyond")));
}

TEST_F(CalibrationPage, PointsThatDoNotCountDoNotSetTheScaleOfTheArrows) {
  // The median of 0.5 px is drawn 0.02 of 640 px long.
  EXPECT_THAT(lens_page(a_lens()), HasSubstr("25.6 times as long"));
}

}  // namespace
}  // namespace lightwell::calibration
