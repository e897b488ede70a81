// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// Pictures under lamps against brute force (tests/support/lamp_reference.h) and closed forms.
#include <gtest/gtest.h>

#include <memory>

#include "tests/support/lamp_reference.h"
#include "tests/unit/render/render_fixture.h"

namespace lightwell {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)
using render::PlacedLamp;

constexpr int kWidth = 96, kHeight = 72;
constexpr double kMostError =
    0.03;  // relative RMSE that the renderer is to keep (docs/user-guide/rendering.md)

class LampPictures : public Rendering {
 protected:
  static render::Renderer renderer_of(const Scene& scene, double lamp_error = 0, int shadow_size = 256) {
    render::RendererOptions options;
    options.width = kWidth;
    options.height = kHeight;
    options.shadow_size = shadow_size;
    options.lamp_error = lamp_error;
    auto renderer = render::Renderer::create(scene, options);
    EXPECT_TRUE(renderer.ok()) << renderer.error().message;
    return std::move(renderer).value();
  }
  static render::RadiancePicture picture_of(render::Renderer& renderer, const std::vector<PlacedLamp>& lamps,
                                            const SceneCamera& camera, const LightSet& lights = {}) {
    EXPECT_TRUE(renderer.set_lamps(lamps).ok());
    const Status status = renderer.render(lights, camera);
    EXPECT_TRUE(status.ok()) << status.error().message;
    return renderer.radiance();
  }
};

std::shared_ptr<const Luminaire> shared(Luminaire lamp) {
  return std::make_shared<const Luminaire>(std::move(lamp));
}

// A ball and a box on a floor that casts too: it supports the scene.
Scene stage() {
  Scene scene;
  add_ground(scene, lambertian(Rgb::Constant(0.6f)), true, 1.5f);
  add_box(scene, {-0.5f, 0, -0.3f}, {-0.2f, 0.3f, 0.1f}, lambertian({0.7f, 0.3f, 0.2f}));
  add_sphere(scene, {0.2f, 0.25f, 0.1f}, 0.18f, lambertian({0.2f, 0.5f, 0.7f}), true, 10);
  return scene;
}
SceneCamera stage_camera() {
  return camera_at({0.3f, 1.3f, 1.9f}, {0, 0.1f, 0}, 0.6f);
}

TEST_F(LampPictures, LampCloseToAnObjectHasItsNearFieldAndItsSoftShadow) {
  const Scene scene = stage();
  const std::vector<PlacedLamp> lamps = {
      {shared({"", patterned_lamp(5, 4, 0.04, 48), {}}), aimed_down({0, 1, 0}, 0.15), 1}};
  const auto reference = lamp_picture_by_force(scene, lamps, stage_camera(), kWidth, kHeight);
  auto renderer = renderer_of(scene);
  const auto picture = picture_of(renderer, lamps, stage_camera());
  const PictureDifference off = difference(picture, reference);
  EXPECT_LE(off.relative_rmse, kMostError);
  EXPECT_NEAR(off.light, 1, 0.005);
  EXPECT_GT(off.lit, 2000u);
  EXPECT_EQ(renderer.lamps().counts().sources, 20u);
  EXPECT_EQ(renderer.lamps().counts().maps, 20u);
}

// Intensity that differs over the whole sphere, in even steps of 5° and 10°.
FarField uneven_far_field() {
  FarField far;
  far.horizontal_deg.clear();
  for (int c = 0; c < 360; c += 10) far.horizontal_deg.push_back(c);
  for (int g = 0; g <= 180; g += 5) far.vertical_deg.push_back(g);
  for (const double c : far.horizontal_deg)
    for (const double g : far.vertical_deg)
      far.candela.push_back(30 + 20 * std::cos(g * kPi / 60) +
                            10 * std::sin(c * kPi / 90) * std::sin(g * kPi / 180));
  return far;
}

