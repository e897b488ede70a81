// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// Pictures under a light field against the same in double precision, place by place.
#include <gtest/gtest.h>

#include <random>

#include "tests/support/analytic_fields.h"
#include "tests/support/field_reference.h"
#include "tests/unit/render/render_fixture.h"

namespace lightwell {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)

constexpr int kWidth = 24, kHeight = 16;

// Uneven in every harmonic, and everywhere bright enough for no surface to gather negative light.
LightField random_field(int degree, std::array<int, 3> size = {5, 4, 6}, double brightness = 1) {
  LightField field;
  field.grid = {size, Vec3d(-1, -1, -1), Vec3d(1, 1, 1)};
  field.degree = degree;
  field.radiance.resize(field.grid.points() * 3 * static_cast<std::size_t>(field.harmonics()));
  field.confidence.assign(field.grid.points(), 1.0f);
  std::mt19937 random(5);
  std::uniform_real_distribution<float> uniform(-1, 1);
  for (int k = 0; k < size[2]; ++k)
    for (int h = 0; h < field.harmonics(); ++h)
      for (int c = 0; c < 3; ++c)
        for (std::size_t i = 0; i < field.slab_points(); ++i)
          field.plane(k, h, c)[i] =
              static_cast<float>(brightness) * (h == 0 ? 20 + uniform(random) : uniform(random));
  return field;
}

Material phong(float exponent) {
  Material m = lambertian(Rgb(0.2f, 0.3f, 0.1f));
  m.specular = Rgb(0.5f, 0.3f, 0.4f);
  m.exponent = exponent;
  return m;
}

Material rough(float roughness, float metallic) {
  Material m;
  m.base_color = Rgb(0.8f, 0.5f, 0.3f);
  m.roughness = roughness;
  m.metallic = metallic;
  return m;
}

// A square through the origin with this normal, seen at a slant.
struct Slant {
  Vec3d normal;
  Scene scene;
  SceneCamera camera;

  Slant(const Vec3d& n, const Material& material, double side = 0.9, bool double_sided = false)
      : normal(n.normalized()) {
    const Vec3f u = normal.unitOrthogonal().cast<float>(), v = normal.cast<float>().cross(u);
    const auto half = static_cast<float>(side);
    Material m = material;
    m.double_sided = double_sided;
    add_mesh(scene, {-half * u - half * v, half * u - half * v, half * u + half * v, half * v - half * u}, {},
             {0, 1, 2, 0, 2, 3}, m, false);
    camera = camera_at(2 * normal.cast<float>() + 0.9f * u + 0.4f * v, {0, 0, 0}, 0.4f);
  }

  struct Seen {
    Vec3d place, to_eye;
  };
  [[nodiscard]] Seen at(int x, int y) const {
    const render::View view = make_view(camera, kWidth, kHeight);
    const float right = 2 * (static_cast<float>(x) + 0.5f) / kWidth - 1;
    const float up = 1 - 2 * (static_cast<float>(y) + 0.5f) / kHeight;
    const Vec3d ray = (view.forward + view.right * right + view.up * up).cast<double>();
    const Vec3d eye = view.eye.cast<double>();
    const Vec3d place = eye - ray * (normal.dot(eye) / normal.dot(ray));
    return {place, (eye - place).normalized()};
  }
};

class FieldPicture : public Rendering {
 protected:
  static render::RadiancePicture field_picture(const Scene& scene, const LightField& field,
                                               const SceneCamera& camera, const MainLights& lights = {},
                                               bool shadows = true, int width = kWidth, int height = kHeight,
                                               int samples = 1) {
    render::RendererOptions options;
    options.width = width;
    options.height = height;
    options.samples = samples;
    auto renderer = render::Renderer::create(scene, options);
    EXPECT_TRUE(renderer.ok()) << renderer.error().message;
    Status status = renderer->set_field(field, lights);
    EXPECT_TRUE(status.ok()) << status.error().message;
    EXPECT_TRUE(renderer->set_shadows(shadows).ok());
    status = renderer->render({}, camera);
    EXPECT_TRUE(status.ok()) << status.error().message;
    return renderer->radiance();
  }

  // Largest difference over pixels that show the square, relative to the brightest.
  static double worst(const Slant& slant, const LightField& field) {
    const auto p = field_picture(slant.scene, field, slant.camera);
    double most = 0, brightest = 0;
    int shown = 0;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        if (alpha(p, x, y) == 0) continue;
        ++shown;
        const auto [place, to_eye] = slant.at(x, y);
        const Vec3d inside = place.cwiseMax(field.grid.low).cwiseMin(field.grid.high);
        const Rgbd expected =
            returned(light_at(field, inside), field.degree, slant.scene.materials[0], slant.normal, to_eye);
        most = std::max(most, (rgb(p, x, y).cast<double>() - expected).abs().maxCoeff());
        brightest = std::max(brightest, expected.maxCoeff());
      }
    EXPECT_GT(shown, 60);
    return most / brightest;
  }
};

