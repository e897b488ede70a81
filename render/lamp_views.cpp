// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/lamp_views.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace lightwell::render {
namespace {

constexpr double kWidestTangent = 4;  // of a single map: 76° to a side
constexpr double kWidest_rad = 70 * kPi / 180;
// DEPTH_SLACK (lamp_shading.cpp) is then 2.5e-4 of the farthest away there, 2.5 mm in 10 m, and less by the square of what is
// nearer.
constexpr double kFarToNear = 1000;
constexpr double kBorderTexels = 2;  // that no look-up reaches beyond

// Coordinates of the cube's faces: across, up, along its axis. The shader finds the same (lamp_shadow.glsl).
Eigen::Matrix3d face_from_map(int face) {
  const int along = face == 0 || face == 5 ? 2 : (face - 1) / 2;
  const double sign = face == 2 || face == 4 || face == 5 ? -1 : 1;
  Eigen::Matrix3d m = Eigen::Matrix3d::Zero();
  m(0, along == 0 ? 1 : 0) = 1;
  m(1, along == 2 ? 1 : 2) = 1;
  m(2, along) = sign;
  return m;
}

// What casts, seen in the maps' axes from the lamp's origin: points, and balls of which no more is known.
struct Seen {
  std::vector<Vec3d> points;
  struct Ball {
    Vec3d centre;
    double radius;
  };
  std::vector<Ball> parts, unknown;
};

Seen see(const Casters& casters, const Eigen::Isometry3d& lamp_from_world, const Eigen::Matrix3d& axes,
         bool with_supports) {
  Seen seen;
  const Eigen::Matrix3d turn = axes * lamp_from_world.linear();
  const Vec3d shift = axes * lamp_from_world.translation();
  for (const Casters::Part& part : casters.parts) {
    const bool support = casters.is_support[part.primitive];
    if (support && !with_supports) continue;
    for (std::uint32_t i = 0; i < part.position_count; ++i)
      seen.points.push_back(turn * casters.positions[part.first_position + i].cast<double>() + shift);
    if (support) continue;
    const Seen::Ball ball{turn * part.bounds.centre.cast<double>() + shift,
                          static_cast<double>(part.bounds.radius)};
    seen.parts.push_back(ball);
    if (part.position_count == 0) seen.unknown.push_back(ball);
  }
  return seen;
}

struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  void add(double x) {
    low = std::min(low, x);
    high = std::max(high, x);
  }
};

// The least tangents between which a source sees all that casts before it; all there are where some may be beside it: nearer
// along the axis than near_m, or on triangles that reach from behind it to before it.
std::array<Range, 2> tangents_of(const Seen& seen, const Vec3d& from, double near_m) {
  std::array<Range, 2> range;
  bool beside = false, behind = false;
  const auto add = [&](const Vec3d& p) {
    for (int axis = 0; axis < 2; ++axis) range[static_cast<std::size_t>(axis)].add(p[axis] / p.z());
  };
  for (const Vec3d& point : seen.points) {
    const Vec3d p = point - from;
    if (p.z() >= near_m)
      add(p);
    else
      (p.z() > 0 ? beside : behind) = true;
  }
  for (const Seen::Ball& ball : seen.unknown) {
    const Vec3d p = ball.centre - from;
    if (p.z() - ball.radius < near_m) {
      beside = beside || p.z() + ball.radius > 0;
      continue;
    }
    for (int corner = 0; corner < 8; ++corner)
      add(p + ball.radius *
                  Vec3d((corner & 1) != 0 ? 1 : -1, (corner & 2) != 0 ? 1 : -1, (corner & 4) != 0 ? 1 : -1));
  }
  if (beside || (behind && range[0].low <= range[0].high))
    for (Range& r : range) r = {-kWidestTangent, kWidestTangent};
  return range;
}

std::array<float, 4> fit_of(std::array<Range, 2> range, int side) {
  const double inner = 1 - 2 * kBorderTexels / side;
  std::array<float, 4> fit{};
  const double widest = std::max(range[0].high - range[0].low, range[1].high - range[1].low);
  for (std::size_t axis = 0; axis < 2; ++axis) {
    Range& r = range[axis];
    if (!(r.low <= r.high)) return {};
    // A map of stretched texels would gain little.
    const double width = std::max({r.high - r.low, widest / 8, 1e-6});
    const double middle = (r.low + r.high) / 2;
    fit[axis] = static_cast<float>(inner / width);
    fit[axis + 2] = static_cast<float>(0.5 - inner / width * middle);
  }
  return fit;
}