TEST_F(LampPictures, SmallMapsShowShadowsToo) {
  // Below 64 texels there are no finer meshes for large maps.
  const Scene scene = stage();
  const std::vector<PlacedLamp> lamps = {
      {shared({"", {}, uneven_far_field()}), aimed_down({0.6, 1.2, 0.4}), 1}};
  const auto reference = lamp_picture_by_force(scene, lamps, stage_camera(), kWidth, kHeight);
  auto renderer = renderer_of(scene, 0, 32);
  const auto with_shadows = difference(picture_of(renderer, lamps, stage_camera()), reference);
  EXPECT_EQ(renderer.lamps().counts().map_side, 128);
  ASSERT_TRUE(renderer.set_shadows(false).ok());
  const auto without = difference(picture_of(renderer, lamps, stage_camera()), reference);
  EXPECT_LE(with_shadows.relative_rmse, without.relative_rmse / 4);  // edges of 128 texels are left
}

TEST_F(LampPictures, FarFieldAmidTheObjectsLightsAllAroundIt) {
  Scene scene = stage();
  add_box(scene, {-1.5f, 0, -1.5f}, {1.5f, 1.2f, -1.4f}, lambertian(Rgb::Constant(0.5f)));
  const std::vector<PlacedLamp> lamps = {
      {shared({"", {}, uneven_far_field()}), aimed_down({-0.05, 0.35, 0.35}, 0.4), 2}};
  const auto reference = lamp_picture_by_force(scene, lamps, stage_camera(), kWidth, kHeight);
  auto renderer = renderer_of(scene);
  const auto picture = picture_of(renderer, lamps, stage_camera());
  const PictureDifference off = difference(picture, reference);
  EXPECT_LE(off.relative_rmse, kMostError);
  EXPECT_NEAR(off.light, 1, 0.005);
  EXPECT_GT(off.lit, 2000u);
  EXPECT_LT(off.lit_share, 0.97);  // there are shadows
  EXPECT_GT(renderer.lamps().counts().maps, 1u);
}

TEST_F(LampPictures, FarFieldFarAwayHasOneMap) {
  const Scene scene = stage();
  const std::vector<PlacedLamp> lamps = {{shared({"", {}, uneven_far_field()}), aimed_down({1.5, 3, 1}), 10}};
  const auto reference = lamp_picture_by_force(scene, lamps, stage_camera(), kWidth, kHeight);
  auto renderer = renderer_of(scene);
  const PictureDifference off = difference(picture_of(renderer, lamps, stage_camera()), reference);
  EXPECT_LE(off.relative_rmse, kMostError);
  EXPECT_NEAR(off.light, 1, 0.005);
  EXPECT_EQ(renderer.lamps().counts().maps, 1u);
}

// What a ray file becomes: images over the hemisphere, and a rest that shines beside and behind.
Luminaire lamp_of_rays() {
  Luminaire lamp;
  LampPlanes& planes = lamp.near.emplace().intensity.planes;
  planes.map = LampMap::hemisphere;
  planes.positions = {3, 2};
  planes.spacing_m = 0.05;
  planes.first_m = {-0.05, -0.025};
  planes.pixels = {64, 64};
  planes.low_m = Vec2d::Constant(-1);
  planes.high_m = Vec2d::Constant(1);
  lamp.near->intensity.values.resize(planes.images() * planes.image_size());
  for (int v = 0; v < 2; ++v)
    for (int u = 0; u < 3; ++u) {
      Rgb* pixel = lamp.near->intensity.image(u, v);
      for (int t = 0; t < 64; ++t)
        for (int s = 0; s < 64; ++s) {
          const Vec3d d = direction_from_square(planes.pixel_centre(s, t));
          *pixel++ = Rgb::Constant(
              static_cast<float>(-d.z() * (20 + 10 * std::sin(4 * d.x() + u) * std::cos(3 * d.y() + v))));
        }
    }
  lamp.far = uneven_far_field();
  for (double& candela : lamp.far->candela) candela /= 4;
  return lamp;
}

