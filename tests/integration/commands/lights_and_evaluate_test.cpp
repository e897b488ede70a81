// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <utility>

#include "interface/atomic_file.h"
#include "interface/light_set_io.h"
#include "lighting/decomposition/decompose.h"
#include "lighting/lat_long_image.h"
#include "tests/integration/commands/command_fixture.h"

namespace lightwell {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class Commands : public test::CommandTest {};

double relative(const Rgbd& a, const Rgbd& b) {
  return (a - b).abs().maxCoeff() / b.maxCoeff();
}

Rgbd sum(const LightSet& set) {
  Rgbd total = Rgbd::Zero();
  for (const auto& light : set.lights) total += light.illuminance.cast<double>();
  return total;
}

TEST_F(Commands, EveryMethodWritesTheSetItPromisesOnBothCoverages) {
  for (const Method method : kMethods)
    for (const bool sphere : {false, true}) {
      const auto run =
          lightwell({"lights", path("sky.exr"), "--count", "20", "--method", std::string(name(method)),
                     sphere ? "--sphere" : "--hemisphere", "--out", path("l.json"), "--json"});
      ASSERT_EQ(run.exit_code, 0) << run.err;
      EXPECT_EQ(json::parse(run.out)["count"], 20);
      const LightSet set = read_light_set(path("l.json")).value();
      EXPECT_EQ(set.method, name(method));
      EXPECT_EQ(set.coverage, sphere ? Coverage::sphere : Coverage::hemisphere);
      EXPECT_EQ(set.lights.size(), 20u);
      const Rgbd total = total_illuminance(polar_map_from_lat_long(sky(48, 24), !sphere));
      EXPECT_LT(relative(set.total_illuminance.cast<double>(), total), 1e-6);  // float rounding
      EXPECT_LT(relative(sum(set), total), 1e-5);                              // float rounding of 20 lights
      for (const auto& light : set.lights) EXPECT_GE(light.direction.y(), sphere ? -1 : 0);
    }
}

TEST_F(Commands, OptionsOfAMethodAreInTheSummaryAndChangeTheLights) {
  const auto lights = [&](std::vector<std::string> extra) {
    std::vector<std::string> words = {"lights", path("sky.exr"), "--count",      "20",
                                      "--json", "--out",         path("l.json"), "--method"};
    words.insert(words.end(), extra.begin(), extra.end());
    const auto run = lightwell(words);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return std::pair{json::parse(run.out), read_text_file(path("l.json")).value()};
  };
  const auto [plain, plain_file] = lights({"havran"});
  EXPECT_EQ(plain["powers"], "own");
  EXPECT_EQ(plain["points"], "relaxed");
  EXPECT_EQ(plain["interpolation"], "power");
  const auto [other, other_file] =
      lights({"havran", "--powers", "cells", "--points", "halton", "--interpolation", "printed"});
  EXPECT_EQ(other["powers"], "cells");
  EXPECT_EQ(other["points"], "halton");
  EXPECT_EQ(other["interpolation"], "printed");
  EXPECT_NE(plain_file, other_file);
  const auto random = lights({"standard", "--points", "random", "--seed", "5"});
  EXPECT_EQ(random.first["points"], "random");
  EXPECT_FALSE(random.first.contains("interpolation"));
  EXPECT_EQ(lights({"standard", "--points", "random", "--seed", "5"}).second, random.second);
  EXPECT_NE(lights({"standard", "--points", "random", "--seed", "6"}).second, random.second);
  EXPECT_EQ(lights({"median-cut", "--powers", "equal"}).first["powers"], "equal");
}

TEST_F(Commands, BestIsTheDefaultAndBeatsTheOthers) {
  double error[2] = {};
  int i = 0;
  for (const std::vector<std::string>& extra : {std::vector<std::string>{}, {"--method", "median-cut"}}) {
    std::vector<std::string> words = {"lights", path("sky.exr"), "--count", "16", "--out", path("l.json")};
    words.insert(words.end(), extra.begin(), extra.end());
    ASSERT_EQ(lightwell(words).exit_code, 0);
    const auto run = lightwell({"evaluate", path("sky.exr"), path("l.json"), "--json"});
    ASSERT_EQ(run.exit_code, 0) << run.err;
    const json result = json::parse(run.out);
    EXPECT_GE(result["ms"], 0);
    EXPECT_GT(result["irradiance_rel_rmse"], 0);
    error[i++] = result["shadow_rel_rmse"];
  }
  EXPECT_LT(error[0], error[1]);
}

TEST_F(Commands, TurningTheImageTurnsItsLight) {
  ASSERT_EQ(
      lightwell({"lights", path("sky.exr"), "--count", "1", "--rotate-y", "-30", "--out", path("l.json")})
          .exit_code,
      0);
  const LightSet set = read_light_set(path("l.json")).value();
  const double azimuth =
      spherical_from_direction(set.lights[0].direction.cast<double>()).lambda_rad * 180 / kPi;
  // The sun's azimuth of 30° comes to 0; pixels are 7.5° wide and its edge is cut by them.
  EXPECT_NEAR(std::remainder(azimuth, 360), 0, 3.75);
  const auto turned = json::parse(
      lightwell({"evaluate", path("sky.exr"), path("l.json"), "--rotate-y", "-30", "--json"}).out);
  const auto straight = json::parse(lightwell({"evaluate", path("sky.exr"), path("l.json"), "--json"}).out);
  EXPECT_LT(turned["shadow_rel_rmse"].get<double>(), straight["shadow_rel_rmse"].get<double>());
}

TEST_F(Commands, TheSameCallGivesTheSameBytes) {
  for (const char* file : {"a.json", "b.json"})
    ASSERT_EQ(lightwell({"lights", path("sky.exr"), "--count", "33", "--out", path(file)}).exit_code, 0);
  EXPECT_EQ(read_text_file(path("a.json")).value(), read_text_file(path("b.json")).value());
}

TEST_F(Commands, ASequenceGivesALineAFrameInOrder) {
  for (int frame = 8; frame < 20; ++frame)
    ASSERT_TRUE(write_environment(
        path("env_00" + std::string(frame < 10 ? "0" : "") + std::to_string(frame) + ".exr"),
        sky(48, 24, 10.0 * (frame - 8))));
  const auto run = lightwell({"lights", path("env_%04d.exr"), "--count", "30", "--temporal", "none", "--out",
                              path("l.jsonl"), "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(json::parse(run.out)["frames"], 12);
  std::istringstream lines(read_text_file(path("l.jsonl")).value());
  std::string line;
  for (int frame = 0; frame < 12; ++frame) {
    ASSERT_TRUE(std::getline(lines, line));
    const LightSet one = take_lights(light_set_from_json(line, "line").value(), 1);
    const double azimuth =
        spherical_from_direction(one.lights[0].direction.cast<double>()).lambda_rad * 180 / kPi;
    EXPECT_NEAR(std::remainder(azimuth - 10.0 * frame, 360), 0, 6)
        << frame;  // pixels of 7.5°, and the sky's own share of the mean
  }
  EXPECT_FALSE(std::getline(lines, line));
}

TEST_F(Commands, TheFilterCarriesStateThroughASequence) {
  for (int frame = 1; frame <= 20; ++frame) {
    LatLongImage image = sky(48, 24);
    const float level = frame <= 5 ? 1.0f : 3.0f;
    for (Rgb& pixel : image.pixels) pixel *= level;
    ASSERT_TRUE(write_environment(path("e" + std::to_string(frame) + ".exr"), image));
  }
  const auto run = lightwell({"lights", path("e%d.exr"), "--count", "50", "--method", "havran", "--rate",
                              "25", "--out", path("l.jsonl"), "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(json::parse(run.out)["delay_frames"], 4.0);
  std::istringstream lines(read_text_file(path("l.jsonl")).value());
  std::vector<double> total;
  for (std::string line; std::getline(lines, line);)
    total.push_back(luminance(sum(light_set_from_json(line, "line").value())));
  ASSERT_EQ(total.size(), 20u);
  EXPECT_NEAR(total[4] / total[0], 1, 1e-4);   // constant light passes: float rounding of 50 lights
  EXPECT_NEAR(total[19] / total[0], 3, 3e-4);  // and so it does after the step
  EXPECT_LT(total[6], 2 * total[0]);           // two frames after the step it is delayed by four
}

TEST_F(Commands, TemporalChoicesDelayAsTheyState) {
  for (int frame = 1; frame <= 12; ++frame) {
    LatLongImage image = sky(24, 12);
    for (Rgb& pixel : image.pixels) pixel *= frame <= 5 ? 1.0f : 3.0f;
    ASSERT_TRUE(write_environment(path("e" + std::to_string(frame) + ".exr"), image));
  }
  const auto totals = [&](const std::string& temporal, double* delay) {
    const auto run = lightwell({"lights", path("e%d.exr"), "--count", "20", "--method", "standard",
                                "--temporal", temporal, "--out", path("l.jsonl"), "--json"});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    EXPECT_EQ(json::parse(run.out)["temporal"], temporal);
    *delay = json::parse(run.out)["delay_frames"];
    std::vector<double> list;
    const auto sets = read_light_sets(path("l.jsonl"));
    for (const LightSet& set : sets.value()) list.push_back(luminance(sum(set)));
    return list;
  };
  double delay = 0;
  const auto one = totals("one-frame", &delay);
  EXPECT_NEAR(delay, 1, 1e-9);                      // decimals written
  EXPECT_NEAR(one[5] / one[0], 1 + 2 * 0.4, 1e-4);  // float rounding of 20 lights
  EXPECT_NEAR(one[8] / one[0], 3, 1e-4);
  totals("minimum-phase", &delay);
  EXPECT_GT(delay, 0.5);
  EXPECT_LT(delay, 2.5);
  const auto none = totals("none", &delay);
  EXPECT_EQ(delay, 0);
  EXPECT_NEAR(none[5] / none[0], 3, 1e-4);
}

TEST_F(Commands, MainsFlickerIsTakenOutAndASwitchedLampIsNot) {
  constexpr int kFrames = 30;
  for (int frame = 0; frame < kFrames; ++frame) {
    LatLongImage image = sky(24, 12);
    const double flicker = 1 + 0.3 * std::cos(2 * kPi * 100 * frame / 60.0);
    const double lamp = frame < 20 ? 1 : 4;
    for (Rgb& pixel : image.pixels) pixel *= static_cast<float>(lamp * flicker);
    ASSERT_TRUE(write_environment(path("e" + std::to_string(frame) + ".exr"), image));
  }
  const auto totals = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words = {"lights",     path("e%d.exr"), "--count", "4",     "--method",
                                      "median-cut", "--rate",        "60",      "--out", path("l.jsonl")};
    words.insert(words.end(), more.begin(), more.end());
    const auto run = lightwell(words);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    std::vector<double> list;
    const auto sets = read_light_sets(path("l.jsonl"));
    for (const LightSet& set : sets.value()) list.push_back(luminance(sum(set)));
    return list;
  };
  const std::vector<double> as_it_is = totals({});
  const std::vector<double> steady = totals({"--mains", "50", "--exposure", "0"});
  const double level = (as_it_is[0] + as_it_is[1] + as_it_is[2]) / 3;  // 100 Hz at 60: three frames a period
  for (std::size_t frame = 8; frame < 20; ++frame)
    EXPECT_NEAR(steady[frame] / level, 1, 0.02) << frame;  // twenty decibels of .3 are .03
  // All lamps together become four times brighter: the swing that comes with that is known after six frames.
  for (std::size_t frame = 26; frame < kFrames; ++frame) EXPECT_NEAR(steady[frame] / level, 4, 0.1) << frame;
  EXPECT_GT(steady[20] / level, 3);
}

TEST_F(Commands, BlackImagesGiveLightsOfNoPower) {
  ASSERT_TRUE(write_environment(path("black.exr"), {7, 5, std::vector<Rgb>(35, Rgb::Zero())}));
  for (const Method method : kMethods) {
    const auto run = lightwell({"lights", path("black.exr"), "--count", "9", "--method",
                                std::string(name(method)), "--out", path("l.json")});
    ASSERT_EQ(run.exit_code, 0) << run.err;
    const auto evaluated = lightwell({"evaluate", path("black.exr"), path("l.json"), "--json"});
    ASSERT_EQ(evaluated.exit_code, 0);
    EXPECT_EQ(json::parse(evaluated.out)["shadow_rel_rmse"], 0);
  }
}

TEST_F(Commands, HelpHasAnExample) {
  for (const char* command : {"lights", "evaluate"}) {
    const auto run = lightwell({command, "--help"});
    EXPECT_EQ(run.exit_code, 0);
    EXPECT_THAT(run.out, HasSubstr("Example: lightwell " + std::string(command)));
  }
}

}  // namespace
}  // namespace lightwell
