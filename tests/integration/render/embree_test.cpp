// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <embree3/rtcore.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <cstring>

#include "render/egl_context.h"
#include "render/gltf_scene.h"
#include "render/renderer.h"
#include "tests/support/test_scene.h"

namespace lightwell {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)

// Exact visibility of the same triangles under the same lights at the same pixel centres: what differs is the
// maps'.
class ExactVisibility {
 public:
  explicit ExactVisibility(const Scene& scene) : scene_(scene) {
    for (const bool casters_only : {false, true}) {
      RTCScene& target = casters_only ? casters_ : all_;
      target = rtcNewScene(device_);
      RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
      auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
          geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, scene.vertices.size()));
      for (std::size_t i = 0; i < scene.vertices.size(); ++i)
        std::memcpy(vertices + 3 * i, scene.vertices[i].position.data(), 12);
      std::vector<std::uint32_t> indices;
      for (const auto& p : scene.primitives)
        if (p.casts_shadow || !casters_only)
          indices.insert(indices.end(), scene.indices.begin() + p.first_index,
                         scene.indices.begin() + p.first_index + p.index_count);
      std::memcpy(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12,
                                          indices.size() / 3),
                  indices.data(), indices.size() * 4);
      rtcCommitGeometry(geometry);
      rtcAttachGeometry(target, geometry);
      rtcReleaseGeometry(geometry);
      rtcCommitScene(target);
    }
  }
  ~ExactVisibility() {
    rtcReleaseScene(all_);
    rtcReleaseScene(casters_);
    rtcReleaseDevice(device_);
  }
  ExactVisibility(const ExactVisibility&) = delete;
  ExactVisibility& operator=(const ExactVisibility&) = delete;

  // Radiance along a ray from the eye; Lambertian.
  [[nodiscard]] Rgb radiance(const Vec3f& eye, const Vec3f& ray, const LightSet& lights) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRayHit hit{};
    set(hit.ray, eye, ray);
    hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(all_, &context, &hit);
    if (hit.hit.geomID == RTC_INVALID_GEOMETRY_ID) return Rgb::Zero();
    const std::size_t t = std::size_t{hit.hit.primID} * 3;
    const auto& [a, b, c] = std::tie(corner(t), corner(t + 1), corner(t + 2));
    const float u = hit.hit.u;
    const float v = hit.hit.v;
    const Vec3f normal = ((1 - u - v) * a.normal + u * b.normal + v * c.normal).normalized();
    const Vec3f face = (b.position - a.position).cross(c.position - a.position).normalized();
    const Vec3f point = (1 - u - v) * a.position + u * b.position + v * c.position + 1e-4f * face;
    Rgb sum = Rgb::Zero();
    for (const DirectionalLight& light : lights.lights) {
      const float cosine = normal.dot(light.direction);
      if (cosine <= 0) continue;
      RTCRay shadow{};
      set(shadow, point, light.direction);
      rtcOccluded1(casters_, &context, &shadow);
      if (shadow.tfar >= 0) sum += light.illuminance * cosine;
    }
    return sum * material(t).base_color / static_cast<float>(kPi);
  }

 private:
  static void set(RTCRay& ray, const Vec3f& origin, const Vec3f& direction) {
    ray.org_x = origin.x(), ray.org_y = origin.y(), ray.org_z = origin.z();
    ray.dir_x = direction.x(), ray.dir_y = direction.y(), ray.dir_z = direction.z();
    ray.tfar = std::numeric_limits<float>::infinity();
    ray.mask = ~0u;
  }
  [[nodiscard]] const Vertex& corner(std::size_t i) const { return scene_.vertices[scene_.indices[i]]; }
  [[nodiscard]] const Material& material(std::size_t index) const {
    for (const auto& p : scene_.primitives)
      if (index >= p.first_index && index < p.first_index + p.index_count)
        return scene_.materials[static_cast<std::size_t>(p.material)];
    return scene_.materials[0];
  }

  const Scene& scene_;
  RTCDevice device_ = rtcNewDevice("threads=1");
  RTCScene all_ = nullptr;
  RTCScene casters_ = nullptr;
};