TEST_F(LampPictures, LampOfRaysShinesOverItsWholeHemisphereAndBeyond) {
  const Scene scene = stage();
  for (const Vec3d& place : {Vec3d(0, 1.4, 0), Vec3d(-0.1, 0.5, 0.1)}) {  // above the objects, and among them
    const std::vector<PlacedLamp> lamps = {{shared(lamp_of_rays()), aimed_down(place, 0.3), 1}};
    const auto reference = lamp_picture_by_force(scene, lamps, stage_camera(), kWidth, kHeight);
    auto renderer = renderer_of(scene);
    const PictureDifference off = difference(picture_of(renderer, lamps, stage_camera()), reference);
    EXPECT_LE(off.relative_rmse, kMostError) << place.transpose();
    EXPECT_NEAR(off.light, 1, 0.005) << place.transpose();
  }
}

TEST_F(LampPictures, SeveralLampsAndTheLightsOfAProbeAddUp) {
  const Scene scene = stage();
  const auto near = shared({"", patterned_lamp(3, 3, 0.05, 32), {}});
  const auto far = shared({"", {}, uneven_far_field()});
  const std::vector<PlacedLamp> both = {{near, aimed_down({0, 1, 0}), 1}, {far, aimed_down({1, 2, 1}), 5}};
  const LightSet lights = light_set({{{1, 2, 1}, Rgb(10, 20, 30)}, {{-1, 2, 0}, Rgb::Constant(15)}});
  auto renderer = renderer_of(scene);
  const auto together = picture_of(renderer, both, stage_camera(), lights);
  std::vector<float> sum(together.rgba.size(), 0.0f);
  const auto add = [&](const render::RadiancePicture& p) {
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += p.rgba[i];
  };
  add(picture_of(renderer, {both[0]}, stage_camera()));
  add(picture_of(renderer, {both[1]}, stage_camera()));
  add(picture_of(renderer, {}, stage_camera(), lights));
  float brightest = 0;
  for (std::size_t i = 0; i < sum.size(); ++i) {
    if (i % 4 == 3) continue;
    brightest = std::max(brightest, together.rgba[i]);
    EXPECT_NEAR(together.rgba[i], sum[i], 1e-4f + 1e-4f * sum[i]) << i;
  }
  EXPECT_GT(brightest, 1);
}

TEST_F(LampPictures, LampWhoseBackIsTurnedOrThatIsOffLightsNothing) {
  const Scene scene = stage();
  const auto lamp = shared({"", patterned_lamp(3, 3, 0.05, 32), {}});
  Luminaire dark{"", patterned_lamp(2, 2, 0.05, 8), {}};
  for (Rgb& value : dark.near->intensity.values) value.setZero();
  Eigen::Isometry3d upward = aimed_down({0, 1, 0});
  upward.linear() = Eigen::AngleAxisd(kPi / 2, Vec3d::UnitX()).toRotationMatrix();
  auto renderer = renderer_of(scene);
  for (const std::vector<PlacedLamp>& lamps :
       {std::vector<PlacedLamp>{{lamp, upward, 1}}, std::vector<PlacedLamp>{{lamp, aimed_down({0, 1, 0}), 0}},
        std::vector<PlacedLamp>{{shared(dark), aimed_down({0, 1, 0}), 1}},
        std::vector<PlacedLamp>{{lamp, aimed_down({0, -1, 0}), 1}}}) {
    const auto picture = picture_of(renderer, lamps, stage_camera());
    for (std::size_t i = 0; i < picture.rgba.size(); ++i)
      if (i % 4 != 3) {
        ASSERT_EQ(picture.rgba[i], 0) << i;
      }
  }
}

