// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// A field's main lights and what stands before them.
#include <gtest/gtest.h>

#include "tests/support/field_reference.h"
#include "tests/unit/render/render_fixture.h"

namespace lightwell {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)

const Vec3d kToLamp = Vec3d(0.6, 0.8, 0);
const Rgbd kSky(1, 2, 3);

// A beam whose light grows toward +Z, and even light from everywhere.
double beam_lux(double z) {
  return 50 + 20 * z;
}

LightField beam_and_sky(int degree = 4) {
  LightField field;
  field.grid = {{2, 2, 9}, Vec3d(-4, -1, -4), Vec3d(4, 3, 4)};
  field.degree = degree;
  field.radiance.assign(field.grid.points() * 3 * static_cast<std::size_t>(field.harmonics()), 0.0f);
  field.confidence.assign(field.grid.points(), 1.0f);
  std::vector<double> y(static_cast<std::size_t>(field.harmonics()));
  harmonics(kToLamp, degree, y.data());
  for (int k = 0; k < 9; ++k)
    for (int h = 0; h < field.harmonics(); ++h)
      for (int c = 0; c < 3; ++c) {
        const double lux = beam_lux(field.grid.position(0, 0, k).z());
        const double sky = h == 0 ? std::sqrt(4 * kPi) * kSky[c] : 0;
        std::fill_n(field.plane(k, h, c), field.slab_points(),
                    static_cast<float>(sky + lux * y[static_cast<std::size_t>(h)]));
      }
  return field;
}

MainLights lamps_of(const LightField& field, int count) {
  return find_main_lights(field, count, field.grid.low, field.grid.high);
}

class FieldShadow : public Rendering {
 protected:
  // A board over the ground, which it shades from the lamp.
  static Scene board_over_ground(const Material& ground) {
    Scene scene;
    add_ground(scene, ground, false);
    add_box(scene, {-0.3f, 0.9f, -2}, {0.3f, 1.0f, 2}, lambertian(Rgb::Constant(0.5f)));
    return scene;
  }
  static render::RadiancePicture picture_of(const Scene& scene, const MainLights& lights, int size = 256,
                                            bool shadows = true) {
    render::RendererOptions options;
    options.width = 64;
    options.height = 48;
    options.shadow_size = size;
    auto renderer = render::Renderer::create(scene, options);
    EXPECT_TRUE(renderer.ok()) << renderer.error().message;
    EXPECT_TRUE(renderer->set_field(beam_and_sky(), lights).ok());
    EXPECT_TRUE(renderer->set_shadows(shadows).ok());
    EXPECT_TRUE(renderer->render({}, camera_at({0, 5, 2}, {-0.5f, 0, 0})).ok());
    return renderer->radiance();
  }

  // To the rounding of coordinates, for the textures have other sizes.
  static void expect_same(const render::RadiancePicture& a, const render::RadiancePicture& b) {
    for (int y = 0; y < 48; ++y)
      for (int x = 0; x < 64; ++x) expect_near(rgb(a, x, y), rgb(b, x, y), 2e-5f);
  }

  static Vec3d on_ground(int x, int y) {
    const render::View view = make_view(camera_at({0, 5, 2}, {-0.5f, 0, 0}), 64, 48);
    const Vec3d ray = (view.forward + view.right * (2 * (static_cast<float>(x) + 0.5f) / 64 - 1) +
                       view.up * (1 - 2 * (static_cast<float>(y) + 0.5f) / 48))
                          .cast<double>();
    const Vec3d eye = view.eye.cast<double>();
    return eye - ray * (eye.y() / ray.y());
  }
  // Where the ray to the lamp passes the board's height, and whether the eye's does.
  enum class Sees { lamp, board, edge };
  static Sees seen_from(const Vec3d& p, const Vec3d& toward) {
    bool low = false, high = false;
    for (const double height : {0.9, 1.0}) {
      const Vec3d at = p + toward * (height / toward.y());
      const double out = std::max(std::abs(at.x()) - 0.3, std::abs(at.z()) - 2);
      if (out < 0.05) low = true;
      if (out < -0.05) high = true;
    }
    return high ? Sees::board : low ? Sees::edge : Sees::lamp;
  }
};

