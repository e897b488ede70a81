// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "tests/unit/render/render_fixture.h"

namespace lightwell {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)

constexpr int kWidth = 120;
constexpr int kHeight = 90;
const Rgb kPlate(0.2f, 0.5f, 0.7f);
// Half floats of the G-buffer (2⁻¹¹) cancel in a ratio; sums of a few lights in floats remain.
constexpr float kTolerance = 1e-5f;

render::Plate constant_plate(const Rgb& colour) {
  return {3, 2, std::vector<Rgb>(6, colour), true, ""};
}

// A box of 1 m on the ground, and an overhead camera that sees its shadow at the right.
class Compositing : public Rendering {
 protected:
  Compositing() {
    add_ground(scene_, lambertian(Rgb(0.3f, 0.9f, 0.05f)));
    add_box(scene_, {-0.5f, 0, -0.5f}, {0.5f, 1, 0.5f}, lambertian(Rgb::Constant(0.5f)));
  }
  render::RadiancePicture over(const render::Plate& plate, const LightSet& lights, float white = 1,
                               int samples = 1) {
    render::RendererOptions options;
    options.width = kWidth;
    options.height = kHeight;
    options.samples = samples;
    auto renderer = render::Renderer::create(scene_, options);
    EXPECT_TRUE(renderer.ok()) << renderer.error().message;
    EXPECT_TRUE(renderer->set_plate(plate, white));
    EXPECT_TRUE(renderer->render(lights, camera_));
    return renderer->radiance();
  }
  // The pixel that sees a point of the ground.
  [[nodiscard]] Rgb at(const render::RadiancePicture& p, const Vec3f& point) const {
    const render::View view = render::make_view(camera_, kWidth, kHeight);
    const Eigen::Vector4f clip = view.clip_from_world * point.homogeneous();
    const auto place = [](float ndc, int size) {
      return static_cast<int>((ndc * 0.5f + 0.5f) * static_cast<float>(size));
    };
    return rgb(p, place(clip.x() / clip.w(), kWidth), place(-clip.y() / clip.w(), kHeight));
  }
  Scene scene_;
  SceneCamera camera_ = camera_at({0, 12, 0.01f}, {0, 0, 0}, 0.6f);
};

const Vec3f kInShadow(0.9f, 0, 0);  // of light from the left at 45°: the shadow reaches to x = 1.5
const Vec3f kInSun(-0.9f, 0, 0);
const Vec3f kFromLeft(-1, 1, 0);

TEST_F(Compositing, ShadowIsThePlateTimesTheLightThatRemains) {
  // Coloured light: red only from the left, blue and some red from above. What remains in the shadow is the light from
  // above: of red 300 / (300 + 900 cos 45°), of green none was there, of blue all.
  const LightSet lights = light_set({{kFromLeft, Rgb(900, 0, 0)}, {Vec3f::UnitY(), Rgb(300, 0, 500)}});
  const auto p = over(constant_plate(kPlate), lights);
  const Rgb ratio(300 / (300 + 900 * std::sqrt(0.5f)), 1, 1);
  expect_near(at(p, kInShadow), kPlate * ratio, kTolerance, "shadow");
  expect_near(at(p, kInSun), kPlate, kTolerance, "sun");
  for (std::size_t i = 3; i < p.rgba.size(); i += 4) ASSERT_EQ(p.rgba[i], 1);
}

TEST_F(Compositing, AmbientLightFillsTheShadow) {
  LightSet lights = light_set({{kFromLeft, Rgb::Constant(1000)}});
  lights.ambient = Rgb::Constant(50);
  // Lambertian: E/π cos 45° against radiance 50 from everywhere.
  const float sun = 1000 * std::sqrt(0.5f) / static_cast<float>(kPi);
  expect_near(at(over(constant_plate(kPlate), lights), kInShadow), kPlate * (50 / (50 + sun)), kTolerance);
}

TEST_F(Compositing, FullShadowIsBlack) {
  const auto p = over(constant_plate(kPlate), light_set({{kFromLeft, Rgb::Constant(1000)}}));
  EXPECT_EQ(at(p, kInShadow).maxCoeff(), 0);
}

TEST_F(Compositing, WithoutLightThePlateStaysAsItIs) {
  for (const LightSet& none : {light_set({}), light_set({{-Vec3f::UnitY(), Rgb::Constant(1000)}})}) {
    const auto p = over(constant_plate(kPlate), none);
    expect_near(at(p, kInShadow), kPlate, kTolerance);
    EXPECT_EQ(at(p, {0, 1, 0}).maxCoeff(), 0) << "the object is dark";
  }
}

TEST_F(Compositing, ObjectsStandBeforeThePlateInTheirOwnRadiance) {
  const LightSet lights = light_set({{Vec3f::UnitY(), Rgb::Constant(1000)}});
  const auto p = over(constant_plate(kPlate), lights);
  // The G-buffer's half floats: 2⁻¹¹.
  expect_near(at(p, {0, 1, 0}), Rgb::Constant(0.5f * 1000 / static_cast<float>(kPi)), 5e-4f);
}

TEST_F(Compositing, WhereNoSurfaceIsThePlateIsSeenPixelByPixel) {
  scene_ = {};
  add_box(scene_, {50, 0, 50}, {51, 1, 51}, lambertian(Rgb::Ones()));  // outside of the picture
  render::Plate plate{kWidth, kHeight, {}, false, ""};
  for (int i = 0; i < kWidth * kHeight; ++i)
    plate.pixels.emplace_back(static_cast<float>(i % kWidth), static_cast<float>(i / kWidth), 1e8f);
  const auto p = over(plate, light_set({}), 2);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      ASSERT_TRUE((rgb(p, x, y) == 2 * plate.pixels[static_cast<std::size_t>(y * kWidth + x)]).all())
          << x << "," << y << ": " << rgb(p, x, y).transpose();
}

TEST_F(Compositing, ManySamplesAndMoreLightsThanABlockHoldsGiveTheSameShadow) {
  std::vector<std::pair<Vec3f, Rgb>> many(300, {kFromLeft, Rgb::Constant(3)});
  many.insert(many.end(), 100, {Vec3f::UnitY(), Rgb::Constant(2)});
  const float sun = 900 * std::sqrt(0.5f);
  const auto p = over(constant_plate(kPlate), light_set(many), 1, 3);
  expect_near(at(p, kInShadow), kPlate * (200 / (200 + sun)), 5e-5f);  // 400 sums in floats
  expect_near(at(p, kInSun), kPlate, 5e-5f);
}

}  // namespace
}  // namespace lightwell