TEST_F(LampPictures, FloorHidesALampBelowIt) {
  // Aimed up through the floor, which casts: nothing above it is lit.
  const Scene scene = stage();
  Eigen::Isometry3d upward = Eigen::Isometry3d::Identity();
  upward.translation() = Vec3d(0, -0.5, 0);
  upward.linear() = Eigen::AngleAxisd(kPi / 2, Vec3d::UnitX()).toRotationMatrix();
  for (const Luminaire& lamp :
       {Luminaire{"", patterned_lamp(3, 3, 0.05, 32), {}}, Luminaire{"", {}, uneven_far_field()}}) {
    auto renderer = renderer_of(scene);
    const auto picture = picture_of(renderer, {{shared(lamp), upward, 1}}, stage_camera());
    for (std::size_t i = 0; i < picture.rgba.size(); ++i)
      if (i % 4 != 3) {
        ASSERT_EQ(picture.rgba[i], 0) << i;
      }
  }
}

TEST_F(LampPictures, LampInsideAClosedObjectStaysThere) {
  Scene scene;
  add_ground(scene, lambertian(Rgb::Constant(0.6f)), false, 1.5f);
  add_box(scene, {-0.2f, 0.2f, -0.2f}, {0.2f, 0.6f, 0.2f}, lambertian(Rgb::Constant(0.5f)));
  add_box(scene, {0.6f, 0, 0.6f}, {0.8f, 0.2f, 0.8f}, lambertian(Rgb::Constant(0.5f)));
  for (const Luminaire& lamp :
       {Luminaire{"", patterned_lamp(3, 3, 0.05, 32), {}}, Luminaire{"", {}, uneven_far_field()}}) {
    auto renderer = renderer_of(scene);
    const auto picture = picture_of(renderer, {{shared(lamp), aimed_down({0, 0.45, 0}), 1}}, stage_camera());
    for (std::size_t i = 0; i < picture.rgba.size(); ++i)
      if (i % 4 != 3) {
        ASSERT_EQ(picture.rgba[i], 0) << i;
      }
  }
}

TEST_F(LampPictures, ReceiverInTheSamplingPlaneAndAtASourceStaysFinite) {
  // The floor goes through the sources: half of it lies in their plane, which gets nothing.
  Scene scene;
  add_ground(scene, lambertian(Rgb::Constant(0.6f)), false, 1.5f);
  add_box(scene, {-0.05f, -0.3f, -0.05f}, {0.05f, 0.3f, 0.05f}, lambertian(Rgb::Constant(0.5f)));
  auto renderer = renderer_of(scene);
  for (const Luminaire& lamp : {Luminaire{"", patterned_lamp(3, 3, 0.05, 32), {}}, lamp_of_rays()}) {
    const auto picture = picture_of(renderer, {{shared(lamp), aimed_down({0, 0, 0}), 1}}, stage_camera());
    for (const float value : picture.rgba) ASSERT_TRUE(std::isfinite(value));
  }
}

TEST_F(LampPictures, OnlyALampThatMovedHasItsMapsDrawnAgain) {
  const Scene scene = stage();
  const auto lamp = shared({"", patterned_lamp(3, 2, 0.05, 16), {}});
  std::vector<PlacedLamp> lamps = {{lamp, aimed_down({0, 1, 0}), 1}, {lamp, aimed_down({0.3, 1, 0}), 1}};
  auto renderer = renderer_of(scene);
  (void)picture_of(renderer, lamps, stage_camera());
  EXPECT_EQ(renderer.shadow_maps_drawn(), 12u);
  lamps[0].dimming = 0.5;
  (void)picture_of(renderer, lamps, stage_camera());
  EXPECT_EQ(renderer.shadow_maps_drawn(), 0u);
  lamps[1].world_from_lamp = aimed_down({0.31, 1, 0});
  const auto moved = picture_of(renderer, lamps, stage_camera());
  EXPECT_EQ(renderer.shadow_maps_drawn(), 6u);
  // As if it had always stood there.
  auto another = renderer_of(scene);
  EXPECT_EQ(moved.rgba, picture_of(another, lamps, stage_camera()).rgba);
}

