// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "interface/environment_io.h"
#include "interface/light_set_io.h"
#include "tests/integration/commands/command_fixture.h"
#include "tests/support/live_stage.h"

namespace lightwell::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

Vec3d vector_of(const json& value) {
  return {value[0].get<double>(), value[1].get<double>(), value[2].get<double>()};
}

// Two probes a metre apart under an uneven sky, two practical lamps and a far one as wide as the sun through haze.
class LuminaireLocateTest : public CommandTest {
 protected:
  static constexpr double kFar_m = 1e5;
  const std::vector<Vec3d> places_ = {{-0.5, 0, 0}, {0.5, 0, 0}};
  const std::vector<LampBall> lamps_ = {{{0.4, 2.8, 0.9}, 0.06, Rgbd(900, 800, 600)},
                                        {{-1.2, 1.9, -0.6}, 0.04, Rgbd(200, 250, 300)}};
  const Vec3d sun_ = Vec3d(1, 2, -1).normalized();

  void SetUp() override {
    StageLight light{
        [](const Vec3d&, const Vec3d& toward) { return Rgbd(Rgbd::Constant(5 + 2 * toward.y())); }, lamps_};
    light.lamps.push_back({kFar_m * sun_, kFar_m * 0.02, Rgbd::Constant(150 * kFar_m * kFar_m)});
    std::ofstream list(path("probes.csv"));
    list << "x,y,z,file\n";
    for (std::size_t n = 0; n < places_.size(); ++n) {
      const std::string file = "probe_" + std::to_string(n) + ".exr";
      ASSERT_TRUE(write_environment(path(file), lat_long_from_polar_map(map_at(light, places_[n]))));
      list << places_[n].x() << "," << places_[n].y() << "," << places_[n].z() << "," << file << "\n";
    }
  }
  [[nodiscard]] json locate(const std::string& list, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments = {"luminaire", "locate", path(list), "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const auto done = lightwell(arguments);
    EXPECT_EQ(done.exit_code, 0) << done.err;
    return json::parse(done.out, nullptr, false);
  }
  void expect_found(const json& found, double intensity_error) const {
    ASSERT_EQ(found["lamps"].size(), 2u) << found;
    for (std::size_t i = 0; i < 2; ++i) {
      const json& lamp = found["lamps"][i];
      const Vec3d error = vector_of(lamp["position"]) - lamps_[i].position;
      EXPECT_LT(error.norm(), 0.03 * lamps_[i].position.norm()) << "3 % of the distance";
      EXPECT_LT(error.norm(), 3 * lamp["sigma_m"].get<double>());
      EXPECT_NEAR(lamp["intensity"][1].get<double>() / lamps_[i].intensity[1], 1, intensity_error);
      EXPECT_EQ(lamp["seen_by"], json({0, 1}));
    }
    ASSERT_EQ(found["directional"].size(), 1u);
    const json& far = found["directional"][0];
    EXPECT_LT((vector_of(far["direction"]) - sun_).norm(), 0.01);
    EXPECT_GT(far["distance_m"]["near"].get<double>(), 20);
    EXPECT_TRUE(far["distance_m"]["far"].is_null());
    EXPECT_NEAR(far["illuminance"][1].get<double>(), 150, 150 * intensity_error);
  }
};

TEST_F(LuminaireLocateTest, PicturesTellWhereLampsStandAndTheirFilesLightAsTheyDo) {
  const json found = locate(
      "probes.csv", {"--out", path("lamps.json"), "--lamps", path("lamp_%d.exr"), "--rest", path("rest")});
  expect_found(found, 0.06);
  EXPECT_EQ(json::parse(std::ifstream(path("lamps.json"))), found);
  // What the file of the first sends to the first probe, in the lamp's frame, is what that probe saw of it.
  const json& lamp = found["lamps"][0];
  const auto& q = lamp["world_from_lamp"];
  const Eigen::Quaterniond turn(q[3].get<double>(), q[0].get<double>(), q[1].get<double>(),
                                q[2].get<double>());
  const Vec3d toward = lamps_[0].position - places_[0];
  const Vec3d at = turn.inverse() * (places_[0] - vector_of(lamp["position"]));
  const Vec3d normal = turn.inverse() * toward.normalized();
  const auto text = [](const Vec3d& v) {
    return std::to_string(v.x()) + "," + std::to_string(v.y()) + "," + std::to_string(v.z());
  };
  const auto asked = lightwell(
      {"luminaire", "query", path("lamp_1.exr"), "--at", text(at), "--toward", text(normal), "--json"});
  ASSERT_EQ(asked.exit_code, 0) << asked.err;
  const Vec3d lux = vector_of(json::parse(asked.out)["illuminance"][0]);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(lux[c] * toward.squaredNorm() / lamps_[0].intensity[c], 1, 0.06);
  // The rest has the sky and the sun, without the lamps.
  const auto rest = read_environment(path("rest/rest_0.exr"));
  ASSERT_TRUE(rest) << rest.error().message;
  const auto total = [](const LatLongImage& image) {
    return total_illuminance(polar_map_from_lat_long(image, false))[1];
  };
  double lamps = 0;
  for (const LampBall& ball : lamps_) lamps += ball.intensity[1] / (ball.position - places_[0]).squaredNorm();
  const double before = total(read_environment(path("probe_0.exr"))->image), after = total(rest->image);
  EXPECT_NEAR((before - after) / lamps, 1, 0.05);
}

TEST_F(LuminaireLocateTest, LightSetsOfTheSamplerTellItToo) {
  std::ofstream list(path("sets.csv"));
  list << "x,y,z,file\n";
  for (std::size_t n = 0; n < places_.size(); ++n) {
    const std::string name = "lights_" + std::to_string(n) + ".json";
    ASSERT_EQ(lightwell({"lights", path("probe_" + std::to_string(n) + ".exr"), "--count", "64", "--method",
                         "best", "--out", path(name)})
                  .exit_code,
              0);
    list << places_[n].x() << ",0,0," << name << "\n";
  }
  list.close();
  expect_found(locate("sets.csv", {"--rest", path("rest")}), 0.15);
  const auto whole = read_light_set(path("lights_1.json")), rest = read_light_set(path("rest/rest_1.json"));
  ASSERT_TRUE(whole && rest);
  EXPECT_LT(rest->lights.size(), whole->lights.size());
  EXPECT_LT(rest->total_illuminance[1], whole->total_illuminance[1] - 50);
}

TEST_F(LuminaireLocateTest, WithoutEvidenceThereIsADirectionOnly) {
  std::ofstream(path("same.csv")) << "x,y,z,file\n1,0,0,probe_0.exr\n1,0,0,probe_0.exr\n";
  const auto same = lightwell({"luminaire", "locate", path("same.csv"), "--json"});
  EXPECT_THAT(same.err, HasSubstr("all probes (2) stand in one place"));
  EXPECT_EQ(json::parse(same.out)["lamps"].size(), 0u);
  EXPECT_EQ(json::parse(same.out)["directional"].size(), 3u);
  std::ofstream(path("one.csv")) << "x,y,z,file\n0,0,0,probe_0.exr\n";
  EXPECT_EQ(locate("one.csv")["directional"].size(), 3u);
  // A millimetre of base: nothing is near.
  std::ofstream(path("close.csv")) << "x,y,z,file\n0,0,0,probe_0.exr\n0.001,0,0,probe_0.exr\n";
  const json close = locate("close.csv");
  EXPECT_EQ(close["lamps"].size(), 0u);
  EXPECT_EQ(close["directional"].size(), 3u);
  // No lamp anywhere.
  ASSERT_TRUE(write_environment(path("even.exr"), {8, 4, std::vector<Rgb>(32, Rgb::Ones())}));
  ASSERT_TRUE(write_environment(path("black.exr"), {8, 4, std::vector<Rgb>(32, Rgb::Zero())}));
  std::ofstream(path("dull.csv")) << "x,y,z,file\n0,0,0,even.exr\n1,0,0,black.exr\n";
  const json dull = locate("dull.csv", {"--rest", path("rest")});
  EXPECT_TRUE(dull["lamps"].empty() && dull["directional"].empty());
  EXPECT_EQ(read_environment(path("rest/rest_0.exr"))->image.pixels[5][0], 1);
}

TEST_F(LuminaireLocateTest, BadInputIsOneLine) {
  const auto refused = [&](const std::vector<std::string>& arguments, int code, const std::string& words) {
    std::vector<std::string> all = {"luminaire", "locate"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    const auto result = lightwell(all);
    EXPECT_EQ(result.exit_code, code) << result.err;
    EXPECT_THAT(result.err, HasSubstr(words));
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  };
  refused({path("none.csv")}, 3, "none.csv");
  std::ofstream(path("bad.csv")) << "x,y,z,file\n0,0,0,none.exr\n";
  refused({path("bad.csv")}, 3, "none.exr");
  refused({path("probes.csv"), "--out", path("probe_1.exr")}, 2, "probe_1.exr");
  refused({path("probes.csv"), "--lamps", path("lamp.exr")}, 2, "allowed: a name with a number");
  // Lamp 1 would replace the second probe's picture; and two outputs one another. Nothing is written.
  const auto before = std::filesystem::last_write_time(path("probe_1.exr"));
  refused({path("probes.csv"), "--lamps", path("probe_%d.exr")}, 2, "probe_1.exr");
  refused({path("probes.csv"), "--lamps", path("l_%d.exr"), "--out", path("l_2.exr")}, 2,
          "l_2.exr is written twice");
  refused({path("probes.csv"), "--lamps", path("none/l_%d.exr"), "--out", path("lamps.json")}, 1, "none");
  EXPECT_EQ(std::filesystem::last_write_time(path("probe_1.exr")), before);
  EXPECT_FALSE(std::filesystem::exists(path("l_1.exr")) || std::filesystem::exists(path("lamps.json")));
  refused({path("probes.csv"), "--sigma", "0"}, 2, "above 0 to 10 degrees");
  EXPECT_FALSE(std::filesystem::exists(path("lamp.exr")));
}

}  // namespace
}  // namespace lightwell::test
