// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "bench/pictures/ray_tracer.h"

#include <embree3/rtcore.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <thread>

#include "render/camera.h"

namespace lightwell::pictures {

using render::Material;
using render::RadiancePicture;
using render::Scene;
using render::SceneCamera;

struct RayTracer::Scenes {
  Scenes(const Scene& s, Edges chosen) : scene(s), edges(chosen) {
    for (const auto& primitive : scene.primitives)
      triangle_primitive.insert(triangle_primitive.end(), primitive.index_count / 3,
                                static_cast<int>(&primitive - scene.primitives.data()));
    commit(all, [](const render::Primitive&) { return true; });
    commit(casters, [](const render::Primitive& p) { return p.casts_shadow; });
    RTCBounds bounds{};
    rtcGetSceneBounds(all, &bounds);
    // Single precision leaves this much of the scene's size in a point of intersection.
    offset_m = 1e-5f * (Vec3f(bounds.upper_x, bounds.upper_y, bounds.upper_z) -
                        Vec3f(bounds.lower_x, bounds.lower_y, bounds.lower_z))
                           .norm();
  }
  ~Scenes() {
    rtcReleaseScene(all);
    rtcReleaseScene(casters);
    rtcReleaseDevice(device);
  }
  Scenes(const Scenes&) = delete;
  Scenes& operator=(const Scenes&) = delete;

  template <typename Takes>
  void commit(RTCScene target, const Takes& takes) {
    std::vector<std::uint32_t> indices;
    for (const auto& p : scene.primitives)
      if (takes(p))
        indices.insert(indices.end(), scene.indices.begin() + p.first_index,
                       scene.indices.begin() + p.first_index + p.index_count);
    if (!indices.empty()) {
      RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
      auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
          geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, scene.vertices.size()));
      for (std::size_t i = 0; i < scene.vertices.size(); ++i)
        std::memcpy(vertices + 3 * i, scene.vertices[i].position.data(), 12);
      std::memcpy(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12,
                                          indices.size() / 3),
                  indices.data(), indices.size() * 4);
      rtcCommitGeometry(geometry);
      rtcAttachGeometry(target, geometry);
      rtcReleaseGeometry(geometry);
    }
    if (edges == Edges::watertight) rtcSetSceneFlags(target, RTC_SCENE_FLAG_ROBUST);
    rtcCommitScene(target);
  }

  const Scene& scene;
  Edges edges;
  std::vector<int> triangle_primitive;  // of all triangles, in the order of the primitives
  RTCDevice device = rtcNewDevice("threads=1");
  RTCScene all = rtcNewScene(device);
  RTCScene casters = rtcNewScene(device);
  float offset_m = 0;
};