// A sky of equal lights over the hemisphere and a sun.
LightSet sky_and_sun(int count, float sun) {
  std::vector<std::pair<Vec3f, Rgb>> lights = {{Vec3f(0.6f, 0.7f, 0.4f), Rgb::Constant(sun)}};
  for (int i = 1; i < count; ++i) {
    const double y = (i - 0.5) / (count - 1);
    const double azimuth = i * kPi * (3 - std::sqrt(5.0));
    const double r = std::sqrt(1 - y * y);
    lights.emplace_back(Vec3d(r * std::cos(azimuth), y, r * std::sin(azimuth)).cast<float>(),
                        Rgb(0.8f, 1, 1.3f) * (100 / static_cast<float>(count)));
  }
  return light_set(lights);
}

class ShadowMapAccuracy : public ::testing::Test {
 protected:
  void SetUp() override {
    auto context = render::EglContext::create();
    if (!context) GTEST_SKIP() << context.error().message;
    context_.emplace(std::move(context).value());
    auto scene = render::read_gltf(LIGHTWELL_STAGE);
    ASSERT_TRUE(scene.ok()) << scene.error().message;
    scene_ = std::move(scene).value();
    for (Material& m : scene_.materials) m.specular = Rgb::Zero();
  }

  static constexpr int kWidth = 160;
  static constexpr int kHeight = 120;

  render::RadiancePicture picture(const LightSet& lights, int shadow_size, bool simplify_casters = true) {
    render::RendererOptions options;
    options.width = kWidth;
    options.height = kHeight;
    options.shadow_size = shadow_size;
    options.simplify_casters = simplify_casters;
    auto renderer = render::Renderer::create(scene_, options);
    EXPECT_TRUE(renderer.ok());
    EXPECT_TRUE(renderer->render(lights, scene_.cameras[0]));
    return renderer->radiance();
  }

  // ‖picture − exact‖ / ‖exact‖ over all pixels and channels.
  double relative_rmse(const LightSet& lights, int shadow_size) {
    const auto rendered = picture(lights, shadow_size);
    const ExactVisibility exact(scene_);
    const render::View view = render::make_view(scene_.cameras[0], kWidth, kHeight);
    double difference = 0;
    double total = 0;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        const Rgb expected = exact.radiance(view.eye, pixel_ray(view, x, y, kWidth, kHeight), lights);
        const float* p = &rendered.rgba[4 * static_cast<std::size_t>(y * kWidth + x)];
        difference += (Rgb(p[0], p[1], p[2]) - expected).square().sum();
        total += expected.square().sum();
      }
    const double error = std::sqrt(difference / total);
    std::printf("relative RMSE against exact visibility: %.4f (%zu lights, maps of %d)\n", error,
                lights.lights.size(), shadow_size);
    return error;
  }

  std::optional<render::EglContext> context_;
  Scene scene_;
};

TEST_F(ShadowMapAccuracy, UnderASkyTheMapsCostLittle) {
  EXPECT_LT(relative_rmse(sky_and_sun(72, 0), 256), 0.015);
}

TEST_F(ShadowMapAccuracy, UnderASunLargerMapsAreMoreExact) {
  const LightSet lights = sky_and_sun(72, 200);
  const double coarse = relative_rmse(lights, 256);
  const double fine = relative_rmse(lights, 1024);
  EXPECT_LT(coarse, 0.04);
  EXPECT_LT(fine, coarse / 1.5);
}

TEST_F(ShadowMapAccuracy, SimplifiedCastersAddLessThanTheMapsThemselves) {
  const LightSet lights = sky_and_sun(72, 200);
  const auto full = picture(lights, 256, false).rgba;
  const auto fewer = picture(lights, 256, true).rgba;
  double difference = 0;
  double total = 0;
  for (std::size_t i = 0; i < full.size(); ++i) {
    difference += std::pow(static_cast<double>(fewer[i] - full[i]), 2);
    total += std::pow(static_cast<double>(full[i]), 2);
  }
  const double error = std::sqrt(difference / total);
  std::printf("relative RMSE of simplified casters against full ones: %.4f\n", error);
  // A quarter of the 0.04 that maps of 256² may err under this sun: in squares, a sixteenth.
  EXPECT_LT(error, 0.01);
}

}  // namespace
}  // namespace lightwell