TEST_F(LampPictures, LampFarAwayIsADirectionalLightOnEveryMaterialAndOverAPlate) {
  Scene scene;
  add_ground(scene, lambertian(Rgb::Constant(0.6f)), false, 1.5f);
  Material glossy = lambertian({0.2f, 0.3f, 0.1f});
  glossy.specular = Rgb::Constant(0.4f);
  glossy.exponent = 12;
  add_sphere(scene, {-0.4f, 0.3f, 0}, 0.25f, glossy, true, 24);
  Material metal;
  metal.base_color = {0.9f, 0.6f, 0.2f};
  metal.metallic = 0.7f;
  metal.roughness = 0.4f;
  add_sphere(scene, {0.4f, 0.3f, 0}, 0.25f, metal, true, 24);
  constexpr double kAway = 500, kLux = 1000;
  FarField even;
  even.vertical_deg = {0, 180};
  even.candela = {kLux * kAway * kAway, kLux * kAway * kAway};
  const Vec3d toward = Vec3d(0.4, 0.8, 0.5).normalized();
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = kAway * toward + Vec3d(0, 0.3, 0);
  const LightSet lights = light_set({{toward.cast<float>(), Rgb::Constant(static_cast<float>(kLux))}});
  render::Plate plate;
  plate.width = plate.height = 1;
  plate.pixels = {Rgb::Constant(0.5f)};
  for (const bool over_a_plate : {false, true}) {
    auto by_lamp = renderer_of(scene), by_light = renderer_of(scene);
    if (over_a_plate) {
      ASSERT_TRUE(by_lamp.set_plate(plate, 100).ok());
      ASSERT_TRUE(by_light.set_plate(plate, 100).ok());
    }
    const auto lamp = picture_of(by_lamp, {{shared({"", {}, even}), pose, 1}}, stage_camera());
    const auto light = picture_of(by_light, {}, stage_camera(), lights);
    // Shadows' edges fall into other texels; everything else is the same.
    std::size_t off = 0, bright = 0;
    for (std::size_t k = 0; k < light.rgba.size(); ++k) {
      if (light.rgba[k] > 1) ++bright;
      if (std::abs(lamp.rgba[k] - light.rgba[k]) > 0.01f * light.rgba[k] + 0.01f) ++off;
    }
    EXPECT_GT(bright, 10000u);
    EXPECT_LT(off, light.rgba.size() / 100) << over_a_plate;
  }
}

TEST_F(LampPictures, PatternFinerThanThePictureIsSeenAsItsMean) {
  // A chequerboard of its pixels; the floor under it shows twenty of them in a pixel of the picture.
  NearField lamp = patterned_lamp(1, 1, 0.01, 512);
  for (int t = 0; t < 512; ++t)
    for (int s = 0; s < 512; ++s)
      lamp.intensity.image(0, 0)[t * 512 + s] = Rgb::Constant((s + t) % 2 == 0 ? 20.f : 0.f);
  Scene scene;
  add_ground(scene, lambertian(Rgb::Constant(static_cast<float>(kPi) / 4)), false, 1.5f);
  auto renderer = renderer_of(scene);
  const std::vector<PlacedLamp> lamps = {{shared({"", lamp, {}}), aimed_down({0, 0.5, 0}), 1}};
  const SceneCamera camera = camera_at({0, 4, 0.01f}, {0, 0, 0}, 0.5f);
  const auto picture = picture_of(renderer, lamps, camera);
  const render::View view = render::make_view(camera, kWidth, kHeight);
  for (int y = kHeight / 2 - 4; y < kHeight / 2 + 4; ++y)
    for (int x = kWidth / 2 - 4; x < kWidth / 2 + 4; ++x) {
      const Vec3f ray = pixel_ray(view, x, y, kWidth, kHeight);
      const Vec3d point = (view.eye - ray * (view.eye.y() / ray.y())).cast<double>();
      // 10 cd on the average from half a metre above, of which a quarter returns.
      const double expected = 10 * 0.5 / std::pow((point - Vec3d(0, 0.5, 0)).norm(), 3) / 4;
      EXPECT_NEAR(rgb(picture, x, y)[0], expected, 0.02 * expected) << x << " " << y;
    }
}

