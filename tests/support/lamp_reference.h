// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <vector>

#include "lighting/luminaire/luminaire.h"
#include "render/camera.h"
#include "render/picture.h"
#include "render/placed_lamp.h"
#include "render/scene.h"
#include "tests/support/test_scene.h"

// Pictures under lamps by brute force: in double precision, a ray to every position, every triangle tried.
namespace lightwell::test {

// A lamp whose pattern changes with the distance and with the position: a spot that every position aims at another point,
// rounder or longer.
inline NearField patterned_lamp(int columns, int rows, double spacing_m, int pixels, double distance_m = 0.3,
                                double half_m = 0.3) {
  NearField lamp;
  LampPlanes& planes = lamp.intensity.planes;
  planes.positions = {columns, rows};
  planes.spacing_m = spacing_m;
  planes.first_m = -spacing_m / 2 * Vec2d(columns - 1, rows - 1);
  planes.distance_m = distance_m;
  planes.pixels = {pixels, pixels};
  planes.low_m = Vec2d::Constant(-half_m);
  planes.high_m = Vec2d::Constant(half_m);
  lamp.intensity.values.resize(planes.images() * planes.image_size());
  for (int v = 0; v < rows; ++v)
    for (int u = 0; u < columns; ++u) {
      const Vec2d from = planes.position(u, v);
      Rgb* pixel = lamp.intensity.image(u, v);
      for (int t = 0; t < pixels; ++t)
        for (int s = 0; s < pixels; ++s) {
          const Vec2d at = planes.pixel_centre(s, t) / half_m;
          const double spot = std::exp(-4 * (at - from / half_m).squaredNorm());
          const double rings = 1 + 0.4 * std::cos(9 * at.norm() + 40 * from.x());
          const double edge = std::pow(std::max(0.0, 1 - std::pow(at.cwiseAbs().maxCoeff(), 4)), 2);
          *pixel++ = (Rgbd(1, 0.8, 0.6) * (30 * spot * rings * edge)).cast<float>();
        }
    }
  return lamp;
}

// Aimed down from a place.
inline Eigen::Isometry3d aimed_down(const Vec3d& place, double tilt_rad = 0) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = place;
  pose.linear() = Eigen::AngleAxisd(-kPi / 2 + tilt_rad, Vec3d::UnitX()).toRotationMatrix();
  return pose;
}

struct ReferenceTriangle {
  Vec3d a, ab, ac;
  std::size_t primitive = 0;
};

// Distance along a ray to a triangle, in units of the ray's length.    source: Möller and Trumbore 1997
inline std::optional<double> meets(const ReferenceTriangle& t, const Vec3d& from, const Vec3d& ray) {
  const Vec3d p = ray.cross(t.ac);
  const double det = t.ab.dot(p);
  if (det == 0) return std::nullopt;
  const Vec3d s = from - t.a;
  const double u = s.dot(p) / det;
  if (u < 0 || u > 1) return std::nullopt;
  const Vec3d q = s.cross(t.ab);
  const double v = ray.dot(q) / det;
  if (v < 0 || u + v > 1) return std::nullopt;
  return t.ac.dot(q) / det;
}

