// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// A field's light and the shadows of its main lights against exact visibility: two spotlights of six degrees, each with a
// soft edge on the stage, and a dim sky, over a ball and a box.
#include <gtest/gtest.h>

#include <cstdio>
#include <optional>

#include "bench/pictures/ray_tracer.h"
#include "render/egl_context.h"
#include "render/renderer.h"
#include "tests/support/analytic_fields.h"
#include "tests/support/test_scene.h"

namespace lightwell {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)

constexpr int kWidth = 96, kHeight = 72;
constexpr double kSpreadRad = 3 * kPi / 180;

// Parallel light of a disc on a part of the stage: what a projector's lens far away gives.
struct Spot {
  Vec3d direction;  // toward it
  Vec3d aim;        // the middle of its circle
  double radius = 0;
  double lux = 0;

  [[nodiscard]] double at(const Vec3d& place) const {
    const Vec3d off = place - aim;
    return lux * soft_step(radius - (off - direction * direction.dot(off)).norm(), 0.4);
  }
  // Evenly over its disc (Vogel 1979).
  [[nodiscard]] Vec3d part(int i, int count) const {
    const Vec3d u = direction.unitOrthogonal(), v = direction.cross(u);
    const double r = std::tan(kSpreadRad) * std::sqrt((i + 0.5) / count),
                 around = i * kPi * (3 - std::sqrt(5.0));
    return (direction + r * (std::cos(around) * u + std::sin(around) * v)).normalized();
  }
};

const std::vector<Spot>& spots() {
  static const std::vector<Spot> all = {{Vec3d(0.5, 0.8, 0.3).normalized(), {-0.3, 0, 0}, 1.0, 300},
                                        {Vec3d(-0.7, 0.6, 0.1).normalized(), {0.4, 0, 0.2}, 0.8, 200}};
  return all;
}
constexpr double kSky = 6;  // cd/m² from everywhere above
constexpr int kParts = 48, kSkyParts = 200;

LightField field_of(int side, int degree) {
  LightField field;
  field.grid = {{side, side / 2, side}, Vec3d(-2, 0, -2), Vec3d(2, 1.2, 2)};
  field.degree = degree;
  field.radiance.assign(field.grid.points() * 3 * static_cast<std::size_t>(field.harmonics()), 0.0f);
  field.confidence.assign(field.grid.points(), 1.0f);
  Eigen::VectorXd sky = Eigen::VectorXd::Zero(field.harmonics()), y(field.harmonics());
  const SpherePartition sphere(3072);
  for (int i = 0; i < 3072; ++i)
    if (sphere.centre(i).y() > 0) {
      harmonics(sphere.centre(i), degree, y.data());
      sky += kSky * sphere.cell_solid_angle_sr() * y;
    }
  for (int k = 0; k < side; ++k)
    for (int j = 0; j < side / 2; ++j)
      for (int i = 0; i < side; ++i) {
        Eigen::VectorXd light = sky;
        for (const Spot& spot : spots())
          for (int part = 0; part < kParts; ++part) {
            harmonics(spot.part(part, kParts), degree, y.data());
            light += spot.at(field.grid.position(i, j, k)) / kParts * y;
          }
        for (int h = 0; h < field.harmonics(); ++h)
          for (int c = 0; c < 3; ++c) field.plane(k, h, c)[j * side + i] = static_cast<float>(light[h]);
      }
  return field;
}

class FieldTruth : public ::testing::Test {
 protected:
  void SetUp() override {
    auto context = render::EglContext::create();
    if (!context) GTEST_SKIP() << context.error().message;
    context_.emplace(std::move(context).value());
    add_ground(scene_, lambertian(Rgb::Constant(0.5f)), false, 2);
    add_sphere(scene_, {-0.3f, 0.4f, 0.1f}, 0.35f, lambertian(Rgb::Constant(0.6f)));
    add_box(scene_, {0.35f, 0, -0.3f}, {0.7f, 0.6f, 0.1f}, lambertian(Rgb::Constant(0.6f)));
  }