TEST_F(LampPictures, TableOfFewPlanesKeepsThemWhereItsFineRowsAreFiltered) {
  // A pixel is three rows of a degree wide, and far narrower than the 15° between planes.
  FarField far;
  far.horizontal_deg.clear();
  for (int c = 0; c < 360; c += 15) far.horizontal_deg.push_back(c);
  for (int g = 0; g <= 90; ++g) far.vertical_deg.push_back(g);
  for (const double c : far.horizontal_deg)
    for (const double g : far.vertical_deg)
      far.candela.push_back(100 + 90 * std::cos(c * kPi / 45) * std::sin(g * kPi / 180));
  Scene scene;
  add_ground(scene, lambertian(Rgb::Constant(0.6f)), false, 3);
  const std::vector<PlacedLamp> lamps = {{shared({"", {}, far}), aimed_down({0, 1, 0}), 1}};
  const SceneCamera camera = camera_at({0, 8, 0.01f}, {0, 0, 0}, 0.5f);
  const auto reference = lamp_picture_by_force(scene, lamps, camera, kWidth, kHeight);
  auto renderer = renderer_of(scene);
  const PictureDifference off = difference(picture_of(renderer, lamps, camera), reference);
  EXPECT_LE(off.relative_rmse, 0.01);  // the reference is that of the pixels' middles
  EXPECT_NEAR(off.light, 1, 0.005);
}

TEST_F(LampPictures, SheetWithHolesCastsWhereItsBallHoldsTheLamp) {
  // Of such a mesh no more is known than the ball around it, and nothing else casts.
  Scene scene;
  Material sheet = lambertian(Rgb::Constant(0.5f));
  sheet.alpha_cutoff = 0.5f;
  sheet.double_sided = true;
  add_mesh(scene, {{-0.4f, 0.8f, 0.4f}, {0.4f, 0.8f, 0.4f}, {0.4f, 0.8f, -0.4f}, {-0.4f, 0.8f, -0.4f}},
           std::vector<Vec3f>(4, Vec3f::UnitY()), {0, 1, 2, 0, 2, 3}, sheet);
  add_ground(scene, lambertian(Rgb::Constant(0.6f)), false, 3);
  NearField lamp = patterned_lamp(2, 2, 0.02, 8);
  std::fill(lamp.intensity.values.begin(), lamp.intensity.values.end(), Rgb::Constant(10));
  const std::vector<PlacedLamp> lamps = {{shared({"", lamp, {}}), aimed_down({0, 1, 0}), 1}};
  // From below the sheet: what it shades, and all that the lamp reaches beside it.
  const SceneCamera camera = camera_at({0, 0.7f, 0.01f}, {0, 0, 0}, 1.8f);
  auto renderer = renderer_of(scene);
  const auto picture = picture_of(renderer, lamps, camera);
  for (std::size_t k = 0; k < picture.rgba.size(); ++k)
    if (k % 4 != 3) {
      ASSERT_EQ(picture.rgba[k], 0) << k;
    }
  ASSERT_TRUE(renderer.set_shadows(false).ok());
  EXPECT_GT(rgb(picture_of(renderer, lamps, camera), kWidth / 2, kHeight / 2)[0], 1);
}

