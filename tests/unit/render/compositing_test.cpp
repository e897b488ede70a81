// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <optional>

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
    renderer->set_look(look_);
    renderer->tone_map(0.04);
    display_ = renderer->display();
    return renderer->radiance();
  }
  // The pixel that sees a point: its column and row.
  [[nodiscard]] std::pair<int, int> pixel(const Vec3f& point) const {
    const render::View view = render::make_view(camera_, kWidth, kHeight);
    const Eigen::Vector4f clip = view.clip_from_world * point.homogeneous();
    const auto place = [](float ndc, int size) {
      return static_cast<int>((ndc * 0.5f + 0.5f) * static_cast<float>(size));
    };
    return {place(clip.x() / clip.w(), kWidth), place(-clip.y() / clip.w(), kHeight)};
  }
  [[nodiscard]] Rgb at(const render::RadiancePicture& p, const Vec3f& point) const {
    const auto [x, y] = pixel(point);
    return rgb(p, x, y);
  }
  // Of the display, red.
  [[nodiscard]] int code_at(const Vec3f& point) const {
    const auto [x, y] = pixel(point);
    return display_.rgba[static_cast<std::size_t>(4 * (y * kWidth + x))];
  }
  // The top of the box under a light from above, of this radiance.
  int object_code(float radiance, float white) {
    over(constant_plate(kPlate),
         light_set({{Vec3f::UnitY(), Rgb::Constant(2 * radiance * static_cast<float>(kPi))}}), white);
    return code_at({0, 1, 0});
  }
  render::Look look_;
  render::DisplayPicture display_;
  Scene scene_;
  SceneCamera camera_ = camera_at({0, 12, 0.01f}, {0, 0, 0}, 0.6f);
};

// Codes of every height and mixed colours, a pixel of the picture each.
render::Plate plate_of_codes(std::vector<std::uint8_t>& codes) {
  render::Plate plate{kWidth, kHeight, {}, true, ""};
  for (int i = 0; i < kWidth * kHeight; ++i) {
    Rgb linear;
    for (int c = 0; c < 3; ++c) {
      codes.push_back(static_cast<std::uint8_t>(i * (2 * c + 1) + 31 * c));
      linear[c] = render::linear_from_srgb(static_cast<float>(codes.back()) / 255);
    }
    plate.pixels.push_back(linear);
  }
  return plate;
}

double srgb_code(double linear) {
  return 255 * (linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055);
}

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

// Where the radiance is the plate's, no object or shadow changed it.
TEST_F(Compositing, AGradedPlateKeepsItsCodesUnderEveryOperator) {
  const LightSet lights =
      light_set({{kFromLeft, Rgb::Constant(9e4f)}, {Vec3f::UnitY(), Rgb::Constant(3e4f)}});
  std::vector<std::uint8_t> codes;
  const render::Plate plate = plate_of_codes(codes);
  for (const auto operation : {render::ToneMap::reinhard, render::ToneMap::none})
    for (const int samples : {1, 3})
      for (const auto& ev100 : {std::optional<double>(), std::optional<double>(5)}) {
        look_.operation = operation;
        look_.exposure_ev100 = ev100;
        const float white = 4000;
        const auto p = over(plate, lights, white, samples);
        int untouched = 0;
        for (std::size_t i = 0; i < plate.pixels.size(); ++i) {
          const Rgb whole = white * plate.pixels[i];
          const Rgb seen = rgb(p, static_cast<int>(i) % kWidth, static_cast<int>(i) / kWidth);
          if ((seen - whole).abs().maxCoeff() > 1e-5f * whole.maxCoeff()) continue;
          ++untouched;
          for (std::size_t c = 0; c < 3; ++c)
            ASSERT_EQ(display_.rgba[4 * i + c], codes[3 * i + c]) << i << "," << c << " " << samples;
        }
        EXPECT_GT(untouched, kWidth * kHeight * 3 / 4);
      }
}

TEST_F(Compositing, AShadowOnAGradedPlateIsItsDisplayLightTimesTheRatio) {
  over(constant_plate(kPlate),
       light_set({{kFromLeft, Rgb::Constant(900)}, {Vec3f::UnitY(), Rgb::Constant(300)}}));
  const double ratio = 300 / (300 + 900 * std::sqrt(0.5));
  EXPECT_NEAR(code_at(kInShadow), srgb_code(static_cast<double>(kPlate[0]) * ratio), 0.51);
  EXPECT_NEAR(code_at(kInSun), srgb_code(static_cast<double>(kPlate[0])), 0.51);
}

TEST_F(Compositing, AnObjectAsBrightAsAPartOfAGradedPlateHasItsCodes) {
  for (const auto operation : {render::ToneMap::reinhard, render::ToneMap::none})
    for (const float part : {0.01f, 0.2f, 0.5f, 0.79f}) {
      look_.operation = operation;
      // Rounding, and half floats of the albedo: 2⁻¹¹ of 200 codes.
      EXPECT_NEAR(object_code(part * 700, 700), srgb_code(static_cast<double>(part)), 0.61) << part;
    }
}

TEST_F(Compositing, ReinhardKeepsTheShadesOfObjectsAboveAGradedPlatesWhite) {
  // A brighter box beside sets the white point; the operator's closed form above the knee of 0.8.
  add_box(scene_, {-3, 0, -0.5f}, {-2, 1, 0.5f}, lambertian(Rgb::Constant(1)));
  const auto shown = [](double l, double largest) {
    const double white = (largest - 0.8) / 0.2;
    const double above = (l - 0.8) / 0.2;
    return srgb_code(0.8 + 0.2 * above * (1 + above / (white * white)) / (1 + above));
  };
  for (const float part : {0.9f, 1.0f, 2.0f, 20.0f}) {
    EXPECT_NEAR(object_code(part * 700, 700), shown(static_cast<double>(part), 2 * static_cast<double>(part)),
                0.61)
        << part;
    EXPECT_EQ(code_at({-2.5f, 1, 0}), 255);
  }
  look_.operation = render::ToneMap::none;
  EXPECT_EQ(object_code(1.01f * 700, 700), 255);
}

TEST_F(Compositing, ExposureByHandIsTheObjectsAlone) {
  look_.operation = render::ToneMap::none;
  look_.exposure_ev100 = 8;  // 1.2 · 2^8 cd/m² is white
  EXPECT_NEAR(object_code(0.4f * 1.2f * 256, 700), srgb_code(0.4), 0.61);
  EXPECT_NEAR(code_at(kInSun), srgb_code(static_cast<double>(kPlate[0])), 0.51);
}

TEST_F(Compositing, APlateOfRadianceIsTonedAsTheObjectsAre) {
  render::Plate plate = constant_plate(kPlate);
  plate.display_referred = false;
  look_.exposure_ev100 = 3;  // 1 cd/m² is middle grey, 0.18
  over(plate, light_set({{Vec3f::UnitY(), Rgb::Constant(10)}}));
  const double y = 0.2126 * 0.2 + 0.7152 * 0.5 + 0.0722 * 0.7;
  const double l = 0.18 * y;
  const double white = 0.18 * 32;
  EXPECT_NEAR(code_at(kInSun), srgb_code(0.18 * 0.2 * (1 + l / (white * white)) / (1 + l)), 0.51);
}

}  // namespace
}  // namespace lightwell