namespace {

// What a pixel shows.
struct Hit {
  int primitive = 0;
  Vec3f start = Vec3f::Zero();  // of rays toward the lights
  Vec3f face = Vec3f::UnitY();  // toward the eye
  Vec3f normal = Vec3f::UnitY();
  Vec3f to_eye = Vec3f::UnitY();
};

std::optional<Hit> first_hit(const RayTracer::Scenes& scenes, const Vec3f& eye, const Vec3f& ray) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRayHit query{};
  query.ray.org_x = eye.x(), query.ray.org_y = eye.y(), query.ray.org_z = eye.z();
  query.ray.dir_x = ray.x(), query.ray.dir_y = ray.y(), query.ray.dir_z = ray.z();
  query.ray.tfar = std::numeric_limits<float>::infinity();
  query.ray.mask = ~0u;
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(scenes.all, &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;

  // Triangles are numbered through the primitives, which may stand anywhere in the scene's indices.
  const Scene& scene = scenes.scene;
  Hit hit;
  hit.primitive = scenes.triangle_primitive[query.hit.primID];
  std::uint32_t before = 0;
  for (int p = 0; p < hit.primitive; ++p) before += scene.primitives[static_cast<std::size_t>(p)].index_count;
  const std::size_t first = scene.primitives[static_cast<std::size_t>(hit.primitive)].first_index +
                            std::size_t{query.hit.primID} * 3 - before;
  const auto corner = [&](std::size_t i) -> const render::Vertex& {
    return scene.vertices[scene.indices[first + i]];
  };
  const float u = query.hit.u;
  const float v = query.hit.v;
  hit.normal = ((1 - u - v) * corner(0).normal + u * corner(1).normal + v * corner(2).normal).normalized();
  hit.face =
      (corner(1).position - corner(0).position).cross(corner(2).position - corner(0).position).normalized();
  if (hit.face.dot(ray) > 0) hit.face = -hit.face, hit.normal = -hit.normal;
  const Vec3f point = (1 - u - v) * corner(0).position + u * corner(1).position + v * corner(2).position;
  hit.start = point + scenes.offset_m * hit.face;
  hit.to_eye = (eye - point).normalized();
  return hit;
}

// docs/conventions.md and glTF 2.0, appendix B.3.5; times the cosine.
Rgb reflected(const Material& m, const Hit& hit, const Vec3f& to_light, float cosine) {
  constexpr auto pi = static_cast<float>(kPi);
  if (m.model == Material::Model::phong) {
    Rgb returned = m.base_color / pi;
    if (m.specular.maxCoeff() > 0) {
      const Vec3f mirrored = 2 * hit.normal.dot(hit.to_eye) * hit.normal - hit.to_eye;
      const float lobe = std::pow(std::max(0.0f, mirrored.dot(to_light)), m.exponent);
      returned += m.specular * (lobe * (m.exponent + 2) / (2 * pi));
    }
    return cosine * returned;
  }
  const Vec3f half = (to_light + hit.to_eye).normalized();
  const float nl = cosine;
  const float nv = std::max(hit.normal.dot(hit.to_eye), 1e-4f);
  const float nh = std::max(hit.normal.dot(half), 0.0f);
  const float vh = std::clamp(hit.to_eye.dot(half), 0.0f, 1.0f);
  const float alpha2 = std::max(std::pow(m.roughness, 4.0f), 1e-6f);
  const float d = alpha2 / (pi * std::pow(nh * nh * (alpha2 - 1) + 1, 2.0f));
  // Smith's G over 4 (n·l)(n·v).
  const auto masking = [&](float x) { return x + std::sqrt(alpha2 + (1 - alpha2) * x * x); };
  const float visibility = 1 / (masking(nl) * masking(nv));
  const Rgb at_normal = 0.04f * (1 - m.metallic) + m.base_color * m.metallic;
  const Rgb fresnel = at_normal + (1 - at_normal) * std::pow(1 - vh, 5.0f);
  return cosine * ((1 - fresnel) * (1 - m.metallic) * m.base_color / pi + fresnel * (d * visibility));
}

// Eight rays at a time from one point. Lit: called with each light that arrives and what it returns of a lux.
template <typename Lit>
class ShadowRays {
 public:
  ShadowRays(const RayTracer::Scenes& scenes, const Hit& hit, Lit lit)
      : scenes_(scenes), hit_(hit), lit_(std::move(lit)) {
    rtcInitIntersectContext(&context_);
  }

  void add(const DirectionalLight& light, float cosine) {
    rays_.dir_x[count_] = light.direction.x();
    rays_.dir_y[count_] = light.direction.y();
    rays_.dir_z[count_] = light.direction.z();
    cosine_[count_] = cosine;
    light_[count_] = &light;
    if (++count_ == 8) flush();
  }

  void flush() {
    if (count_ == 0) return;
    for (int i = 0; i < 8; ++i) {
      valid_[i] = i < count_ ? -1 : 0;
      rays_.org_x[i] = hit_.start.x(), rays_.org_y[i] = hit_.start.y(), rays_.org_z[i] = hit_.start.z();
      rays_.tnear[i] = 0;
      rays_.tfar[i] = std::numeric_limits<float>::infinity();
      rays_.mask[i] = ~0u;
      rays_.time[i] = 0;
    }
    rtcOccluded8(valid_, scenes_.casters, &context_, &rays_);
    const Material& material = scenes_.scene.materials[static_cast<std::size_t>(
        scenes_.scene.primitives[static_cast<std::size_t>(hit_.primitive)].material)];
    for (int i = 0; i < count_; ++i)
      if (rays_.tfar[i] >= 0) lit_(*light_[i], reflected(material, hit_, light_[i]->direction, cosine_[i]));
    count_ = 0;
  }

 private:
  const RayTracer::Scenes& scenes_;
  const Hit& hit_;
  RTCIntersectContext context_;
  RTCRay8 rays_{};
  alignas(32) int valid_[8] = {};
  float cosine_[8] = {};
  const DirectionalLight* light_[8] = {};
  int count_ = 0;
  Lit lit_;
};

template <typename Pixel>
void every_pixel(const SceneCamera& camera, int width, int height, int threads, const Pixel& pixel) {
  const render::View view = render::make_view(camera, width, height);
  std::atomic<int> next_row{0};
  const auto work = [&] {
    for (int y = next_row++; y < height; y = next_row++)
      for (int x = 0; x < width; ++x) {
        const float right = 2 * (static_cast<float>(x) + 0.5f) / static_cast<float>(width) - 1;
        const float up = 1 - 2 * (static_cast<float>(y) + 0.5f) / static_cast<float>(height);
        pixel(static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x),
              view.eye, Vec3f(view.forward + right * view.right + up * view.up));
      }
  };
  std::vector<std::thread> others;
  for (int i = 1; i < threads; ++i) others.emplace_back(work);
  work();
  for (std::thread& other : others) other.join();
}

}  // namespace

