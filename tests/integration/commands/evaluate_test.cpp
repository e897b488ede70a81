// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "interface/atomic_file.h"
#include "interface/light_set_io.h"
#include "lighting/decomposition/decompose.h"
#include "lighting/evaluation/coherence.h"
#include "lighting/lat_long_image.h"
#include "tests/integration/commands/command_fixture.h"

namespace lightwell {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class Evaluate : public test::CommandTest {
 protected:
  // A sun that moves 5° a frame, its lights, and what the library says of them.
  void write_sequence(int frames) {
    std::string lines;
    for (int frame = 0; frame < frames; ++frame) {
      const LatLongImage image = sky(48, 24, 5.0 * frame);
      ASSERT_TRUE(write_environment(path("e" + std::to_string(frame) + ".exr"), image));
      maps_.push_back(polar_map_from_lat_long(image, true));
      sets_.push_back(decompose(maps_.back(), Method::median_cut, 24).value());
      lines += light_set_to_json(sets_.back(), true);
    }
    ASSERT_TRUE(write_file_atomically(path("l.jsonl"), lines));
  }
  Coherence expected(Occluder occluder, std::optional<std::size_t> prefix = {}) {
    const EvaluationGeometry geometry(maps_.front().grid, occluder);
    CoherenceMeter meter(occluder, prefix);
    for (std::size_t i = 0; i < maps_.size(); ++i) meter.add(reference_frame(geometry, maps_[i]), sets_[i]);
    return meter.result();
  }
  std::string jsonl() { return path("l.jsonl"); }

  std::vector<PolarMap> maps_;
  std::vector<LightSet> sets_;
};

TEST_F(Evaluate, ASequenceGivesWhatTheLibraryMeasures) {
  write_sequence(30);
  const auto run = lightwell({"evaluate", path("e%d.exr"), jsonl(), "--json", "--occluder", "all", "--prefix",
                              "8", "--prefix", "16"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json result = json::parse(run.out);
  const Coherence whole = expected(Occluder::sphere);
  EXPECT_EQ(result["frames"], 30);
  EXPECT_EQ(result["shadow_rel_rmse"].get<double>(), whole.shadow.error);
  EXPECT_EQ(result["shadow"]["excess"].get<double>(), whole.shadow.excess);
  EXPECT_EQ(result["irradiance"]["change_error"].get<double>(), whole.irradiance.change_error);
  EXPECT_EQ(result["direction_lag_frames"].get<double>(), whole.direction_lag_frames);
  EXPECT_NEAR(result["direction_lag_frames"].get<double>(), 0, 0.5);
  for (const Occluder occluder : kOccluders)
    EXPECT_EQ(result["occluders"][std::string(name(occluder))]["error"].get<double>(),
              expected(occluder).shadow.error);
  EXPECT_EQ(result["prefixes"][1]["shadow"]["error"].get<double>(),
            expected(Occluder::sphere, 16).shadow.error);
  EXPECT_THAT(lightwell({"evaluate", path("e%d.exr"), jsonl()}).out, HasSubstr("excess"));
}

TEST_F(Evaluate, OccludersOfOneImageStandBesideTheSphere) {
  ASSERT_EQ(lightwell({"lights", path("sky.exr"), "--count", "24", "--out", path("l.json")}).exit_code, 0);
  const auto plain = json::parse(lightwell({"evaluate", path("sky.exr"), path("l.json"), "--json"}).out);
  EXPECT_FALSE(plain.contains("occluders"));
  const auto run = lightwell({"evaluate", path("sky.exr"), path("l.json"), "--json", "--occluder", "box",
                              "--occluder", "pole", "--prefix", "6"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json result = json::parse(run.out);
  EXPECT_EQ(result["shadow_rel_rmse"], plain["shadow_rel_rmse"]);
  EXPECT_EQ(result["occluders"].size(), 2u);
  const LightSet set = read_light_set(path("l.json")).value();
  const PolarMap map = polar_map_from_lat_long(sky(48, 24), true);
  EXPECT_NEAR(result["occluders"]["box"]["shadow_rel_rmse"].get<double>(),
              LightEvaluator(map, Occluder::box).error(set).shadow_rel_rmse, 1e-12);  // decimals written
  EXPECT_GT(result["prefixes"][0]["shadow_rel_rmse"].get<double>(), result["shadow_rel_rmse"].get<double>());
}

TEST_F(Evaluate, SequencesThatDoNotFitAreNamed) {
  write_sequence(3);
  const auto refused = [&](int code, const std::string& names, const std::vector<std::string>& more = {}) {
    std::vector<std::string> words = {"evaluate", path("e%d.exr"), jsonl()};
    words.insert(words.end(), more.begin(), more.end());
    const auto run = lightwell(words);
    EXPECT_EQ(run.exit_code, code) << run.err;
    EXPECT_THAT(run.err, HasSubstr(names));
    EXPECT_EQ(run.out, "");
  };
  refused(2, "allowed: sphere, box, pole, canopy, all", {"--occluder", "cone"});
  refused(2, "--prefix", {"--prefix", "0"});
  std::string two = light_set_to_json(sets_[0], true) + light_set_to_json(sets_[1], true);
  ASSERT_TRUE(write_file_atomically(jsonl(), two));
  refused(3, "2 light sets, the sequence 3 frames");
  ASSERT_TRUE(write_file_atomically(jsonl(), two + "{\n"));
  refused(3, "l.jsonl, line 3");
  LightSet sphere = sets_[2];
  sphere.coverage = Coverage::sphere;
  ASSERT_TRUE(write_file_atomically(jsonl(), two + light_set_to_json(sphere, true)));
  refused(3, "coverage");
  ASSERT_TRUE(write_file_atomically(jsonl(), "\n"));
  refused(3, "no light set");
  ASSERT_TRUE(write_file_atomically(jsonl(), two + light_set_to_json(sets_[2], true)));
  ASSERT_TRUE(write_environment(path("e2.exr"), sky(24, 12)));
  refused(3, "another size");
}

}  // namespace
}  // namespace lightwell