// Half floats of harmonics (2⁻¹¹ of the largest, averaged) and normals of 16 bits.
TEST_F(FieldPicture, DiffuseIsTheFieldsIrradianceForEveryDegree) {
  for (const int degree : {1, 2, 3, 4, 6, 8})
    for (const Vec3d& normal : {Vec3d(0, 1, 0), Vec3d(0.5, -0.3, 0.8), Vec3d(-0.7, 0.1, -0.2)}) {
      Material m = lambertian(Rgb(0.8f, 0.5f, 0.1f));
      EXPECT_LT(worst(Slant(normal, m), random_field(degree)), 6e-4) << degree;
    }
}

// And the table's interpolation, which the exact lobe of the reference does not have.
TEST_F(FieldPicture, PhongIsTheLobeOfItsExponent) {
  for (const int degree : {2, 4, 8})
    for (const float exponent : {0.5f, 1.0f, 3.7f, 12.0f, 80.0f, 4000.0f})
      EXPECT_LT(worst(Slant({0.5, -0.3, 0.8}, phong(exponent)), random_field(degree)), 1e-3)
          << degree << " " << exponent;
}

TEST_F(FieldPicture, MetallicRoughnessIsTheLobeOfItsRoughness) {
  for (const float roughness : {0.0f, 0.23f, 0.5f, 0.77f, 1.0f})
    for (const float metallic : {0.0f, 1.0f})
      EXPECT_LT(worst(Slant({0.5, -0.3, 0.8}, rough(roughness, metallic)), random_field(4)), 2e-3)
          << roughness << " " << metallic;
}

TEST_F(FieldPicture, BothModelsInOneSceneAreEachAsAlone) {
  const LightField field = random_field(4);
  const Slant one({0, 1, 0}, phong(9)), other({0, 1, 0}, rough(0.4f, 0.5f));
  for (const Slant* slant : {&one, &other}) {
    Slant both = *slant;
    Material far = slant == &one ? rough(0.9f, 0) : phong(30);
    add_ground(both.scene, far, false, 0.1f, -50);
    const auto alone = field_picture(slant->scene, field, slant->camera);
    const auto together = field_picture(both.scene, field, slant->camera);
    for (int x = 8; x < 16; ++x) expect_near(rgb(together, x, 8), rgb(alone, x, 8), 1e-5f);
  }
}

// 0⁰ is 1: the specular part is then a diffuse one.
TEST_F(FieldPicture, AnExponentOfNoughtIsDiffuse) {
  const LightField field = random_field(4);
  Material m = phong(0);
  const Slant slant({0.2, 1, 0.1}, m);
  const auto p = field_picture(slant.scene, field, slant.camera);
  m.base_color += m.specular;
  m.specular = Rgb::Zero();
  const Slant matt({0.2, 1, 0.1}, m);
  const auto expected = field_picture(matt.scene, field, matt.camera);
  for (int x = 8; x < 16; ++x) expect_near(rgb(p, x, 8), rgb(expected, x, 8), 1e-4f);
}

// A texture of 256 points a side, and numbers that half floats alone would not hold.
TEST_F(FieldPicture, LongGridsAndExtremeLightKeepTheirDigits) {
  const Slant slant({0.5, -0.3, 0.8}, lambertian(Rgb::Constant(0.5f)));
  EXPECT_LT(worst(slant, random_field(2, {256, 2, 3})), 6e-4);
  for (const double brightness : {1e-9, 1e8})
    EXPECT_LT(worst(slant, random_field(4, {5, 4, 6}, brightness)), 6e-4) << brightness;
}

TEST_F(FieldPicture, BeyondTheBoundsTheLightIsThatOfTheBorder) {
  LightField field = random_field(2);
  field.grid.low = Vec3d(-0.2, -0.2, -0.2);
  field.grid.high = Vec3d(0.1, 0.3, 0.2);
  EXPECT_LT(worst(Slant({0.5, -0.3, 0.8}, lambertian(Rgb::Constant(0.5f))), field), 6e-4);
}