bool is_behind_a_support(const Casters& casters, const Vec3f& place) {
  std::size_t number = 0;
  for (const Casters::Part& part : casters.parts) {
    if (!casters.is_support[part.primitive]) continue;
    const Vec3f& normal = casters.support_normals[number++];
    if (normal.dot(place - casters.positions[part.first_position]) <= 0) return true;
  }
  return false;
}

// Axes for one map a source, where one is wide enough for all of them.
bool one_map_serves(const LampSources& lamp, const Eigen::Isometry3d& lamp_from_world, const Casters& casters,
                    bool with_supports, Eigen::Matrix3d& axes) {
  if (lamp.map == SourceMap::plane) {
    double widest = 0;
    for (const LampSources::Source& source : lamp.sources)
      widest = std::max(
          {widest, source.low.cwiseAbs().maxCoeff(), (source.low + lamp.span).cwiseAbs().maxCoeff()});
    if (widest <= kWidestTangent) return true;
  }
  if (with_supports) return false;
  Vec3d middle = Vec3d::Zero();
  for (const LampSources::Source& source : lamp.sources)
    middle += source.place / static_cast<double>(lamp.sources.size());
  const Vec3d objects = lamp_from_world * casters.objects.centre.cast<double>();
  const auto radius = static_cast<double>(casters.objects.radius);
  if (!((objects - middle).norm() > radius)) return false;
  const Vec3d forward = (objects - middle).normalized();
  for (const LampSources::Source& source : lamp.sources) {
    const Vec3d way = objects - source.place;
    const double distance = way.norm();
    if (!(distance > radius)) return false;
    const double off = std::acos(std::clamp(forward.dot(way) / distance, -1.0, 1.0));
    if (off + std::asin(radius / distance) > kWidest_rad) return false;
  }
  const Vec3d right =
      forward.cross(std::abs(forward.y()) < 0.9 ? Vec3d::UnitY() : Vec3d::UnitX()).normalized();
  axes.row(0) = right.transpose();
  axes.row(1) = right.cross(forward).transpose();
  axes.row(2) = forward.transpose();
  return true;
}

bool may_stand_on(const Seen& seen, const Vec3d& from, const Eigen::Matrix3d& face) {
  return std::any_of(seen.parts.begin(), seen.parts.end(), [&](const Seen::Ball& ball) {
    const Vec3d p = face * (ball.centre - from);
    const double across = std::max(std::abs(p.x()), std::abs(p.y()));
    return p.z() > -ball.radius && across - p.z() < 1.5 * ball.radius;
  });
}

struct Reach {
  double near_m = std::numeric_limits<double>::infinity(), far_m = 0;  // along the faces' axes
  bool inside = false;
};

// Along a single axis a triangle is nowhere nearer than its corners; to the faces of a cube it may be as near as the ball
// around its part.
Reach reach_of(const Seen& seen, const LampSources& lamp, const LampViews& views) {
  Reach reach;
  for (const LampSources::Source& source : lamp.sources) {
    const Vec3d from = views.map_from_lamp * source.place;
    for (const Vec3d& point : seen.points) {
      const Vec3d way = point - from;
      const double metres = views.faces == 1 ? way.z() : way.norm();
      reach.far_m = std::max(reach.far_m, metres);
      if (views.faces == 1) reach.near_m = std::min(reach.near_m, std::max(metres, 0.0));
    }
    for (const Seen::Ball& ball : views.faces == 1 ? seen.unknown : seen.parts) {
      const Vec3d way = ball.centre - from;
      const double metres = views.faces == 1 ? way.z() : way.norm();
      reach.far_m = std::max(reach.far_m, metres + ball.radius);
      const double least = (metres - ball.radius) / (views.faces == 1 ? 1 : std::sqrt(3.0));
      reach.near_m = std::min(reach.near_m, std::max(least, 0.0));
    }
    for (const Seen::Ball& ball : seen.parts)
      reach.inside = reach.inside || (ball.centre - from).norm() <= 1.01 * ball.radius;
  }
  if (views.with_supports) reach.near_m = 0;
  return reach;
}

}  // namespace

