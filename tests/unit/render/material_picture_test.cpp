// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>

#include "tests/unit/render/render_fixture.h"

namespace lightwell {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)
using render::TextureImage;
using render::TextureUse;
using render::Vec2f;

constexpr int kNearest = 0x2600;
const Rgb kLux = Rgb::Constant(1000);
const float kPiF = static_cast<float>(kPi);

// A square of 2 m on y = height that faces up, u along +X, v along +Z, both from 0 to 1.
render::Primitive& add_square(Scene& scene, const Material& material, float height = 0, bool casts = true) {
  const std::size_t first = scene.vertices.size();
  add_mesh(scene, {{-1, height, -1}, {-1, height, 1}, {1, height, 1}, {1, height, -1}}, {},
           {0, 1, 2, 0, 2, 3}, material, casts);
  for (std::size_t i = first; i < scene.vertices.size(); ++i) {
    const Vec3f& p = scene.vertices[i].position;
    scene.vertices[i].uv = Vec2f((p.x() + 1) / 2, (p.z() + 1) / 2);
  }
  return scene.primitives.back();
}

TextureImage texels(int width, int height, std::vector<std::uint8_t> rgba) {
  TextureImage image{width, height, std::move(rgba)};
  image.min_filter = image.mag_filter = kNearest;
  return image;
}

// A flat normal map whose texel has this direction.
TextureImage normal_texel(const Vec3f& n) {
  std::vector<std::uint8_t> rgba;
  for (const float x : n) rgba.push_back(static_cast<std::uint8_t>(std::lround((x + 1) / 2 * 255)));
  rgba.push_back(255);
  return texels(1, 1, rgba);
}

Vec3f unpacked(const TextureImage& image) {
  return Vec3f(image.rgba[0], image.rgba[1], image.rgba[2]) / 127.5f - Vec3f::Ones();
}

class Materials : public Rendering {
 protected:
  // From above, 16 pixels a metre at the square.
  static render::RadiancePicture from_above(const Scene& scene, const LightSet& lights) {
    SceneCamera camera = camera_at({0, 100, 0}, {0, 0, 0}, 2 * std::atan(1.0f / 100));
    camera.near_m = 1;
    return picture(scene, lights, camera, 32, 32);
  }
  static LightSet above() { return light_set({{Vec3f::UnitY(), kLux}}); }
  // What Lambert's law returns of albedo 1 under one light of kLux.
  static Rgb lambert(const Vec3f& normal, const Vec3f& to_light) {
    return kLux / kPiF * std::max(0.0f, normal.normalized().dot(to_light.normalized()));
  }
};

TEST_F(Materials, VertexColoursMultiplyTheBaseColour) {
  Scene scene;
  add_square(scene, lambertian(Rgb(1, 0.5f, 0.25f)));
  for (auto& v : scene.vertices) v.color = {32768, 16384, 65535, 65535};
  const auto p = from_above(scene, above());
  // Halves hold 11 bits.
  expect_near(rgb(p, 16, 16), kLux / kPiF * Rgb(0.5f, 0.125f, 0.25f), 1e-3f);
}

// Red left, green right; from the file's u and v to the texture's.
TEST_F(Materials, TexturesAreScaledTurnedAndShiftedBeforeTheyWrap) {
  struct Case {
    std::array<float, 6> from_uv;
    int wrap_u;
    std::array<const char*, 2>
        rows;  // what is seen in the columns' centres, at the top row and the bottom row
  };
  for (const Case& c : {Case{{1, 0, 0, 0, 1, 0}, 0x2901, {"rrgg", "rrgg"}},
                        Case{{2, 0, 0, 0, 1, 0}, 0x2901, {"rgrg", "rgrg"}},
                        Case{{2, 0, 0, 0, 1, 0}, 0x8370, {"rggr", "rggr"}},  // mirrored
                        Case{{2, 0, 0, 0, 1, 0}, 0x812f, {"rggg", "rggg"}},  // clamped
                        Case{{1, 0, 0.5f, 0, 1, 0}, 0x2901, {"ggrr", "ggrr"}},
                        Case{{0, 1, 0, -1, 0, 0}, 0x2901, {"rrrr", "gggg"}}}) {  // u from the file's v
    Scene scene;
    Material m = lambertian(Rgb::Ones());
    m.base_color_texture.texture = 0;
    m.base_color_texture.from_uv = c.from_uv;
    add_square(scene, m);
    scene.textures.push_back(texels(2, 1, {255, 0, 0, 255, 0, 255, 0, 255}));
    scene.textures[0].wrap_u = c.wrap_u;
    const auto p = from_above(scene, above());
    for (int row = 0; row < 2; ++row)
      for (int column = 0; column < 4; ++column) {
        const Rgb seen = rgb(p, 4 + 8 * column, row == 0 ? 4 : 28);
        EXPECT_EQ(seen[0] > seen[1] ? 'r' : 'g',
                  c.rows[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)])
            << c.from_uv[0] << " " << c.wrap_u << " row " << row << " column " << column;
      }
  }
}

