// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <optional>

#include "render/egl_context.h"
#include "render/renderer.h"
#include "tests/support/test_scene.h"

namespace lightwell::test {

// An OpenGL ES context for each test; skips, and says so, where the machine has no EGL.
class Rendering : public ::testing::Test {
 protected:
  void SetUp() override {
    auto context = render::EglContext::create();
    if (!context) GTEST_SKIP() << context.error().message;
    context_.emplace(std::move(context).value());
  }

  static render::RadiancePicture picture(const Scene& scene, const LightSet& lights,
                                         const SceneCamera& camera, int width = 32, int height = 24,
                                         int samples = 1, int shadow_size = 256,
                                         bool simplify_casters = true) {
    render::RendererOptions options;
    options.width = width;
    options.height = height;
    options.samples = samples;
    options.shadow_size = shadow_size;
    options.simplify_casters = simplify_casters;
    auto renderer = render::Renderer::create(scene, options);
    EXPECT_TRUE(renderer.ok()) << renderer.error().message;
    const Status status = renderer->render(lights, camera);
    EXPECT_TRUE(status.ok()) << status.error().message;
    return renderer->radiance();
  }

  static Rgb rgb(const render::RadiancePicture& p, int x, int y) {
    const float* pixel = &p.rgba[4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(p.width) +
                                      static_cast<std::size_t>(x))];
    return {pixel[0], pixel[1], pixel[2]};
  }
  static float alpha(const render::RadiancePicture& p, int x, int y) {
    return p.rgba[4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(p.width) +
                       static_cast<std::size_t>(x)) +
                  3];
  }

 private:
  std::optional<render::EglContext> context_;
};

// All three channels within a relative distance.
inline void expect_near(const Rgb& actual, const Rgb& expected, float relative,
                        const std::string& where = "") {
  EXPECT_LE((actual - expected).abs().maxCoeff(), relative * expected.abs().maxCoeff())
      << where << " is " << actual.transpose() << ", expected " << expected.transpose();
}

}  // namespace lightwell::test
