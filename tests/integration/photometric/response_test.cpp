// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "interface/calibration_io.h"
#include "tests/integration/photometric/photometric_fixture.h"

namespace lightwell {
namespace {

using test::PhotometricTest;

class CalibrateResponse : public PhotometricTest {
 protected:
  static constexpr LogResponse kTruth{800, 208, 0.05};

  // Six patches over six decades and two to check, codes to a tenth.
  static std::string good_csv() {
    std::string text = "name,luminance_cd_m2,code,code_sigma,use\n";
    for (const double l : {0.1, 1.6, 25.0, 400.0, 6300.0, 1e5}) text += row(l, "fit");
    for (const double l : {8.0, 2000.0}) text += row(l, "check");
    return text;
  }
  static std::string row(double luminance, const std::string& use) {
    char line[120];
    std::snprintf(line, sizeof line, "grey %g,%g,%.1f,0.5,%s\n", luminance, luminance, kTruth.code(luminance),
                  use.c_str());
    return line;
  }
  std::vector<std::string> command(const std::string& csv) const {
    return {"response", path(csv), "--out", path("response.json"), "--json"};
  }
};

TEST_F(CalibrateResponse, WritesAResponseThatTheDaemonReadsAndAReport) {
  write("patches.csv", good_csv());
  const auto run = calibrate(command("patches.csv"));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto response = read_response(path("response.json"));
  ASSERT_TRUE(response) << response.error().message;
  for (double l = 0.1; l < 1e5; l *= 2)  // codes rounded to a tenth
    EXPECT_NEAR(response->luminance_cd_m2(kTruth.code(l)) / l, 1, 2e-3);

  const auto report = nlohmann::json::parse(run.out);
  EXPECT_EQ(report.at("model"), "log");
  EXPECT_EQ(report.at("selection"), "AICc");
  EXPECT_EQ(report.at("fit").size(), 6U);
  EXPECT_EQ(report.at("covariance").size(), 3U);
  ASSERT_EQ(report.at("check").size(), 2U);
  for (const auto& check : report.at("check")) {
    EXPECT_TRUE(check.at("inside_95").get<bool>());
    EXPECT_LT(std::abs(check.at("stops").get<double>()), 0.01);
  }
  EXPECT_TRUE(report.at("rejected").empty());
  const auto range = report.at("usable_range").at("luminance_cd_m2");
  EXPECT_LT(range[0].get<double>(), 1);
  EXPECT_GT(range[1].get<double>(), 9e4);

  const auto table = read_json("response.json").at("table");
  const auto &code = table.at("code"), &luminance = table.at("luminance_cd_m2");
  ASSERT_EQ(code.size(), luminance.size());
  ASSERT_EQ(code.size(), table.at("relative_sigma").size());
  for (std::size_t i = 1; i < code.size(); ++i) {
    ASSERT_EQ(code[i].get<int>(), code[i - 1].get<int>() + 1);
    ASSERT_GT(luminance[i].get<double>(), luminance[i - 1].get<double>());
  }
  EXPECT_GT(luminance[0].get<double>(), 0);
}

TEST_F(CalibrateResponse, AGivenModelIsNotCalledChosen) {
  write("patches.csv", good_csv());
  auto arguments = command("patches.csv");
  arguments.insert(arguments.end(), {"--model", "log"});
  const auto run = calibrate(arguments);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(nlohmann::json::parse(run.out).at("selection"), "given");
  EXPECT_EQ(nlohmann::json::parse(run.out).at("selection_rule"), "given");
  arguments = {"response", path("patches.csv"), "--out", path("response.json"), "--model", "log"};
  EXPECT_NE(calibrate(arguments).out.find("bits, given:"), std::string::npos);
}

TEST_F(CalibrateResponse, GuessesAreSaidOnStderrAndInTheFile) {
  write("patches.csv", good_csv());
  auto run = calibrate(command("patches.csv"));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  for (const char* says :
       {"bits = 12 is assumed", "--bits states it", "clip_code = 4095 is assumed", "--clip-code states it",
        "reference_exposure_us = 10000 is assumed", "--exposure-us"})
    EXPECT_THAT(run.err, testing::HasSubstr(says));
  EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 3);
  EXPECT_EQ(read_json("response.json").at("assumed"),
            nlohmann::json::parse(R"({"bits": 12, "clip_code": 4095, "reference_exposure_us": 10000})"));

  auto arguments = command("patches.csv");
  arguments.insert(arguments.end(), {"--bits", "12", "--clip-code", "4000", "--exposure-us", "8000"});
  run = calibrate(arguments);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.err, "");
  EXPECT_EQ(read_json("response.json").at("assumed"), nlohmann::json::object());
}

