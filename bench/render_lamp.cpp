// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// The case of Granier et al. 2003, table 1: a lamp of 9 × 7 positions with images of 300², 8,000 triangles, 400 × 400 pixels
// (there .55 frames a second on the graphics card of its time); error against rays to every position.
#include <Eigen/Geometry>
#include <cmath>
#include <fstream>
#include <memory>

#include "bench/pictures/ray_tracer.h"
#include "bench/render_suite.h"
#include "bench/temporary_folder.h"
#include "render/gltf_scene.h"
#include "render/scene_writer.h"

namespace lightwell::bench {
namespace {

constexpr int kSide = 400;

// A torch: each position sends a spot with rings to its own part of the measurement plane.
NearField torch() {
  NearField lamp;
  LampPlanes& planes = lamp.intensity.planes;
  planes.positions = {9, 7};
  planes.spacing_m = 0.005;
  planes.first_m = {-0.02, -0.015};
  planes.distance_m = 0.1;
  planes.pixels = {300, 300};
  planes.low_m = Vec2d::Constant(-0.08);
  planes.high_m = Vec2d::Constant(0.08);
  lamp.intensity.values.resize(planes.images() * planes.image_size());
  for (int v = 0; v < planes.positions[1]; ++v)
    for (int u = 0; u < planes.positions[0]; ++u) {
      const Vec2d from = planes.position(u, v);
      const double power = 4 * std::exp(-(from / 0.015).squaredNorm());
      Rgb* pixel = lamp.intensity.image(u, v);
      for (int t = 0; t < planes.pixels[1]; ++t)
        for (int s = 0; s < planes.pixels[0]; ++s) {
          const Vec2d off = (planes.pixel_centre(s, t) - 0.6 * from) / 0.08;
          const double edge =
              std::max(0.0, 1 - std::pow(planes.pixel_centre(s, t).cwiseAbs().maxCoeff() / 0.08, 8));
          const double pattern = std::exp(-5 * off.squaredNorm()) * (1 + 0.5 * std::cos(30 * off.norm()));
          *pixel++ = (Rgbd(1, 0.93, 0.8) * (power * pattern * edge)).cast<float>();
        }
    }
  return lamp;
}

Result<render::Scene> still_life() {
  using render::phong_material;
  render::SceneWriter writer;
  writer.add("ground", render::ground_mesh(6), "matte", phong_material({0.42f, 0.40f, 0.38f}, Rgb::Zero(), 1),
             false);
  writer.add("ball", render::sphere_mesh({-0.25f, 0.15f, 0.1f}, 0.15f, 44, 48), "clay",
             phong_material(Rgb::Constant(0.6f), Rgb::Zero(), 1));
  writer.add("knot", render::knot_mesh({0.2f, 0.2f, 0}, 0.09f, 0.042f, 120, 16), "bronze",
             phong_material({0.45f, 0.26f, 0.16f}, Rgb::Zero(), 1));
  render::SceneCamera camera;
  camera.yfov_rad = 0.5f;
  camera.world_from_camera.topLeftCorner<3, 3>() =
      Eigen::AngleAxisf(-0.5f, Vec3f::UnitX()).toRotationMatrix();
  camera.world_from_camera.col(3).head<3>() = Vec3f(0, 1.1f, 1.75f);
  const TemporaryFolder folder;
  const auto file = folder.path() / "scene.gltf";
  std::ofstream(file) << writer.gltf(camera);
  return render::read_gltf(file);
}

// Above the objects; nothing stands beyond it.
render::PlacedLamp lamp_at(const std::shared_ptr<const Luminaire>& lamp, double height_m, double x_m) {
  render::PlacedLamp placed{lamp, Eigen::Isometry3d::Identity(), 1};
  placed.world_from_lamp.translation() = Vec3d(x_m, height_m, 0.25);
  placed.world_from_lamp.linear() = Eigen::AngleAxisd(-1.35, Vec3d::UnitX()).toRotationMatrix();
  return placed;
}

render::RadiancePicture traced(const pictures::RayTracer& tracer, const render::Scene& scene,
                               const render::PlacedLamp& placed) {
  const LampImages& images = placed.lamp->near->intensity;
  const LampPlanes& planes = images.planes;
  const Eigen::Isometry3d lamp_from_world = placed.world_from_lamp.inverse();
  return tracer.picture(
      scene.cameras.at(0), kSide, kSide, [&](const Vec3f& point, std::vector<DirectionalLight>& lights) {
        const Vec3d at = lamp_from_world * point.cast<double>();
        for (int v = 0; v < planes.positions[1]; ++v)
          for (int u = 0; u < planes.positions[0]; ++u) {
            const Vec2d from = planes.position(u, v);
            const Vec3d way = at - planes.place(from);
            if (!(way.z() < 0)) continue;
            const Rgbd candela = images.at(u, v, planes.on_map(from, way));
            if ((candela == 0).all()) continue;
            DirectionalLight light;
            light.direction = (placed.world_from_lamp.linear() * -way.normalized()).cast<float>();
            light.illuminance = (candela / way.squaredNorm()).cast<float>();
            lights.push_back(light);
          }
      });
}

double relative_rmse(const render::RadiancePicture& picture, const render::RadiancePicture& reference) {
  double off = 0, all = 0;
  for (std::size_t i = 0; i < reference.rgba.size(); ++i) {
    if (i % 4 == 3 || reference.rgba[i - i % 4 + 3] == 0) continue;
    off += std::pow(static_cast<double>(picture.rgba[i] - reference.rgba[i]), 2);
    all += std::pow(static_cast<double>(reference.rgba[i]), 2);
  }
  return std::sqrt(off / all);
}

}  // namespace

std::vector<Row> render_lamp_rows(const Options& options) {
  std::vector<Row> rows;
  const auto scene = still_life();
  if (!scene) return rows;
  const auto tracer = pictures::RayTracer::create(*scene, pictures::Edges::watertight);
  if (!tracer) return rows;
  Luminaire luminaire;
  luminaire.near = torch();
  const auto lamp = std::make_shared<const Luminaire>(std::move(luminaire));
  for (const double height_m : {0.6, 1.0, 3.0}) {
    char setting[64];
    std::snprintf(setting, sizeof setting, "lamp, 9x7 of 300x300, %.1f m above", height_m);
    const render::PlacedLamp placed = lamp_at(lamp, height_m, 0);
    render::RadiancePicture reference;
    Row traced_row = timed_frames(setting, "Embree, every position", options,
                                  [&](std::size_t) { reference = traced(*tracer, *scene, placed); });
    struct Variant {
      const char* name;
      double error;
      bool moves;
    };
    for (const Variant& variant :
         {Variant{"every position, lamp moves", 0, true}, Variant{"every position, lamp stands", 0, false},
          Variant{"within .01, lamp moves", 0.01, true}, Variant{"within .05, lamp moves", 0.05, true}}) {
      render::RendererOptions renderer_options;
      renderer_options.width = renderer_options.height = kSide;
      renderer_options.lamp_error = variant.error;
      auto renderer = renderer_of(*scene, renderer_options);
      if (!renderer) continue;
      const auto draw = [&](double x_m) {
        const render::PlacedLamp lamps[] = {lamp_at(lamp, height_m, x_m)};
        (void)renderer->set_lamps(lamps);
        (void)renderer->render({}, scene->cameras.at(0));
        renderer->finish();
      };
      Row row = timed_frames(setting, variant.name, options,
                             [&](std::size_t i) { draw(variant.moves && i % 2 == 0 ? 0.001 : 0); });
      draw(0);
      row.values.emplace_back("hz_p50", 1000 / row.timing.p50_ms);
      row.values.emplace_back("hz_p99", 1000 / row.timing.p99_ms);
      row.values.emplace_back("relative_rmse", relative_rmse(renderer->radiance(), reference));
      row.values.emplace_back("sources", static_cast<double>(renderer->lamps().counts().sources));
      row.values.emplace_back("triangles", static_cast<double>(scene->triangles()));
      rows.push_back(row);
    }
    rows.push_back(traced_row);
  }
  return rows;
}

}  // namespace lightwell::bench