LampViews find_lamp_views(const LampSources& lamp, const Eigen::Isometry3d& world_from_lamp,
                          const Casters& casters, int side) {
  LampViews views;
  const Eigen::Isometry3d lamp_from_world = world_from_lamp.inverse();
  for (const LampSources::Source& source : lamp.sources)
    views.with_supports =
        views.with_supports || is_behind_a_support(casters, (world_from_lamp * source.place).cast<float>());
  views.map_from_lamp = Vec3d(1, 1, -1).asDiagonal();
  if (!one_map_serves(lamp, lamp_from_world, casters, views.with_supports, views.map_from_lamp))
    views.faces = lamp.map == SourceMap::sphere ? 6 : 5;
  const Seen seen = see(casters, lamp_from_world, views.map_from_lamp, views.with_supports);

  const Reach reach = reach_of(seen, lamp, views);
  views.inside = reach.inside;
  if (!(reach.far_m > 0)) {
    views.fits.assign(lamp.sources.size() * static_cast<std::size_t>(views.faces), {});
    return views;
  }
  views.far_m = 1.01 * reach.far_m;
  views.near_m = std::clamp(0.99 * reach.near_m, views.far_m / kFarToNear, 0.9 * views.far_m);

  for (const LampSources::Source& source : lamp.sources) {
    const Vec3d from = views.map_from_lamp * source.place;
    if (views.faces > 1) {
      for (int face = 0; face < views.faces; ++face)
        views.fits.push_back(views.with_supports || may_stand_on(seen, from, face_from_map(face))
                                 ? fit_of({Range{-1, 1}, Range{-1, 1}}, side)
                                 : std::array<float, 4>{});
      continue;
    }
    std::array<Range, 2> range = tangents_of(seen, from, views.near_m);
    if (lamp.map == SourceMap::plane)
      for (std::size_t axis = 0; axis < 2; ++axis) {
        const double low = source.low[static_cast<Eigen::Index>(axis)];
        range[axis].low = std::max(range[axis].low, low);
        range[axis].high = std::min(range[axis].high, low + lamp.span[static_cast<Eigen::Index>(axis)]);
      }
    views.fits.push_back(fit_of(range, side));
  }
  return views;
}

std::array<float, 2> LampViews::depth_terms() const {
  const double scale = far_m / (far_m - near_m);
  return {static_cast<float>(scale), static_cast<float>(scale * near_m)};
}

Mat4f LampViews::clip_from_world(const LampSources& lamp, const Eigen::Isometry3d& world_from_lamp,
                                 std::size_t source, int face) const {
  const auto& fit = fits[source * static_cast<std::size_t>(faces) + static_cast<std::size_t>(face)];
  const double scale = far_m / (far_m - near_m);
  Eigen::Matrix4d clip = Eigen::Matrix4d::Zero();
  for (int axis = 0; axis < 2; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    clip(axis, axis) = 2 * static_cast<double>(fit[a]);
    clip(axis, 2) = 2 * static_cast<double>(fit[a + 2]) - 1;
  }
  clip(2, 2) = 2 * scale - 1;
  clip(2, 3) = -2 * scale * near_m;
  clip(3, 2) = 1;
  Eigen::Isometry3d lamp_from_world = world_from_lamp.inverse();
  lamp_from_world.pretranslate(-lamp.sources[source].place);
  Eigen::Matrix4d turn = Eigen::Matrix4d::Identity();
  turn.topLeftCorner<3, 3>() =
      (faces > 1 ? face_from_map(face) : Eigen::Matrix3d(Eigen::Matrix3d::Identity())) * map_from_lamp;
  return (clip * turn * lamp_from_world.matrix()).cast<float>();
}

bool LampViews::empty() const {
  return std::all_of(fits.begin(), fits.end(), [](const auto& fit) { return fit[0] == 0; });
}

double LampViews::least_texel_m(int side) const {
  double most = 0;
  for (const auto& fit : fits)
    most = std::max({most, static_cast<double>(fit[0]), static_cast<double>(fit[1])});
  return most > 0 ? near_m / (most * side) : std::numeric_limits<double>::infinity();
}

}  // namespace lightwell::render