TEST_F(CalibrateResponse, ExposuresInTheFileSpreadFewCardsOverMoreDecades) {
  std::string text = "name,luminance_cd_m2,exposure_us,code,code_sigma\n";
  for (const double l : {5.0, 30.0, 200.0})
    for (const double exposure : {100.0, 10000.0}) {
      char line[100];
      std::snprintf(line, sizeof line, "card %g,%g,%g,%.1f,0.3\n", l, l, exposure,
                    kTruth.code(l * exposure / 100));
      text += line;
    }
  write("patches.csv", text);
  const auto run = calibrate(command("patches.csv"));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto response = read_response(path("response.json"));
  ASSERT_TRUE(response) << response.error().message;
  EXPECT_EQ(response->reference_exposure_us, 100);  // the first
  for (double l = 5; l < 2e4; l *= 2)               // codes rounded to a tenth
    EXPECT_NEAR(response->luminance_cd_m2(kTruth.code(l)) / l, 1, 3e-3);
  EXPECT_EQ(run.err.find("reference_exposure_us"), std::string::npos);
}

TEST_F(CalibrateResponse, ASpreadsheetsFileIsRead) {
  std::string text = "\xef\xbb\xbf" + good_csv();
  for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += 2) text.insert(at, "\r");
  text.replace(text.find("grey 25,"), 8, "\"grey 25, by the \"\"window\"\"\",");
  write("patches.csv", text);
  const auto run = calibrate(command("patches.csv"));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(nlohmann::json::parse(run.out).at("fit").at(2).at("patch"), "grey 25, by the \"window\"");
}

TEST_F(CalibrateResponse, ADarkCheckPatchHasAnIntervalInLightAndNoRatio) {
  write("patches.csv", good_csv() + "dark,0," + std::to_string(kTruth.code(0)) + ",0.5,check\n");
  const auto run = calibrate(command("patches.csv"));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto dark = nlohmann::json::parse(run.out).at("check").at(0);
  EXPECT_TRUE(dark.at("relative_error").is_null());
  EXPECT_TRUE(dark.at("stops").is_null());
  EXPECT_TRUE(dark.at("inside_95").get<bool>());
  EXPECT_EQ(dark.at("interval_95_cd_m2").at(0).get<double>(), 0);
  EXPECT_GT(dark.at("interval_95_cd_m2").at(1).get<double>(), 0);
  EXPECT_LT(dark.at("interval_95_cd_m2").at(1).get<double>(), 0.05);  // no light is not the toe's own size
}

TEST_F(CalibrateResponse, NamesTheBadPatchAndGoesOnWithoutIt) {
  std::string text = good_csv();
  text.replace(text.find(",25,"), 4, ",33,");
  write("patches.csv", text);
  const auto run = calibrate(command("patches.csv"));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(nlohmann::json::parse(run.out).at("rejected"), nlohmann::json::array({"grey 25"}));
}

TEST_F(CalibrateResponse, ColoursShareTheCurveAndMakeGreyGrey) {
  std::string text = "luminance_cd_m2,code,channel\n";
  for (const auto& [channel, gain] : {std::pair{"Red", 0.5}, {"G", 1.0}, {"b", 0.8}})
    for (const double l : {0.1, 1.6, 25.0, 400.0, 6300.0, 1e5})
      text += std::to_string(l) + "," + std::to_string(kTruth.code(gain * l)) + "," + channel + "\n";
  write("patches.csv", text);
  const auto run = calibrate(command("patches.csv"));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto m = read_json("response.json").at("rec709_from_camera");
  EXPECT_EQ(read_json("response.json").at("rec709_from_camera_is"), "grey balance");
  EXPECT_NEAR(m[0][0].get<double>(), 2, 1e-3);  // six digits of the codes
  EXPECT_NEAR(m[1][1].get<double>(), 1, 1e-3);
  EXPECT_NEAR(m[2][2].get<double>(), 1.25, 1e-3);
}

