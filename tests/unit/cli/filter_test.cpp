// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numeric>
#include <string>
#include <vector>

#include "cli/command.h"

namespace lightwell::cli {
namespace {

struct Outcome {
  int code = -1;
  std::string out, err;
};

Outcome run_filter(const std::string& arguments) {
  CLI::App app;
  const auto commands = add_commands(app);
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  Outcome outcome;
  app.parse("filter " + arguments);
  for (const auto& command : commands)
    if (command.app->parsed()) outcome.code = command.run();
  outcome.out = testing::internal::GetCapturedStdout();
  outcome.err = testing::internal::GetCapturedStderr();
  return outcome;
}

TEST(FilterCommand, JsonHasTapsGainDelayAndRipple) {
  const Outcome outcome = run_filter("--rate 60 --pass 12 --stop 20 --order 16 --json");
  ASSERT_EQ(outcome.code, 0);
  const auto json = nlohmann::json::parse(outcome.out);
  const auto taps = json.at("taps").get<std::vector<double>>();
  EXPECT_EQ(taps.size(), 17u);
  EXPECT_NEAR(std::accumulate(taps.begin(), taps.end(), 0.0), 1, 1e-9);  // decimal text of a double and back
  EXPECT_NEAR(json.at("dc_gain").get<double>(), 1, 1e-9);
  EXPECT_EQ(json.at("delay_frames").get<double>(), 8);
  EXPECT_GT(json.at("stop_attenuation_db").get<double>(), 20);
  EXPECT_GT(json.at("pass_ripple_db").get<double>(), 0);
}

TEST(FilterCommand, MinimumPhaseIsTheSameFilterWithLessDelay) {
  const auto linear =
      nlohmann::json::parse(run_filter("--rate 60 --pass 12 --stop 20 --order 16 --json").out);
  const auto minimum = nlohmann::json::parse(
      run_filter("--rate 60 --pass 12 --stop 20 --order 16 --phase minimum --json").out);
  EXPECT_EQ(linear.at("phase"), "linear");
  EXPECT_EQ(minimum.at("phase"), "minimum");
  EXPECT_NEAR(minimum.at("stop_attenuation_db").get<double>(), linear.at("stop_attenuation_db").get<double>(),
              0.01);  // gains agree to 1e-6
  EXPECT_LT(minimum.at("delay_frames").get<double>(), linear.at("delay_frames").get<double>() / 2);
}

TEST(FilterCommand, ValueOutOfRangeIsUsageInOneLineThatNamesIt) {
  for (const char* arguments :
       {"--rate 0 --pass 12 --stop 20 --order 8", "--rate 60 --pass 12 --stop 30 --order 8",
        "--rate 60 --pass 22 --stop 20 --order 8", "--rate 60 --pass 12 --stop 20 --order 0",
        "--rate nan --pass 12 --stop 20 --order 8"}) {
    const Outcome outcome = run_filter(arguments);
    EXPECT_EQ(outcome.code, 2) << arguments;
    EXPECT_TRUE(outcome.out.empty());
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_NE(outcome.err.find("out of range"), std::string::npos);
  }
}

}  // namespace
}  // namespace lightwell::cli
