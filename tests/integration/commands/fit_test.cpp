// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "interface/atomic_file.h"
#include "interface/light_set_io.h"
#include "lighting/fit/few_lights.h"
#include "lighting/fit/light_search.h"
#include "lighting/lat_long_image.h"
#include "tests/integration/commands/command_fixture.h"

namespace lightwell {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class FitCommand : public test::CommandTest {
 protected:
  [[nodiscard]] json file(const std::string& name) const {
    return json::parse(read_text_file(path(name)).value());
  }
  // Black but for pixels of radiance 1000.
  void write_pixels(const std::string& name, const std::vector<std::pair<int, int>>& pixels,
                    const Rgb& background) const {
    LatLongImage image{72, 36, std::vector<Rgb>(72 * 36, background)};
    for (const auto& [x, y] : pixels) image.at(x, y) = Rgb(1000, 900, 800);
    ASSERT_TRUE(write_environment(path(name), image));
  }
};

// The probe under a light set against the probe under every pixel, by sums over all of them.
double residual_by_hand(const LatLongImage& image, const LightSet& set) {
  const ProbeNormals normals = probe_normals();
  double difference = 0, norm = 0;
  for (int i = 0; i < kProbeNormals; ++i) {
    Rgbd map = Rgbd::Zero();
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x)
        map += image.at(x, y).cast<double>() * image.pixel_solid_angle_sr(y) *
               std::max(0.0, normals.col(i).dot(
                                 direction_from_lat_long((x + 0.5) / image.width, (y + 0.5) / image.height)));
    Rgbd model = set.ambient.cast<double>() * kPi;
    for (const DirectionalLight& light : set.lights)
      model += light.illuminance.cast<double>() *
               std::max(0.0, normals.col(i).dot(light.direction.cast<double>()));
    difference += (map - model).square().sum();
    norm += map.square().sum();
  }
  return std::sqrt(difference / norm);
}

TEST_F(FitCommand, WritesALightSetOfTheWholeSphereWithItsResidual) {
  const auto run = lightwell({"fit", path("sky.exr"), "--lights", "2", "--json", "--out", path("fit.json")});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json fit = file("fit.json");
  EXPECT_EQ(fit["schema"], "lightwell.lights/1");
  EXPECT_EQ(fit["method"], "fit");
  EXPECT_EQ(fit["coverage"], "sphere");
  const LightSet set = read_light_set(path("fit.json")).value();
  ASSERT_EQ(set.lights.size(), 2u);
  // Single-precision lights against double.
  EXPECT_NEAR(fit["residual"].get<double>(), residual_by_hand(sky(48, 24), set), 1e-6);
  EXPECT_LT(fit["residual"].get<double>(), 0.1);
  // Ambient and lights give the probe's mean where the ambient term is not held at 0: all there is, to what the
  // lights' own mean over 320 faces is off.
  ASSERT_GT(set.ambient.minCoeff(), 0);
  Rgbd all = set.ambient.cast<double>() * 4 * kPi;
  for (const DirectionalLight& light : set.lights) all += light.illuminance.cast<double>();
  EXPECT_LT((all / set.total_illuminance.cast<double>() - 1).abs().maxCoeff(), 2e-3);
  EXPECT_EQ(fit["confidence"]["lights"].size(), 2u);
  EXPECT_GT(fit["confidence"]["lights"][0]["direction_sigma_deg"], 0);
  const json out = json::parse(run.out);
  EXPECT_EQ(out["residual"], fit["residual"]);
  EXPECT_EQ(out["count"], 2);
  // The sun, 8° wide and 40° high, dominates.
  const Vec3d sun = direction_from_spherical({50 * kPi / 180, 30 * kPi / 180});
  EXPECT_GT(set.lights[0].direction.cast<double>().dot(sun), std::cos(10 * kPi / 180));
  const auto evaluated = lightwell({"evaluate", path("sky.exr"), path("fit.json"), "--json"});
  ASSERT_EQ(evaluated.exit_code, 0) << evaluated.err;
  EXPECT_NEAR(json::parse(evaluated.out)["irradiance_rel_rmse"].get<double>(), fit["residual"].get<double>(),
              0.2 * fit["residual"].get<double>());  // other normals of the same sphere
}

TEST_F(FitCommand, ABoundGivesTheFewestLights) {
  int before = 0;
  for (const char* bound : {"0.3", "0.05", "0.01"}) {
    const auto run =
        lightwell({"fit", path("sky.exr"), "--max-error", bound, "--json", "--out", path("f.json")});
    ASSERT_EQ(run.exit_code, 0) << run.err;
    const json fit = file("f.json");
    EXPECT_LE(fit["residual"].get<double>(), std::stod(bound));
    const auto count = static_cast<int>(fit["lights"].size());
    EXPECT_GE(count, before);
    before = count;
    EXPECT_GT(fit["confidence"]["residual_of_fewer"].get<double>(), std::stod(bound));
    EXPECT_GE(fit["confidence"]["fewest"].get<double>(), 0);
    // One fewer does not do it.
    if (count < 2) continue;
    const auto fewer = lightwell({"fit", path("sky.exr"), "--lights", std::to_string(count - 1), "--json"});
    EXPECT_GT(json::parse(fewer.out)["residual"].get<double>(), std::stod(bound));
  }
  EXPECT_GE(before, 2);
}