TEST_F(CalibrateResponse, BadInputIsRefusedInOneLineAndNothingIsChanged) {
  const struct {
    const char *csv, *names;
  } cases[] = {
      {"", "is empty"},
      {"luminance,code\n1,2\n", "column luminance_cd_m2 is missing"},
      {"luminance_cd_m2,code\n1,100\n10,200\n100,300\n", "number of patches to fit = 3"},
      {"luminance_cd_m2,code\n1,100\n10,200\n100,300\n1000,nan\n", "line 5: code = nan"},
      {"luminance_cd_m2,code\n1,100\n10,200\n100,300\n1000,4x\n", "line 5: code = 4x"},
      {"luminance_cd_m2,code\n1,100\n10,200\n100,300\n-5,400\n", "line 5: luminance_cd_m2 = -5"},
      {"luminance_cd_m2,code\n1,100\n10,200\n100,300\n100,400\n",
       "line 5: luminance_cd_m2 = 100 stands in line 4"},
      {"luminance_cd_m2,code\n1,100\n10,200\n100,150\n1000,400\n", "line 4: code = 150"},
      {"luminance_cd_m2,code\n1,100\n10,200\n100,300\n1000,1023\n", "line 5: code = 1023 is clipped"},
      {"luminance_cd_m2,code\n1,100\n10,200\n100,300\n1000,400\n10000,401\n", "line 6: code = 401"},
      {"luminance_cd_m2,code,exposure_us\n1,100,10\n10,200,0\n", "line 3: exposure_us = 0"},
      {"luminance_cd_m2,code\n1,0\n10,200\n100,300\n1000,1000\n", "line 2: code = 0 is clipped"},
      {"luminance_cd_m2,code\n1,100\n10,200,7\n", "line 3: 3 fields: allowed 2"},
      {"luminance_cd_m2,code,use\n1,100,never\n", "line 2: use = never"},
      {"luminance_cd_m2,code\n1e-320,100\n10,200\n100,300\n1000,400\n",
       "line 2: luminance_cd_m2 = 1e-320: allowed 0, or a number from 1e-9 to 1e12"},
      {"luminance_cd_m2;code\n1;100\n", "columns are separated by semicolons: allowed commas"},
      {"luminance_cd_m2,code,code\n1,100,100\n", "column code stands there twice"},
      {"luminance_cd_m2,code,channel\n1,100,G\n10,200,X\n",
       "line 3: channel = X: allowed R, G, B, or red, green, blue"},
      {"luminance_cd_m2,code,channel\n1,100,G\n10,200,\n", "line 3: channel = nothing: allowed R, G, B"},
      {"luminance_cd_m2,code,channel\n1,100,\n10,200,R\n", "line 3: channel = R: allowed nothing"},
  };
  for (const auto& c : cases) {
    write("patches.csv", c.csv);
    SCOPED_TRACE(c.names);
    expect_refused(command("patches.csv"), 3, c.names, "response.json");
  }
  expect_refused(command("absent.csv"), 3, "absent.csv", "response.json");
  expect_refused({"response", path(""), "--out", path("response.json")}, 3, path(""), "response.json");
}

TEST_F(CalibrateResponse, ARefusalIsOneLineThoughMuchWasAssumed) {
  write("patches.csv", good_csv());
  const auto run = calibrate({"response", path("patches.csv"), "--out", path("absent/response.json")});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
  EXPECT_EQ(run.out, "");
}

TEST_F(CalibrateResponse, NoCommandWritesAFileWithoutAName) {
  for (const std::vector<std::string>& command : {std::vector<std::string>{"response", "p.csv"},
                                                  {"lens", "--corners", "c.json"},
                                                  {"import", "l.yaml"},
                                                  {"orient", "lens.json", "--gravity", "0,0,1"},
                                                  {"chart"},
                                                  {"flat", "t.mkv", "--lens", "l", "--response", "r"},
                                                  {"brackets", "a", "b", "c"},
                                                  {"colour", "c.csv", "--response", "r"},
                                                  {"report", "dir"}})
    for (const char* out : {"", "-"}) {
      auto arguments = command;
      arguments.insert(arguments.end(), {"--out", out});
      const auto run = calibrate(arguments);
      EXPECT_EQ(run.exit_code, 2) << command[0] << run.err;
      EXPECT_THAT(run.err, testing::HasSubstr("--out: value '" + std::string(out) + "', allowed"));
      EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
    }
}

TEST_F(CalibrateResponse, WrongUsageEndsWithTwoAndAMissingFolderWithOne) {
  write("patches.csv", good_csv());
  expect_refused({"response", path("patches.csv"), "--recording", "t.mkv", "--positions", "p.csv",
                  "--code-sigma", "1", "--out", path("response.json")},
                 2, "--code-sigma goes without --recording", "response.json");
  expect_refused({"verify", "--lux", "1", "--environment", "e.exr", "--calibration", "dir"}, 2,
                 "--calibration goes with --recording", "response.json");
  auto arguments = command("patches.csv");
  arguments.insert(arguments.end(), {"--model", "cubic"});
  expect_refused(arguments, 2, "--model = cubic", "response.json");
  arguments = command("patches.csv");
  arguments.insert(arguments.end(), {"--luminance-error", "nan"});
  expect_refused(arguments, 2, "--luminance-error", "response.json");
  arguments = command("patches.csv");
  arguments.insert(arguments.end(), {"--bits", "3"});
  expect_refused(arguments, 2, "--bits = 3: allowed 8 to 16", "response.json");
  arguments = command("patches.csv");
  arguments.insert(arguments.end(), {"--bits", "12", "--clip-code", "9000"});
  expect_refused(arguments, 2, "--clip-code = 9000: allowed 1 to 4095", "response.json");
  arguments = command("patches.csv");
  arguments.insert(arguments.end(), {"--channel", "X"});
  expect_refused(arguments, 2, "--channel = X", "response.json");
  const auto run = calibrate({"response", path("patches.csv"), "--out", path("no/response.json")});
  EXPECT_EQ(run.exit_code, 1) << run.err;
}

}  // namespace
}  // namespace lightwell