RayTracer::RayTracer(std::unique_ptr<Scenes> scenes) : scenes_(std::move(scenes)) {}
RayTracer::RayTracer(RayTracer&&) noexcept = default;
RayTracer& RayTracer::operator=(RayTracer&&) noexcept = default;
RayTracer::~RayTracer() = default;

Result<RayTracer> RayTracer::create(const Scene& scene, Edges edges) {
  const bool plain = scene.textures.empty() &&
                     std::all_of(scene.vertices.begin(), scene.vertices.end(),
                                 [](const render::Vertex& v) { return v.color == render::Vertex().color; }) &&
                     std::all_of(scene.materials.begin(), scene.materials.end(), [](const Material& m) {
                       return m.alpha_cutoff == 0 && m.emission.maxCoeff() == 0;
                     });
  if (!plain)
    return Error{ErrorKind::usage, "the ray tracer knows no textures, vertex colours, cut-outs and emission"};
  return RayTracer(std::make_unique<Scenes>(scene, edges));
}

// lights_at(point): a range of lights.
template <typename Lights>
RadiancePicture RayTracer::shade(const SceneCamera& camera, int width, int height, int threads,
                                 const Lights& lights_at) const {
  RadiancePicture picture{
      width, height,
      std::vector<float>(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 4)};
  every_pixel(camera, width, height, threads, [&](std::size_t pixel, const Vec3f& eye, const Vec3f& ray) {
    const auto hit = first_hit(*scenes_, eye, ray);
    if (!hit) return;
    Rgbd total = Rgbd::Zero();
    ShadowRays rays(*scenes_, *hit, [&](const DirectionalLight& light, const Rgb& returned) {
      total += (light.illuminance * returned).cast<double>();
    });
    const auto& lights = lights_at(hit->start);
    for (const DirectionalLight& light : lights)
      if (const float cosine = hit->normal.dot(light.direction); cosine > 0) rays.add(light, cosine);
    rays.flush();
    const Rgb sum = total.cast<float>();
    std::copy_n(sum.data(), 3, &picture.rgba[4 * pixel]);
    picture.rgba[4 * pixel + 3] = 1;
  });
  return picture;
}

RadiancePicture RayTracer::picture(const SceneCamera& camera, int width, int height,
                                   std::span<const DirectionalLight> lights, int threads) const {
  return shade(camera, width, height, threads, [&](const Vec3f&) { return lights; });
}

RadiancePicture RayTracer::picture(const SceneCamera& camera, int width, int height,
                                   const LightsAt& lights_at, int threads) const {
  return shade(camera, width, height, threads, [&](const Vec3f& point) {
    std::vector<DirectionalLight> lights;
    lights_at(point, lights);
    return lights;
  });
}

std::vector<float> RayTracer::transport(const SceneCamera& camera, int width, int height,
                                        std::span<const DirectionalLight> lights) const {
  std::vector<float> returned(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) *
                              lights.size());
  every_pixel(camera, width, height, 1, [&](std::size_t pixel, const Vec3f& eye, const Vec3f& ray) {
    const auto hit = first_hit(*scenes_, eye, ray);
    if (!hit) return;
    float* of_pixel = returned.data() + pixel * lights.size();
    ShadowRays rays(*scenes_, *hit, [&](const DirectionalLight& light, const Rgb& value) {
      of_pixel[&light - lights.data()] = luminance(value);
    });
    for (const DirectionalLight& light : lights)
      if (const float cosine = hit->normal.dot(light.direction); cosine > 0) rays.add(light, cosine);
    rays.flush();
  });
  return returned;
}

std::vector<int> RayTracer::primitives(const SceneCamera& camera, int width, int height) const {
  std::vector<int> shown(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), -1);
  every_pixel(camera, width, height, 1, [&](std::size_t pixel, const Vec3f& eye, const Vec3f& ray) {
    if (const auto hit = first_hit(*scenes_, eye, ray)) shown[pixel] = hit->primitive;
  });
  return shown;
}

}  // namespace lightwell::pictures