// Diffuse and glossy alike: lit ground has the numbers of a picture without shadows, to their rounding; shaded ground those of the field
// without the lamp, as double precision has them.
TEST_F(FieldShadow, LightIsTakenAwayWhereItIsBlockedAndNothingElseChanges) {
  Material glossy = lambertian(Rgb(0.5f, 0.4f, 0.3f));
  glossy.specular = Rgb::Constant(0.4f);
  glossy.exponent = 5;
  Material metal;
  metal.roughness = 0.6f;
  metal.metallic = 0.3f;
  const LightField field = beam_and_sky();
  const MainLights lights = lamps_of(field, 4);
  ASSERT_EQ(lights.directions.size(), 1u);
  for (const Material& ground : {lambertian(Rgb(0.8f, 0.5f, 0.2f)), glossy, metal}) {
    const Scene scene = board_over_ground(ground);
    const auto with = picture_of(scene, lights), without = picture_of(scene, {});
    LightAtPoint sky;
    sky.radiance = Eigen::ArrayX3d::Zero(25, 3);
    sky.radiance.row(0) = std::sqrt(4 * kPi) * kSky.transpose();
    int lit = 0, dark = 0;
    for (int y = 0; y < 48; ++y)
      for (int x = 0; x < 64; ++x) {
        const Vec3d place = on_ground(x, y);
        const Vec3d to_eye = (Vec3d(0, 5, 2) - place).normalized();
        if (place.cwiseAbs().maxCoeff() > 4 || seen_from(place, to_eye) != Sees::lamp) continue;
        if (seen_from(place, kToLamp) == Sees::lamp) {
          expect_near(rgb(with, x, y), rgb(without, x, y), 2e-5f);
          ++lit;
        } else if (seen_from(place, kToLamp) == Sees::board) {
          const Rgbd expected = returned(sky, 4, ground, Vec3d::UnitY(), to_eye);
          // Half floats, of which the light that was there has no fewer: 1e-3 of what is taken away.
          const double allowed = 1e-3 * (rgb(without, x, y).cast<double>() - expected).abs().maxCoeff();
          EXPECT_LT((rgb(with, x, y).cast<double>() - expected).abs().maxCoeff(), 1e-3 + 2 * allowed)
              << x << " " << y;
          ++dark;
        }
      }
    EXPECT_GT(lit, 800);
    EXPECT_GT(dark, 60);
  }
}

TEST_F(FieldShadow, WithoutShadowsOrCastersMainLightsChangeNothing) {
  const LightField field = beam_and_sky();
  const MainLights lights = lamps_of(field, 4);
  const Scene scene = board_over_ground(lambertian(Rgb::Constant(0.5f)));
  expect_same(picture_of(scene, lights, 256, false), picture_of(scene, {}));
  Scene open;
  add_ground(open, lambertian(Rgb::Constant(0.5f)), false);
  expect_same(picture_of(open, lights), picture_of(open, {}));
}

// Eight lights of the largest maps do not fit on one page: the picture is the same as with small ones but for its edges.
TEST_F(FieldShadow, LightsOnSeveralPagesOfMapsAreAllTakenAway) {
  const LightField field = beam_and_sky();
  MainLights lights = lamps_of(field, 1);
  const std::vector<float> whole = lights.illuminance;
  const Vec3d direction = lights.directions[0];
  lights = {};
  for (int i = 0; i < 8; ++i) {
    lights.directions.push_back((direction + 1e-3 * Vec3d(0, 0, i)).normalized());
    for (const float lux : whole) lights.illuminance.push_back(lux / 8);
  }
  const Scene scene = board_over_ground(lambertian(Rgb::Constant(0.5f)));
  const auto small = picture_of(scene, lights, 256), large = picture_of(scene, lights, 2048);
  int compared = 0;
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 64; ++x) {
      const Vec3d place = on_ground(x, y);
      if (place.cwiseAbs().maxCoeff() > 4 || seen_from(place, kToLamp) == Sees::edge ||
          seen_from(place, (Vec3d(0, 5, 2) - place).normalized()) != Sees::lamp)
        continue;
      expect_near(rgb(large, x, y), rgb(small, x, y), 1e-3f);
      ++compared;
    }
  EXPECT_GT(compared, 1000);
}

}  // namespace
}  // namespace lightwell