TEST_F(LampPictures, NoLightGoesUnderWhatStandsOnTheGroundThatPassesTheLamp) {
  // Texels below the ground's horizon look under the box; at these heights look-ups take part of them.
  Scene scene;
  add_ground(scene, lambertian(Rgb::Constant(0.6f)), true, 4);
  add_box(scene, {-0.2f, 0, -0.2f}, {0.2f, 0.4f, 0.2f}, lambertian(Rgb::Constant(0.5f)));
  const SceneCamera camera = camera_at({0, 8, 0.01f}, {0, 0, 0}, 0.5f);
  auto renderer = renderer_of(scene);
  for (const Luminaire& lamp : {Luminaire{"", {}, uneven_far_field()}, lamp_of_rays()})
    for (const double height : {0.0005, 0.002, 0.005, 0.02}) {
      // Of the positions, one row is at that height and one is below the ground.
      const double up =
          lamp.near ? -lamp.near->intensity.planes.first_m.y() - lamp.near->intensity.planes.spacing_m : 0;
      Eigen::Isometry3d pose(Eigen::Translation3d(0.6, height + up, 0.6));
      pose.rotate(Eigen::AngleAxisd(kPi / 4, Vec3d::UnitY()));  // toward the box
      const std::vector<PlacedLamp> lamps = {{shared(lamp), pose, 1}};
      const auto reference = lamp_picture_by_force(scene, lamps, camera, kWidth, kHeight);
      ASSERT_TRUE(renderer.set_shadows(false).ok());
      const auto unshadowed = picture_of(renderer, lamps, camera);
      ASSERT_TRUE(renderer.set_shadows(true).ok());
      const auto picture = picture_of(renderer, lamps, camera);
      double through = 0, full = 0;
      const auto dark = [&](int x, int y) {
        return reference[static_cast<std::size_t>(y * kWidth + x)].maxCoeff() == 0;
      };
      // In the shadow, a pixel from its edge.
      for (int y = 1; y < kHeight - 1; ++y)
        for (int x = 1; x < kWidth - 1; ++x) {
          if (!dark(x, y) || !dark(x - 1, y) || !dark(x + 1, y) || !dark(x, y - 1) || !dark(x, y + 1))
            continue;
          through += static_cast<double>(rgb(picture, x, y)[0]);
          full += static_cast<double>(rgb(unshadowed, x, y)[0]);
        }
      EXPECT_GT(full, 0) << height;
      EXPECT_LE(through, 1e-3 * full) << height;
    }
}

TEST_F(LampPictures, LampInsideWhatStandsOnTheGroundShinesUnderNoneOfItsWalls) {
  Scene scene;
  add_ground(scene, lambertian(Rgb::Constant(0.6f)), true, 4);
  add_box(scene, {-0.2f, 0, -0.2f}, {0.2f, 0.4f, 0.2f}, lambertian(Rgb::Constant(0.5f)));
  auto renderer = renderer_of(scene);
  for (const double height : {0.02, 0.2, 0.39}) {
    // Along the bottom edges of two walls.
    const auto picture =
        picture_of(renderer, {{shared({"", {}, uneven_far_field()}), aimed_down({0, height, 0}), 1}},
                   camera_at({0.8f, 0.5f, 0.9f}, {0.1f, 0, 0.1f}, 0.5f));
    for (std::size_t k = 0; k < picture.rgba.size(); ++k)
      if (k % 4 != 3) {
        ASSERT_EQ(picture.rgba[k], 0) << k << " " << height;
      }
  }
}

TEST_F(LampPictures, MorePositionsThanADriverHoldsAreDrawnTogether) {
  const Scene scene = stage();
  const NearField lamp = patterned_lamp(17, 16, 0.01, 32);
  ASSERT_EQ(render::least_group(lamp), 2);
  const std::vector<PlacedLamp> lamps = {{shared({"", lamp, {}}), aimed_down({0, 1, 0}), 1}};
  const auto reference = lamp_picture_by_force(scene, lamps, stage_camera(), kWidth, kHeight);
  auto renderer = renderer_of(scene);
  const PictureDifference off = difference(picture_of(renderer, lamps, stage_camera()), reference);
  EXPECT_EQ(renderer.lamps().counts().sources, 72u);
  EXPECT_LE(off.relative_rmse, kMostError);
  EXPECT_NEAR(off.light, 1, 0.01);
}

