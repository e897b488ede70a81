// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// Shadow maps against exact visibility of the same triangles under the same lights at the same pixel centres: what differs is
// the maps'.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <optional>

#include "bench/pictures/ray_tracer.h"
#include "render/egl_context.h"
#include "render/gltf_scene.h"
#include "render/renderer.h"
#include "tests/support/test_scene.h"

namespace lightwell {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)

// A sky of equal lights over the hemisphere and a sun.
LightSet sky_and_sun(int count, float sun) {
  std::vector<std::pair<Vec3f, Rgb>> lights = {{Vec3f(0.6f, 0.7f, 0.4f), Rgb::Constant(sun)}};
  for (int i = 1; i < count; ++i) {
    const double y = (i - 0.5) / (count - 1);
    const double azimuth = i * kPi * (3 - std::sqrt(5.0));
    const double r = std::sqrt(1 - y * y);
    lights.emplace_back(Vec3d(r * std::cos(azimuth), y, r * std::sin(azimuth)).cast<float>(),
                        Rgb(0.8f, 1, 1.3f) * (100 / static_cast<float>(count)));
  }
  return light_set(lights);
}

class ShadowMapAccuracy : public ::testing::Test {
 protected:
  void SetUp() override {
    auto context = render::EglContext::create();
    if (!context) GTEST_SKIP() << context.error().message;
    context_.emplace(std::move(context).value());
    auto scene = render::read_gltf(LIGHTWELL_STAGE);
    ASSERT_TRUE(scene.ok()) << scene.error().message;
    scene_ = std::move(scene).value();
    for (Material& m : scene_.materials) m.specular = Rgb::Zero();
  }

  static constexpr int kWidth = 160;
  static constexpr int kHeight = 120;

  render::RadiancePicture picture(const LightSet& lights, int shadow_size, bool simplify_casters = true) {
    render::RendererOptions options;
    options.width = kWidth;
    options.height = kHeight;
    options.shadow_size = shadow_size;
    options.simplify_casters = simplify_casters;
    options.interleave = 1;  // the maps alone: what sharing adds, interleaving_test bounds
    auto renderer = render::Renderer::create(scene_, options);
    EXPECT_TRUE(renderer.ok());
    EXPECT_TRUE(renderer->render(lights, scene_.cameras[0]));
    return renderer->radiance();
  }

  // ‖picture − exact‖ / ‖exact‖ over all pixels and channels.
  double relative_rmse(const LightSet& lights, int shadow_size) {
    const auto rendered = picture(lights, shadow_size);
    const auto tracer = pictures::RayTracer::create(scene_);
    EXPECT_TRUE(tracer.ok());
    if (!tracer) return 1;
    const auto exact = tracer->picture(scene_.cameras[0], kWidth, kHeight, lights.lights);
    double difference = 0;
    double total = 0;
    for (std::size_t i = 0; i < exact.rgba.size(); ++i) {
      if (i % 4 == 3) continue;
      difference += std::pow(static_cast<double>(rendered.rgba[i] - exact.rgba[i]), 2);
      total += std::pow(static_cast<double>(exact.rgba[i]), 2);
    }
    const double error = std::sqrt(difference / total);
    std::printf("relative RMSE against exact visibility: %.4f (%zu lights, maps of %d)\n", error,
                lights.lights.size(), shadow_size);
    return error;
  }

  std::optional<render::EglContext> context_;
  Scene scene_;
};

TEST_F(ShadowMapAccuracy, UnderASkyTheMapsCostLittle) {
  EXPECT_LT(relative_rmse(sky_and_sun(72, 0), 256), 0.015);
}

TEST_F(ShadowMapAccuracy, UnderASunLargerMapsAreMoreExact) {
  const LightSet lights = sky_and_sun(72, 200);
  const double coarse = relative_rmse(lights, 256);
  const double fine = relative_rmse(lights, 1024);
  EXPECT_LT(coarse, 0.04);
  EXPECT_LT(fine, coarse / 1.5);
}

TEST_F(ShadowMapAccuracy, SimplifiedCastersAddLessThanTheMapsThemselves) {
  const LightSet lights = sky_and_sun(72, 200);
  const auto full = picture(lights, 256, false).rgba;
  const auto fewer = picture(lights, 256, true).rgba;
  double difference = 0;
  double total = 0;
  for (std::size_t i = 0; i < full.size(); ++i) {
    difference += std::pow(static_cast<double>(fewer[i] - full[i]), 2);
    total += std::pow(static_cast<double>(full[i]), 2);
  }
  const double error = std::sqrt(difference / total);
  std::printf("relative RMSE of simplified casters against full ones: %.4f\n", error);
  // A quarter of the 0.04 that maps of 256² may err under this sun: in squares, a sixteenth.
  EXPECT_LT(error, 0.01);
}

}  // namespace
}  // namespace lightwell