TEST_F(FitCommand, TwinsAreMergedAndAnEvenSkyHasNoDirection) {
  write_pixels("twins.exr", {{20, 12}, {20, 13}}, Rgb::Constant(0.01f));
  auto run = lightwell({"fit", path("twins.exr"), "--lights", "2", "--json", "--out", path("f.json")});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  // 5° apart: told apart or merged, but never without a word.
  const json twins = json::parse(run.out);
  EXPECT_TRUE(twins["lights"].size() == 2 || !twins["remarks"].empty());
  write_pixels("even.exr", {}, Rgb(1, 2, 3));
  run = lightwell({"fit", path("even.exr"), "--lights", "4", "--json", "--out", path("f.json")});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("no direction"));
  const json even = file("f.json");
  EXPECT_EQ(even["lights"].size(), 0u);
  EXPECT_NEAR(even["ambient"][2].get<double>(), 3, 0.01);  // pixels of 5° as points
  EXPECT_THAT(even["remarks"][0].get<std::string>(), HasSubstr("no direction"));
}

TEST_F(FitCommand, BlackImagesGiveNoLights) {
  write_pixels("black.exr", {}, Rgb::Zero());
  const auto run = lightwell({"fit", path("black.exr"), "--lights", "3", "--json", "--out", path("f.json")});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("black"));
  EXPECT_EQ(file("f.json")["lights"].size(), 0u);
  EXPECT_EQ(file("f.json")["residual"], 0);
}

TEST_F(FitCommand, TurningTheImageTurnsTheLights) {
  const auto azimuth = [&](const char* turn) {
    const auto run = lightwell({"fit", path("sky.exr"), "--lights", "1", "--rotate-y", turn, "--json"});
    const json light = json::parse(run.out)["lights"][0]["direction"];
    return spherical_from_direction(
               Vec3d(light[0].get<double>(), light[1].get<double>(), light[2].get<double>()))
               .lambda_rad *
           180 / kPi;
  };
  // Whole columns of 7.5°; the probe's own faces do not turn with them.
  EXPECT_NEAR(std::remainder(azimuth("60") - azimuth("0") - 60, 360), 0, 0.5);
}

TEST_F(FitCommand, WrongUseIsNamedAndNothingIsWritten) {
  struct Wrong {
    std::vector<std::string> words;
    int exit_code;
    std::string named;
  };
  const std::string sky = path("sky.exr");
  for (const Wrong& wrong : std::vector<Wrong>{
           {{sky}, 2, "--lights or --max-error"},
           {{sky, "--lights", "3", "--max-error", "0.1"}, 2, "one of them"},
           {{sky, "--lights", "0"}, 2, "1 to 16"},
           {{sky, "--lights", "17"}, 2, "1 to 16"},
           {{sky, "--lights", "many"}, 2, "many"},
           {{sky, "--max-error", "0"}, 2, "above 0 to 1"},
           {{sky, "--max-error", "nan"}, 2, "above 0 to 1"},
           {{sky, "--max-error", "0.1", "--with-shadow"}, 2, "--with-shadow"},
           {{sky, "--max-error", "1e-9"}, 1, "not reached"},
           {{path("none.exr"), "--lights", "2"}, 3, "none.exr"},
           {{std::filesystem::path(sky).parent_path().string(), "--lights", "2"}, 3, "irectory"}}) {
    std::vector<std::string> words = {"fit"};
    words.insert(words.end(), wrong.words.begin(), wrong.words.end());
    words.insert(words.end(), {"--out", path("f.json")});
    const auto run = lightwell(words);
    EXPECT_EQ(run.exit_code, wrong.exit_code) << run.err;
    EXPECT_THAT(run.err, HasSubstr(wrong.named));
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
    EXPECT_FALSE(std::filesystem::exists(path("f.json")));
  }
  const auto own = lightwell({"fit", sky, "--lights", "2", "--out", sky});
  EXPECT_EQ(own.exit_code, 2);
  const auto lost = lightwell({"fit", sky, "--lights", "2", "--out", path("nowhere/f.json")});
  EXPECT_EQ(lost.exit_code, 1);
}

// Photographs of real places: sun, windows, night, studio, overcast.
TEST(FitOfRealMaps, FourLightsAreWithinTwoPercentOfTheBestOfTwoHundredRandomStartsAndNeverNegative) {
  const std::filesystem::path folder = std::filesystem::path(LIGHTWELL_TEST_DATA) / "env";
  for (const char* name : {"kloppenheim_05_1k.hdr", "lebombo_1k.hdr", "moonless_golf_1k.hdr",
                           "studio_small_05_1k.hdr", "vestibule_1k.hdr", "venice_sunset_1k.hdr"}) {
    if (!std::filesystem::exists(folder / name)) GTEST_SKIP() << "no real map " << folder / name;
    const auto environment = read_environment(folder / name);
    ASSERT_TRUE(environment);
    const PolarMap map = resample_polar(polar_map_from_lat_long(environment->image, false), {180, 360, kPi});
    LambertianProbe probe(map.grid);
    ProbeIrradiance irradiance;
    probe.irradiance(map, irradiance);
    FaceObservations faces(false);
    faces.set_probe(irradiance);
    LightSearch search(faces, 1e-6);
    double best = 1;
    std::uint64_t state = 4;
    for (int start = 0; start < 200; ++start) {
      LightsTrial trial = random_directions(4, state);
      search.refine(trial, 60);
      best = std::min(best, std::sqrt(trial.cost));
    }
    const FewLightsFit fit = fit_few_lights(map, {.lights = 4}).value();
    EXPECT_LT(fit.residual, 1.02 * best) << name;
    EXPECT_GE(fit.ambient.minCoeff(), 0);
    for (int k = 0; k < fit.count; ++k)
      EXPECT_GE(fit.lights[static_cast<std::size_t>(k)].illuminance.minCoeff(), 0);
  }
}

}  // namespace
}  // namespace lightwell