TEST_F(LampPictures, ManyMapsAreSmallerThanFew) {
  const int limit = render::ShadowAtlas::side_limit();
  EXPECT_EQ(render::LampMaps::side_of(256, 1), 1024);
  EXPECT_EQ(render::LampMaps::side_of(256, 4), 512);
  EXPECT_EQ(render::LampMaps::side_of(256, 63), 256);
  for (const std::size_t maps : {64u, 256u, 1536u}) {
    const int side = render::LampMaps::side_of(1024, maps);
    EXPECT_GE(side, 16);
    EXPECT_LE(side * static_cast<int>(std::ceil(std::sqrt(maps))), limit) << maps;
  }
}

TEST_F(LampPictures, FewerPointsStayWithinTheErrorThatIsAsked) {
  // On its own floor the lamp's whole pattern counts: every point drawn against those that a bound leaves.
  const Scene scene = stage();
  const std::vector<PlacedLamp> lamps = {
      {shared({"", patterned_lamp(9, 7, 0.004, 32), {}}), aimed_down({0, 1.5, 0}), 1}};
  auto all = renderer_of(scene), fewer = renderer_of(scene, 0.03);
  const auto exact = picture_of(all, lamps, stage_camera());
  const auto together = picture_of(fewer, lamps, stage_camera());
  EXPECT_LT(fewer.lamps().counts().sources, all.lamps().counts().sources);
  double off = 0, sum = 0;
  for (std::size_t k = 0; k < exact.rgba.size(); ++k) {
    if (k % 4 == 3) continue;
    off += std::pow(static_cast<double>(exact.rgba[k] - together.rgba[k]), 2);
    sum += std::pow(static_cast<double>(exact.rgba[k]), 2);
  }
  EXPECT_LE(std::sqrt(off / sum), 0.03);
}

// 15 cm below a lamp 20 cm wide, far above the floor: a box, then a flag.
TEST_F(LampPictures, WhatHangsCloseBelowALampThrowsShadowsWithinTheErrorThatIsAsked) {
  const std::vector<PlacedLamp> lamps = {
      {shared({"", patterned_lamp(13, 13, 0.2 / 12, 128), {}}), aimed_down({0, 1.2, 0}), 1}};
  for (const bool flag : {false, true}) {
    Scene scene;
    add_ground(scene, lambertian(Rgb::Constant(0.6f)), true, 1.5f);
    add_box(scene, {0.5f, 0, -0.3f}, {0.8f, 0.2f, 0}, lambertian(Rgb::Constant(0.5f)));  // one more, far away
    if (flag)
      add_box(scene, {-0.05f, 1.04f, -0.05f}, {0.1f, 1.05f, 0.05f}, lambertian(Rgb::Constant(0.5f)));
    else
      add_box(scene, {-0.06f, 0.93f, -0.06f}, {0.06f, 1.05f, 0.06f}, lambertian(Rgb::Constant(0.5f)));
    auto all = renderer_of(scene);
    const auto exact = picture_of(all, lamps, stage_camera());
    for (const double bound : {0.05, 0.1, 0.15, 0.2}) {
      auto fewer = renderer_of(scene, bound);
      const auto together = picture_of(fewer, lamps, stage_camera());
      double off = 0, sum = 0;
      for (std::size_t k = 0; k < exact.rgba.size(); ++k) {
        if (k % 4 == 3) continue;
        off += std::pow(static_cast<double>(exact.rgba[k] - together.rgba[k]), 2);
        sum += std::pow(static_cast<double>(exact.rgba[k]), 2);
      }
      EXPECT_LE(std::sqrt(off / sum), bound) << flag;
    }
  }
}

}  // namespace
}  // namespace lightwell
