// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "bench/pictures/judged_lights.h"
#include "bench/pictures/judged_scenes.h"
#include "bench/pictures/picture_error.h"
#include "bench/pictures/ray_tracer.h"
#include "interface/atomic_file.h"
#include "render/gltf_scene.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_scene.h"

namespace lightwell::pictures {
namespace {

using test::light_set;

Rgb pixel(const render::RadiancePicture& p, int x, int y) {
  const float* at = &p.rgba[4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(p.width) +
                                 static_cast<std::size_t>(x))];
  return {at[0], at[1], at[2]};
}

Rgbd sum_of(const std::vector<DirectionalLight>& lights) {
  Rgbd sum = Rgbd::Zero();
  for (const DirectionalLight& light : lights) sum += light.illuminance.cast<double>();
  return sum;
}

TEST(ExactLights, SumToTheImageAndNoneCarriesMoreThanItsShare) {
  for (const JudgedScene& judged : judged_scenes()) {
    const LatLongImage image = judged.light();
    const std::vector<DirectionalLight> lights = exact_lights(image, 1.0 / 64);
    Rgbd expected = Rgbd::Zero();
    for (int y = 0; y < image.height / 2; ++y)
      for (int x = 0; x < image.width; ++x)
        expected += image.pixel_solid_angle_sr(y) * image.at(x, y).cast<double>();
    const Rgbd sum = sum_of(lights);
    // Up to 3e4 lights, each rounded to a float.
    EXPECT_LT(((sum - expected) / expected).abs().maxCoeff(), 1e-6) << judged.name;
    for (const DirectionalLight& light : lights) {
      // The parts of a pixel differ by what a pixel's height changes a ring's circumference.
      ASSERT_LE(static_cast<double>(luminance(light.illuminance)), luminance(expected) / 64 * 1.05);
      ASSERT_NEAR(light.direction.norm(), 1, 1e-6);
      ASSERT_GT(light.direction.y(), 0);
    }
  }
}

TEST(ExactLights, OfABlackImageAreNone) {
  EXPECT_TRUE(exact_lights(LatLongImage{8, 4, std::vector<Rgb>(32, Rgb::Zero())}).empty());
}

TEST(JudgedLights, TheSunsBeamIsSixTimesTheSkysHorizontalIlluminance) {
  double beam = 0;
  double sky = 0;
  for (const DirectionalLight& light : exact_lights(sun_light())) {
    const bool is_sun = light.direction.dot(Vec3f(0.5693f, 0.6691f, -0.4777f)) > std::cos(2.5 * kPi / 180);
    const auto illuminance = static_cast<double>(luminance(light.illuminance));
    (is_sun ? beam : sky) += is_sun ? illuminance : illuminance * static_cast<double>(light.direction.y());
  }
  // What real clear skies have is 4 to 9.
  EXPECT_GT(beam / sky, 5);
  EXPECT_LT(beam / sky, 7);
}

TEST(JudgedScenes, EveryObjectIsClosedAndItsTrianglesFaceOutward) {
  const test::TemporaryFolder folder;
  for (const JudgedScene& judged : judged_scenes()) {
    const auto file = folder.path() / "scene.gltf";
    ASSERT_TRUE(write_file_atomically(file, judged.gltf()));
    const auto scene = render::read_gltf(file);
    ASSERT_TRUE(scene.ok()) << scene.error().message;
    EXPECT_EQ(scene->dropped_triangles, 0u) << judged.name;
    EXPECT_EQ(scene->cameras.at(0).name, judged.name);
    for (const render::Primitive& p : scene->primitives) {
      if (!p.casts_shadow) continue;  // the ground
      double volume = 0;
      double agree = 0;
      for (std::uint32_t i = 0; i < p.index_count; i += 3) {
        const auto corner = [&](std::uint32_t k) {
          return scene->vertices[scene->indices[p.first_index + i + k]];
        };
        const Vec3f a = corner(0).position, b = corner(1).position, c = corner(2).position;
        volume += static_cast<double>(a.dot(b.cross(c))) / 6;
        const Vec3f face = (b - a).cross(c - a);
        for (std::uint32_t k = 0; k < 3; ++k) agree += face.dot(corner(k).normal) > 0 ? 1 : 0;
      }
      EXPECT_GT(volume, 0) << judged.name;
      EXPECT_EQ(agree, p.index_count) << judged.name << ": normals point as the triangles face";
    }
  }
}

TEST(RayTracer, AGroundUnderTwoLightsReturnsTheirSumAndABoxTakesOneAway) {
  test::Scene scene;
  test::add_ground(scene, test::lambertian(Rgb(0.3f, 0.4f, 0.5f)));
  test::add_box(scene, {-0.5f, 0.2f, -0.5f}, {0.5f, 0.4f, 0.5f}, test::lambertian(Rgb::Ones()));
  const auto tracer = RayTracer::create(scene);
  ASSERT_TRUE(tracer.ok());
  const LightSet lights =
      light_set({{Vec3f::UnitY(), Rgb::Constant(100)}, {Vec3f(1, 1, 0), Rgb(30, 20, 10)}});
  // Looks at the ground from the side: the left edge of the picture is clear of the box, pixel (42, 32) is under its
  // right edge.
  const auto camera = test::camera_at({0, 0.1f, 3}, {0, 0.0f, 0}, 0.9f);
  const auto picture = tracer->picture(camera, 65, 65, lights.lights);
  const Rgb albedo(0.3f, 0.4f, 0.5f);
  const Rgb open =
      albedo / static_cast<float>(kPi) * (Rgb::Constant(100) + Rgb(30, 20, 10) * std::sqrt(0.5f));
  const Rgb under = albedo / static_cast<float>(kPi) * Rgb(30, 20, 10) * std::sqrt(0.5f);
  EXPECT_LT(((pixel(picture, 2, 40) - open) / open).abs().maxCoeff(), 1e-5f);  // float
  EXPECT_LT(((pixel(picture, 42, 32) - under) / under).abs().maxCoeff(),
            1e-5f)  // the slanting light comes in
      << pixel(picture, 42, 32).transpose();
}

TEST(RayTracer, NormalisedPhongReflectsItsAlbedoOfAUniformSkyInTheMirrorDirection) {
  // Straight down on the lobe: ∫ (n+2)/(2π) cosⁿθ · cosθ dω = 1.
  for (const float exponent : {8.0f, 40.0f, 200.0f}) {
    test::Scene scene;
    test::Material shiny = test::lambertian(Rgb::Zero());
    shiny.specular = Rgb(0.2f, 0.4f, 0.6f);
    shiny.exponent = exponent;
    test::add_ground(scene, shiny);
    const auto tracer = RayTracer::create(scene);
    ASSERT_TRUE(tracer.ok());
    const LatLongImage sky{512, 256, std::vector<Rgb>(512 * 256, Rgb::Constant(7))};
    const auto picture =
        tracer->picture(test::camera_at({0, 3, 0}, {0, 0, 0}), 1, 1, exact_lights(sky, 1e-6));
    // Lights a sixth of a degree apart against a lobe of 8 degrees (exponent 200): the midpoint rule's 1e-3 at most.
    EXPECT_LT(((pixel(picture, 0, 0) - 7 * shiny.specular) / (7 * shiny.specular)).abs().maxCoeff(), 1e-3f)
        << exponent;
  }
}

TEST(PictureError, OfAPictureBrighterByATenthIsATenth) {
  render::RadiancePicture picture{8, 6, {}};
  for (int i = 0; i < 48; ++i)
    picture.rgba.insert(picture.rgba.end(), {1.0f + static_cast<float>(i), 2, 3, 1});
  const Reference reference = reference_of(picture);
  std::vector<Rgb> brighter = colours_of(picture);
  for (Rgb& c : brighter) c *= 1.1f;
  const PictureError error = picture_error(brighter, reference);
  EXPECT_NEAR(error.relative_rmse, 0.1, 1e-6);  // float
  EXPECT_NEAR(error.bias, 0.1, 1e-6);
  EXPECT_GT(error.flip, 0.01);
  EXPECT_EQ(picture_error(reference.radiance, reference).flip, 0);
}

TEST(PictureError, WhatTheMaskLeavesOutDoesNotCount) {
  render::RadiancePicture picture{9, 9, std::vector<float>(9 * 9 * 4, 1.0f)};
  picture.rgba[4 * (4 * 9 + 8) + 3] = 0;  // no surface at the right border
  Reference reference = reference_of(picture);
  EXPECT_EQ(std::count(reference.mask.begin(), reference.mask.end(), 1), 7 * 7 - 3);
  EXPECT_EQ(reference.mask[4 * 9 + 7], 0);
  std::vector<Rgb> other = reference.radiance;
  other[0] = Rgb::Constant(1e6f);  // a corner
  const PictureError error = picture_error(other, reference);
  EXPECT_EQ(error.relative_rmse, 0);
  EXPECT_EQ(error.bias, 0);
}

TEST(ReferenceFile, ComesBackToAHalfsPrecisionWithItsMask) {
  const test::TemporaryFolder folder;
  render::RadiancePicture picture{5, 4, {}};
  for (int i = 0; i < 20; ++i)
    picture.rgba.insert(picture.rgba.end(),
                        {std::exp(static_cast<float>(i - 10)), 1.0f / 3, 1000, i == 19 ? 0.0f : 1.0f});
  const Reference written = reference_of(picture);
  ASSERT_TRUE(write_reference(folder.path() / "r.exr", written));
  const auto read = read_reference(folder.path() / "r.exr");
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_EQ(read->mask, written.mask);
  for (std::size_t i = 0; i < written.radiance.size(); ++i)  // half: 11 bits
    EXPECT_LT(((read->radiance[i] - written.radiance[i]) / written.radiance[i]).abs().maxCoeff(), 0.0005f);
  const auto missing = read_reference(folder.path() / "none.exr");
  EXPECT_FALSE(missing.ok());
}

}  // namespace
}  // namespace lightwell::pictures