TEST_F(Materials, BaseColourTexturesAreSrgbAndRoughnessTexturesAreNot) {
  Scene scene;
  Material m = lambertian(Rgb::Ones());
  m.base_color_texture.texture = 0;
  add_square(scene, m);
  scene.textures.push_back(texels(1, 1, {188, 188, 188, 255}));
  const auto p = from_above(scene, above());
  // sRGB 188 is 0.5029 linear.
  expect_near(rgb(p, 16, 16), kLux / kPiF * 0.5029f, 2e-3f);
}

TEST_F(Materials, NormalMapsTurnTheNormalRightAlongUAndUpAgainstV) {
  const Vec3f to_light = Vec3f(1, 2, -0.7f).normalized();
  for (const Vec3f& tilt : {Vec3f(0.5f, 0, 0.866f), Vec3f(0, 0.5f, 0.866f), Vec3f(-0.4f, 0.3f, 0.866f)})
    for (const float mirror : {1.0f, -1.0f})
      for (const float scale : {1.0f, 0.5f}) {
        Scene scene;
        Material m = lambertian(Rgb::Ones());
        m.normal_texture.texture = 0;
        m.normal_scale = scale;
        add_square(scene, m, 0, false);
        for (auto& v : scene.vertices) v.uv.x() *= mirror;  // then u grows along −X
        scene.textures.push_back(normal_texel(tilt));
        const Vec3f map = unpacked(scene.textures[0]);
        const auto p = from_above(scene, light_set({{to_light, kLux}}));
        const Vec3f n(mirror * scale * map.x(), map.z(), -scale * map.y());
        expect_near(rgb(p, 16, 16), lambert(n, to_light), 2e-3f, "normal map");
      }
}

TEST_F(Materials, SeenFromBehindAMappedNormalIsReversedAsAWhole) {
  Scene scene;
  Material m = lambertian(Rgb::Ones());
  m.normal_texture.texture = 0;
  m.double_sided = true;
  add_square(scene, m, 0, false);
  scene.textures.push_back(normal_texel(Vec3f(0.5f, 0.2f, 0.84f)));
  const Vec3f map = unpacked(scene.textures[0]);
  const Vec3f to_light = Vec3f(0.3f, -1, 0.2f).normalized();
  const auto p = picture(scene, light_set({{to_light, kLux}}), camera_at({0.1f, -5, 0.2f}, {0, 0, 0}, 0.3f));
  const Vec3f n(map.x(), map.z(), -map.y());
  expect_near(rgb(p, 16, 12), lambert(-n, to_light), 2e-3f);
}

TEST_F(Materials, NormalMapsWorkAtAnyScaleAndStillCoordinatesHaveNone) {
  const Vec3f to_light = Vec3f(1, 2, 0).normalized();
  for (const float size : {1e-6f, 1e6f}) {
    Scene scene;
    Material m = lambertian(Rgb::Ones());
    m.normal_texture.texture = 0;
    add_square(scene, m, 0, false);
    for (auto& v : scene.vertices) v.position *= size;
    scene.textures.push_back(normal_texel(Vec3f(0.5f, 0, 0.866f)));
    SceneCamera camera = camera_at({0, 5 * size, 0.001f * size}, {0, 0, 0}, 0.3f);
    camera.near_m = size;
    const Vec3f map = unpacked(scene.textures[0]);
    const LightSet lights = light_set({{to_light, kLux}});
    expect_near(rgb(picture(scene, lights, camera), 16, 12), lambert({map.x(), map.z(), 0}, to_light), 2e-3f);
    for (auto& v : scene.vertices) v.uv.setZero();
    expect_near(rgb(picture(scene, lights, camera), 16, 12), lambert(Vec3f::UnitY(), to_light), 2e-3f);
  }
}

