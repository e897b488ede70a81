// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// Captured environments through the whole chain: lens, sensor with noise, wire, radiometer, lights.

#include <filesystem>

#include "interface/environment_io.h"
#include "interface/light_set_io.h"
#include "lighting/evaluation/evaluate.h"
#include "tests/integration/chain/chain.h"

namespace lightwell::test {
namespace {

struct RealMap {
  const char* name;
  const char* file;
};
void PrintTo(const RealMap& map, std::ostream* out) {
  *out << map.name;
}

class RealMaps : public Chain, public testing::WithParamInterface<RealMap> {};

TEST_P(RealMaps, GiveRightLight) {
  const std::filesystem::path file = std::filesystem::path(LIGHTWELL_TEST_DATA) / "env" / GetParam().file;
  if (!std::filesystem::exists(file)) GTEST_SKIP() << GetParam().file << " is not here";
  start_camera({"--environment", file.string(), "--size", "640x480", "--rate", "20"});
  start_daemon();
  ASSERT_TRUE(published_reaches(20)) << daemon_->stderr_text();

  const auto text = get("/api/v1/lights");
  auto lights = light_set_from_json(text.dump(), "lights");
  ASSERT_TRUE(lights) << lights.error().message;

  // 2 % with noise, as for every scene at rest.
  const Rgbd truth = rgb_of(last_truth().at("total_illuminance"));
  for (int c = 0; c < 3; ++c) {
    // A monochrome camera sees luminance alone.
    EXPECT_NEAR(lights->total_illuminance[c], luminance(truth), 0.02 * luminance(truth));
  }

  // Against every pixel of the image itself, upper half, as luminance. 64 lights err by .001 in
  // irradiance and .01 in shadow on such maps; the rest is the chain's: 320 × 240 pixels of a lens, noise and a response.
  // A lens, an axis or a unit that is wrong anywhere errs by far more than the bounds.
  auto image = read_environment(file);
  ASSERT_TRUE(image);
  for (Rgb& pixel : image->image.pixels) pixel = Rgb::Constant(luminance(pixel));
  const PolarMap map = polar_map_from_lat_long(image->image, true);
  const float scale = static_cast<float>(total_illuminance(map)[0]) / lights->total_illuminance[0];
  for (DirectionalLight& light : lights->lights) light.illuminance *= scale;
  const LightError error = LightEvaluator(map).error(*lights);
  EXPECT_LT(error.irradiance_rel_rmse, 0.06);
  EXPECT_LT(error.shadow_rel_rmse, 0.08);
  RecordProperty("irradiance_rel_rmse", std::to_string(error.irradiance_rel_rmse));
  RecordProperty("shadow_rel_rmse", std::to_string(error.shadow_rel_rmse));
}

INSTANTIATE_TEST_SUITE_P(Captured, RealMaps,
                         testing::Values(RealMap{"sun", "kloppenheim_05_1k.hdr"},
                                         RealMap{"windows", "lebombo_1k.hdr"},
                                         RealMap{"night", "moonless_golf_1k.hdr"},
                                         RealMap{"studio", "studio_small_03_1k.hdr"},
                                         RealMap{"overcast", "potsdamer_platz_1k.hdr"}),
                         [](const auto& p) { return p.param.name; });

}  // namespace
}  // namespace lightwell::test