// Light from one side only rings below nought behind: no pixel is negative, and emission stays whole.
TEST_F(FieldPicture, RingingIsNoNegativeLightAndEmissionIsAdded) {
  LightField field = random_field(4);
  std::vector<double> y(25);
  harmonics(Vec3d::UnitY(), 4, y.data());
  for (int k = 0; k < 6; ++k)
    for (int h = 0; h < 25; ++h)
      for (int c = 0; c < 3; ++c)
        std::fill_n(field.plane(k, h, c), field.slab_points(),
                    static_cast<float>(100 * y[static_cast<std::size_t>(h)]));
  Material m = phong(20);
  const Slant away({0.1, -1, 0}, m);
  const auto dark = field_picture(away.scene, field, away.camera);
  EXPECT_GE(*std::min_element(dark.rgba.begin(), dark.rgba.end()), 0);
  m.emission = Rgb(1000, 2000, 3000);
  const Slant lamp({0, 1, 0}, m), unlit({0, 1, 0}, phong(20));
  const auto with = field_picture(lamp.scene, field, lamp.camera);
  const auto without = field_picture(unlit.scene, field, unlit.camera);
  expect_near(rgb(with, 12, 8), rgb(without, 12, 8) + m.emission, 1e-5f);
}

TEST_F(FieldPicture, SamplesAreAveragedAndTheBackgroundStaysEmpty) {
  const LightField field = random_field(2);
  const Slant slant({0, 1, 0}, lambertian(Rgb::Constant(0.5f)), 0.3);
  const auto one = field_picture(slant.scene, field, slant.camera);
  const auto many = field_picture(slant.scene, field, slant.camera, {}, true, kWidth, kHeight, 4);
  expect_near(rgb(many, 12, 8), rgb(one, 12, 8), 2e-2f);
  EXPECT_EQ(alpha(many, 0, 0), 0);
  EXPECT_EQ(rgb(many, 0, 0).maxCoeff(), 0);
}

// The whole way from light that is known everywhere to a picture: two lamps above the unit cube, over a sphere in its middle,
// every normal that a camera sees of it. The bands that irradiance leaves out are what is missing: 2.8 % with nine
// coefficients alone.
TEST_F(FieldPicture, DiffuseSurfacesUnderLampsAreAsCloseToTheIntegralAsTheDegreeAllows) {
  constexpr int kSide = 9, kDirections = 3072;
  const SpherePartition sphere(kDirections);
  Scene scene;
  add_sphere(scene, {0.5f, 0.5f, 0.5f}, 0.3f, lambertian(Rgb::Constant(1)), false);
  const SceneCamera camera = camera_at({1.2f, 1.4f, 1.6f}, {0.5f, 0.5f, 0.5f}, 0.4f);
  const render::View view = make_view(camera, kWidth, kHeight);
  const Vec3d middle = Vec3d::Constant(0.5);
  const auto error_of = [&](int degree) {
    LightField field;
    field.grid = {{kSide, kSide, kSide}, Vec3d::Zero(), Vec3d::Ones()};
    field.degree = degree;
    field.radiance.resize(field.grid.points() * 3 * static_cast<std::size_t>(field.harmonics()));
    field.confidence.assign(field.grid.points(), 1.0f);
    for (int k = 0; k < kSide; ++k)
      for (int j = 0; j < kSide; ++j)
        for (int i = 0; i < kSide; ++i) {
          const auto exact = exact_harmonics(box_of_lamps, field.grid.position(i, j, k), degree, kDirections);
          for (int h = 0; h < field.harmonics(); ++h)
            for (int c = 0; c < 3; ++c) field.plane(k, h, c)[j * kSide + i] = static_cast<float>(exact(h, c));
        }
    const auto p = field_picture(scene, field, camera);
    double squares = 0, error = 0;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        if (alpha(p, x, y) == 0) continue;
        const Vec3d ray = (view.forward + view.right * (2 * (static_cast<float>(x) + 0.5f) / kWidth - 1) +
                           view.up * (1 - 2 * (static_cast<float>(y) + 0.5f) / kHeight))
                              .cast<double>()
                              .normalized();
        const Vec3d from = view.eye.cast<double>() - middle;
        const double along = -from.dot(ray), inside = along * along - from.squaredNorm() + 0.09;
        if (inside < 0.004) continue;  // the mesh's own edge
        const Vec3d normal = (from + ray * (along - std::sqrt(inside))) / 0.3;
        Rgbd exact = Rgbd::Zero();
        for (int d = 0; d < kDirections; ++d)
          exact += box_of_lamps(middle + 0.3 * normal, sphere.centre(d)) *
                   (sphere.cell_solid_angle_sr() / kPi * std::max(0.0, normal.dot(sphere.centre(d))));
        squares += exact.square().sum();
        error += (rgb(p, x, y).cast<double>() - exact).square().sum();
      }
    const double relative = std::sqrt(error / squares);
    std::printf("diffuse sphere under two lamps, degree %d: relative RMSE %.4f\n", degree, relative);
    return relative;
  };
  EXPECT_LT(error_of(2), 0.04);
  EXPECT_LT(error_of(4), 0.015);
  EXPECT_LT(error_of(6), 0.01);
}

}  // namespace
}  // namespace lightwell