// Radiance of Lambertian materials, primitives with smooth normals taken by their vertices. NaN: no surface there.
inline std::vector<Rgbd> lamp_picture_by_force(const Scene& scene,
                                               const std::vector<render::PlacedLamp>& lamps,
                                               const SceneCamera& camera, int width, int height) {
  std::vector<ReferenceTriangle> triangles;
  std::vector<std::size_t> corners;
  for (std::size_t p = 0; p < scene.primitives.size(); ++p)
    for (std::uint32_t i = 0; i + 2 < scene.primitives[p].index_count; i += 3) {
      const std::size_t first = scene.primitives[p].first_index + i;
      const auto corner = [&](std::size_t c) -> Vec3d {
        return scene.vertices[scene.indices[first + c]].position.cast<double>();
      };
      triangles.push_back({corner(0), corner(1) - corner(0), corner(2) - corner(0), p});
      corners.push_back(first);
    }
  const auto hidden = [&](const Vec3d& from, const Vec3d& ray) {
    for (const ReferenceTriangle& t : triangles) {
      if (!scene.primitives[t.primitive].casts_shadow) continue;
      const auto at = meets(t, from, ray);
      if (at && *at > 1e-6 && *at < 1) return true;
    }
    return false;
  };
  const render::View view = render::make_view(camera, width, height);
  const Vec3d eye = view.eye.cast<double>();
  std::vector<Rgbd> picture;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const Vec3d ray = pixel_ray(view, x, y, width, height).cast<double>();
      double nearest = std::numeric_limits<double>::infinity();
      std::size_t hit = 0;
      for (std::size_t k = 0; k < triangles.size(); ++k)
        if (const auto at = meets(triangles[k], eye, ray); at && *at > 0 && *at < nearest) {
          nearest = *at;
          hit = k;
        }
      if (!std::isfinite(nearest)) {
        picture.emplace_back(Rgbd::Constant(std::nan("")));
        continue;
      }
      const ReferenceTriangle& t = triangles[hit];
      const Vec3d point = eye + nearest * ray;
      Vec3d face = t.ab.cross(t.ac).normalized();
      // Barycentric, for the shading normal.
      const Vec3d off = point - t.a;
      const double d11 = t.ab.dot(t.ab), d12 = t.ab.dot(t.ac), d22 = t.ac.dot(t.ac);
      const double b1 = (d22 * t.ab.dot(off) - d12 * t.ac.dot(off)) / (d11 * d22 - d12 * d12);
      const double b2 = (d11 * t.ac.dot(off) - d12 * t.ab.dot(off)) / (d11 * d22 - d12 * d12);
      const auto normal_of = [&](std::size_t c) -> Vec3d {
        return scene.vertices[scene.indices[corners[hit] + c]].normal.cast<double>();
      };
      Vec3d normal = ((1 - b1 - b2) * normal_of(0) + b1 * normal_of(1) + b2 * normal_of(2)).normalized();
      if (face.dot(ray) > 0) face = -face, normal = -normal;
      const Vec3d start = point + 1e-6 * face;
      Rgbd lux = Rgbd::Zero();
      const auto add = [&](const Vec3d& source, const Rgbd& candela) {
        const Vec3d to_light = source - start;
        const double square = to_light.squaredNorm(), facing = to_light.dot(normal);
        if (facing <= 0 || (candela == 0).all() || hidden(start, to_light)) return;
        lux += candela * facing / (square * std::sqrt(square));
      };
      for (const render::PlacedLamp& placed : lamps) {
        const Vec3d at = placed.world_from_lamp.inverse() * start;
        if (placed.lamp->near) {
          const LampImages& images = placed.lamp->near->intensity;
          for (int v = 0; v < images.planes.positions[1]; ++v)
            for (int u = 0; u < images.planes.positions[0]; ++u) {
              const Vec3d place = images.planes.place(images.planes.position(u, v));
              const Vec3d way = at - place;
              if (!(way.z() < 0)) continue;
              const Vec2d seen = images.planes.map == LampMap::hemisphere
                                     ? square_from_direction(way.normalized())
                                     : images.planes.on_map(images.planes.position(u, v), way);
              add(placed.world_from_lamp * place, placed.dimming * images.at(u, v, seen));
            }
        }
        if (placed.lamp->far) {
          const Vec3d centre = far_centre(*placed.lamp);
          add(placed.world_from_lamp * centre,
              Rgbd::Constant(placed.dimming *
                             intensity(*placed.lamp->far, Vec3d((at - centre).normalized()))));
        }
      }
      const auto& material =
          scene.materials[static_cast<std::size_t>(scene.primitives[t.primitive].material)];
      picture.push_back(material.base_color.cast<double>() / kPi * lux.max(0.0));
    }
  return picture;
}

struct PictureDifference {
  double relative_rmse = 0;
  double light = 0;      // Σ rendered / Σ reference
  std::size_t lit = 0;   // pixels of the reference
  double lit_share = 0;  // of those that show a surface
};
inline PictureDifference difference(const render::RadiancePicture& picture,
                                    const std::vector<Rgbd>& reference) {
  double off = 0, all = 0, sum = 0, expected = 0;
  std::size_t lit = 0, surfaces = 0;
  for (std::size_t i = 0; i < reference.size(); ++i) {
    if (reference[i].isNaN().any() || picture.rgba[4 * i + 3] == 0) continue;
    ++surfaces;
    const Rgbd rendered(static_cast<double>(picture.rgba[4 * i]),
                        static_cast<double>(picture.rgba[4 * i + 1]),
                        static_cast<double>(picture.rgba[4 * i + 2]));
    off += (rendered - reference[i]).square().sum();
    all += reference[i].square().sum();
    sum += rendered.sum();
    expected += reference[i].sum();
    if (reference[i].maxCoeff() > 0) ++lit;
  }
  return {std::sqrt(off / all), sum / expected, lit,
          static_cast<double>(lit) / static_cast<double>(std::max<std::size_t>(surfaces, 1))};
}

}  // namespace lightwell::test