// Left half is a hole, at a height above ground that receives.
TEST_F(Materials, HolesAreSeenThroughAndLetLightPass) {
  Scene scene;
  Material m = lambertian(Rgb::Ones());
  m.base_color_texture.texture = 0;
  m.alpha_cutoff = 0.5f;
  m.double_sided = true;
  add_square(scene, m, 1);
  add_ground(scene, lambertian(Rgb::Constant(0.5f)), false, 3);
  scene.textures.push_back(texels(2, 1, {255, 255, 255, 100, 255, 255, 255, 200}));
  // From straight above the sheet hides its right half's shadow and shows the ground through its left.
  const auto p = from_above(scene, above());
  expect_near(rgb(p, 8, 16), kLux / kPiF * 0.5f, 1e-3f, "through the hole");
  expect_near(rgb(p, 24, 16), kLux / kPiF, 1e-3f, "sheet");
  // The sun from the left at 45° moves the shadow by 1 m: it lies on x from 1 to 2, and 0 to 1 is lit through the hole.
  const auto low = picture(scene, light_set({{Vec3f(-1, 1, 0), kLux}}),
                           camera_at({1, 0.9f, 0.4f}, {1, 0, 0}, 1.2f), 64, 48);
  const render::View view = render::make_view(camera_at({1, 0.9f, 0.4f}, {1, 0, 0}, 1.2f), 64, 48);
  int lit = 0;
  int dark = 0;
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 64; ++x) {
      const Vec3f ray = pixel_ray(view, x, y, 64, 48);
      if (ray.y() >= 0) continue;
      const Vec3f point = view.eye - ray * (view.eye.y() / ray.y());
      // Two texels: 2 · 2 · √2 / 252 m over cos 45°.
      constexpr float kMargin = 0.04f;
      if (std::abs(point.z()) > 1 - kMargin) continue;
      const float value = rgb(low, x, y)[0];
      const float full = 0.5f * 1000 / kPiF * std::sqrt(0.5f);
      if (point.x() > kMargin && point.x() < 1 - kMargin) {
        ++lit;
        EXPECT_NEAR(value, full, 1e-3f * full) << point.transpose();
      } else if (point.x() > 1 + kMargin && point.x() < 2 - kMargin) {
        ++dark;
        EXPECT_EQ(value, 0) << point.transpose();
      }
    }
  EXPECT_GT(lit, 50);
  EXPECT_GT(dark, 50);
}

TEST_F(Materials, FactorAndVertexAlphaMakeHolesToo) {
  for (const bool by_vertex : {false, true}) {
    Scene scene;
    Material m = lambertian(Rgb::Ones());
    m.alpha_cutoff = 0.5f;
    if (!by_vertex) m.alpha = 0.4f;
    add_square(scene, m, 1);
    if (by_vertex)
      for (auto& v : scene.vertices) v.color[3] = 26214;  // 0.4
    add_ground(scene, lambertian(Rgb::Constant(0.5f)), false, 3);
    expect_near(rgb(from_above(scene, above()), 16, 16), kLux / kPiF * 0.5f, 1e-3f);
  }
}

TEST_F(Materials, EmittedRadianceIsAddedOnceWhateverLightsAndSamples) {
  Scene scene;
  Material m = lambertian(Rgb::Constant(0.5f));
  m.emission = Rgb(10, 20, 3000);
  m.emission_texture.texture = 0;
  add_square(scene, m, 0, false);
  scene.textures.push_back(texels(2, 1, {255, 255, 255, 255, 0, 0, 0, 255}));
  const auto dark = from_above(scene, {});
  expect_near(rgb(dark, 8, 16), Rgb(10, 20, 3000), 1e-3f);
  EXPECT_TRUE((rgb(dark, 24, 16) == 0).all());
  const auto sampled = picture(scene, above(), camera_at({0, 100, 0}, {0, 0, 0}, 0.01f), 32, 32, 4);
  expect_near(rgb(sampled, 8, 16), Rgb(10, 20, 3000) + kLux / kPiF * 0.5f, 1e-3f);
  EXPECT_EQ(alpha(sampled, 8, 16), 1);
}

}  // namespace
}  // namespace lightwell
