// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/picture.h"

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"
#include "tests/unit/render/render_fixture.h"

namespace lightwell {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)
using Pictures = Rendering;

template <class T>
std::vector<T> read_pixels(const std::filesystem::path& file, int& width, int& height) {
  const auto input = OIIO::ImageInput::open(file.string());
  if (!input) return {};
  width = input->spec().width;
  height = input->spec().height;
  std::vector<T> pixels(static_cast<std::size_t>(width * height * input->spec().nchannels));
  input->read_image(0, 0, 0, input->spec().nchannels, OIIO::BaseTypeFromC<T>::value, pixels.data());
  return pixels;
}

TEST_F(Pictures, RowsGoFromTopToBottomInExrAndPng) {
  // Below the horizon the ground, above it nothing.
  Scene scene;
  add_ground(scene, lambertian(Rgb(1, 0.5f, 0.25f)), false, 50);
  render::RendererOptions options;
  options.width = 7;
  options.height = 5;
  auto renderer = render::Renderer::create(scene, options);
  ASSERT_TRUE(renderer.ok());
  ASSERT_TRUE(renderer->render(light_set({{Vec3f::UnitY(), Rgb::Constant(static_cast<float>(kPi))}}),
                               camera_at({0, 1, 5}, {0, 1, 0})));
  renderer->tone_map(render::ToneMap::none, 0);
  const TemporaryFolder folder;
  ASSERT_TRUE(write_exr(folder.path() / "a.exr", renderer->radiance()));
  ASSERT_TRUE(write_png(folder.path() / "a.png", renderer->display()));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 2);
  int width = 0;
  int height = 0;
  const auto radiance = read_pixels<float>(folder.path() / "a.exr", width, height);
  ASSERT_EQ(std::pair(width, height), std::pair(7, 5));
  const auto at = [&](int x, int y, int c) { return static_cast<std::size_t>((y * 7 + x) * 4 + c); };
  EXPECT_EQ(radiance[at(3, 0, 3)], 0);  // sky: alpha 0, radiance 0
  EXPECT_EQ(radiance[at(3, 0, 0)], 0);
  EXPECT_EQ(radiance[at(3, 4, 3)], 1);
  EXPECT_NEAR(radiance[at(3, 4, 0)], 1, 5e-4f);
  EXPECT_NEAR(radiance[at(3, 4, 2)], 0.25f, 5e-4f);
  const auto display = read_pixels<std::uint8_t>(folder.path() / "a.png", width, height);
  EXPECT_EQ(display[at(3, 0, 3)], 0);
  EXPECT_EQ(display[at(3, 4, 3)], 255);
  EXPECT_EQ(display[at(3, 4, 0)], 255);
  // IEC 61966-2-1: 0.5 → 188 and 0.25 → 137.
  EXPECT_NEAR(display[at(3, 4, 1)], 188, 1);
  EXPECT_NEAR(display[at(3, 4, 2)], 137, 1);
}

TEST(PictureFiles, MissingFolderIsAFailureThatNamesTheFile) {
  const render::RadiancePicture picture{1, 1, {1, 2, 3, 1}};
  const Status status = render::write_exr("/nonexistent/a.exr", picture);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().kind, ErrorKind::failed);
  EXPECT_NE(status.error().message.find("/nonexistent/a.exr"), std::string::npos);
}

// A picture of one radiance: log average and white point are both its luminance.
class ToneMapping : public Rendering {
 protected:
  static Scene ground() {
    Scene scene;
    add_ground(scene, lambertian(Rgb::Ones()));
    return scene;
  }
  static LightSet uniform_light(float radiance) {
    return light_set({{Vec3f::UnitY(), Rgb::Constant(radiance * static_cast<float>(kPi))}});
  }
};