  // Radiance of the ground's pixels with exact visibility; below 0 where another thing is seen.
  [[nodiscard]] std::vector<double> truth() const {
    std::vector<DirectionalLight> lights;
    const auto add = [&](const Vec3d& direction, double lux) {
      DirectionalLight light;
      light.direction = direction.cast<float>();
      light.illuminance = Rgb::Constant(static_cast<float>(lux));
      lights.push_back(light);
    };
    for (const Spot& spot : spots())
      for (int i = 0; i < kParts; ++i) add(spot.part(i, kParts), 1);
    for (int i = 0; i < kSkyParts; ++i) {
      const double up = (i + 0.5) / kSkyParts, around = i * kPi * (3 - std::sqrt(5.0));
      const double across = std::sqrt(1 - up * up);
      add(Vec3d(across * std::cos(around), up, across * std::sin(around)), 1);
    }
    const auto tracer = pictures::RayTracer::create(scene_);
    EXPECT_TRUE(tracer.ok());
    const auto returned = tracer->transport(camera_, kWidth, kHeight, lights);
    const auto shown = tracer->primitives(camera_, kWidth, kHeight);
    const render::View view = make_view(camera_, kWidth, kHeight);
    const Vec3d eye = view.eye.cast<double>();
    std::vector<double> radiance(shown.size(), -1);
    for (std::size_t p = 0; p < shown.size(); ++p) {
      if (shown[p] != 0) continue;
      const auto x = static_cast<float>(p % kWidth), y = static_cast<float>(p / kWidth);
      const Vec3d ray = (view.forward + view.right * (2 * (x + 0.5f) / kWidth - 1) +
                         view.up * (1 - 2 * (y + 0.5f) / kHeight))
                            .cast<double>();
      const Vec3d place = eye - ray * (eye.y() / ray.y());
      double sum = 0;
      for (std::size_t i = 0; i < lights.size(); ++i) {
        const std::size_t spot = i / kParts;
        const double lux =
            spot < spots().size() ? spots()[spot].at(place) / kParts : kSky * 2 * kPi / kSkyParts;
        sum += lux * static_cast<double>(returned[p * lights.size() + i]);
      }
      radiance[p] = sum;
    }
    return radiance;
  }

  double relative_rmse(const LightField& field, int main_lights, const std::vector<double>& exact) const {
    render::RendererOptions options;
    options.width = kWidth;
    options.height = kHeight;
    options.shadow_size = 512;
    auto renderer = render::Renderer::create(scene_, options);
    EXPECT_TRUE(renderer.ok());
    EXPECT_TRUE(
        renderer->set_field(field, find_main_lights(field, main_lights, {-1, 0, -1}, {1, 1, 1})).ok());
    EXPECT_TRUE(renderer->render({}, camera_).ok());
    const auto picture = renderer->radiance();
    double error = 0, squares = 0;
    for (std::size_t p = 0; p < exact.size(); ++p) {
      if (exact[p] < 0) continue;
      error += std::pow(static_cast<double>(picture.rgba[4 * p]) - exact[p], 2);
      squares += exact[p] * exact[p];
    }
    return std::sqrt(error / squares);
  }

  std::optional<render::EglContext> context_;
  render::Scene scene_;
  render::SceneCamera camera_ = camera_at({0.2f, 3.2f, 2.6f}, {0, 0, 0}, 0.6f);
};

// Without shadows the ground keeps the light that ball and box take from it. With them, what is left are the penumbras, the
// sky that they hide, and the degree.
TEST_F(FieldTruth, ShadowsOfMainLightsTakeMostOfTheError) {
  const auto exact = truth();
  const LightField field = field_of(24, 4);
  const double without = relative_rmse(field, 0, exact), with = relative_rmse(field, 2, exact),
               more = relative_rmse(field, 4, exact);
  std::printf("ground under two spots, relative RMSE: no shadows %.3f, two main lights %.3f, four %.3f\n",
              without, with, more);
  EXPECT_LT(with, without / 3);
  EXPECT_LT(with, 0.12);
  EXPECT_LT(more, 1.2 * with);
}

}  // namespace
}  // namespace lightwell