TEST_F(ToneMapping, ReinhardShowsAUniformPictureAsWhiteAtAnyExposure) {
  // eq. 4 with L = key and white = key: key (1 + 1/key) / (1 + key) = 1.
  const Scene scene = ground();
  for (const float radiance : {1e-4f, 1.0f, 1e6f}) {
    auto renderer = render::Renderer::create(scene, {});
    ASSERT_TRUE(renderer.ok());
    ASSERT_TRUE(renderer->render(uniform_light(radiance), camera_at({0, 3, 0}, {0, 0, 0})));
    renderer->tone_map(render::ToneMap::reinhard, 0.04);
    EXPECT_GE(renderer->display().rgba[0], 254) << radiance;
  }
}

TEST_F(ToneMapping, ExposureFollowsAStepGraduallyAndArrives) {
  const Scene scene = ground();
  auto renderer = render::Renderer::create(scene, {});
  ASSERT_TRUE(renderer.ok());
  const auto show = [&](float radiance) {
    EXPECT_TRUE(renderer->render(uniform_light(radiance), camera_at({0, 3, 0}, {0, 0, 0})));
    renderer->tone_map(render::ToneMap::reinhard, 0.04);
    return static_cast<int>(renderer->display().rgba[0]);
  };
  show(100);
  const int first = show(30);  // 1.7 stops
  EXPECT_LT(first, 150);       // still exposed for the bright light
  int previous = first;
  for (int i = 0; i < 100; ++i) {
    const int now = show(30);
    EXPECT_GE(now, previous);
    previous = now;
  }
  EXPECT_GE(previous, 254);
}

TEST_F(ToneMapping, ACutIsExposedAtOnce) {
  const Scene scene = ground();
  auto renderer = render::Renderer::create(scene, {});
  ASSERT_TRUE(renderer.ok());
  for (const float radiance : {100.0f, 1.0f, 1e4f}) {
    ASSERT_TRUE(renderer->render(uniform_light(radiance), camera_at({0, 3, 0}, {0, 0, 0})));
    renderer->tone_map(render::ToneMap::reinhard, 0.001);
    EXPECT_GE(renderer->display().rgba[0], 254) << radiance;
  }
}

TEST_F(ToneMapping, ABlackFrameKeepsTheExposure) {
  const Scene scene = ground();
  auto renderer = render::Renderer::create(scene, {});
  ASSERT_TRUE(renderer.ok());
  for (const float radiance : {5.0f, 0.0f, 5.0f}) {
    ASSERT_TRUE(renderer->render(uniform_light(radiance), camera_at({0, 3, 0}, {0, 0, 0})));
    renderer->tone_map(render::ToneMap::reinhard, 0.04);
    EXPECT_EQ(renderer->display().rgba[0] >= 254, radiance > 0);
  }
}

TEST_F(ToneMapping, TheEnvironmentIsShownWhereItsDirectionsAre) {
  // Left half of a latitude–longitude image is +X (docs/conventions.md).
  LatLongImage image{8, 4, std::vector<Rgb>(32, Rgb::Zero())};
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 4; ++x) image.at(x, y) = Rgb(1, 2, 3);
  Scene scene = ground();
  render::RendererOptions options;
  options.width = 1;
  options.height = 1;
  auto renderer = render::Renderer::create(scene, options);
  ASSERT_TRUE(renderer.ok());
  renderer->set_environment(&image);
  const auto look = [&](const Vec3f& toward, double turn_rad) {
    EXPECT_TRUE(renderer->render(light_set({}), camera_at({0, 1, 0}, Vec3f(0, 1, 0) + toward), turn_rad));
    const auto p = renderer->radiance();
    EXPECT_EQ(p.rgba[3], 1);
    return p.rgba[1];
  };
  EXPECT_NEAR(look({1, 0.1f, 0}, 0), 2, 1e-5f);
  EXPECT_NEAR(look({-1, 0.1f, 0}, 0), 0, 1e-5f);
  // Turned by +90° from +Z toward +X, what was at +X is at −Z.
  EXPECT_NEAR(look({0, 0.1f, -1}, kPi / 2), 2, 1e-5f);
  EXPECT_NEAR(look({0, 0.1f, 1}, kPi / 2), 0, 1e-5f);
}

}  // namespace
}  // namespace lightwell
