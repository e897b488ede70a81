// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <cmath>

#include "render/scene_writer.h"

namespace lightwell::render {
namespace {

float turn(int i, int count) {
  return static_cast<float>(2 * kPi * (i % count) / count);
}

// Joins steps × sides points, both running round, into a closed tube.
void close_tube(Mesh& m, std::uint32_t steps, std::uint32_t sides) {
  for (std::uint32_t i = 0; i < steps; ++i)
    for (std::uint32_t k = 0; k < sides; ++k) {
      const std::uint32_t i2 = (i + 1) % steps;
      const std::uint32_t k2 = (k + 1) % sides;
      m.quad(i * sides + k, i * sides + k2, i2 * sides + k2, i2 * sides + k);
    }
}

}  // namespace

std::uint32_t Mesh::add(const Vec3f& position, const Vec3f& normal) {
  positions.push_back(position);
  normals.push_back(normal.normalized());
  return static_cast<std::uint32_t>(positions.size()) - 1;
}

void Mesh::quad(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
  indices.insert(indices.end(), {a, b, c, a, c, d});
}

Mesh ground_mesh(float half_side) {
  Mesh m;
  for (const auto& [x, z] : {std::pair(-1, -1), std::pair(-1, 1), std::pair(1, 1), std::pair(1, -1)})
    m.add(Vec3f(static_cast<float>(x), 0, static_cast<float>(z)) * half_side, Vec3f::UnitY());
  m.quad(0, 1, 2, 3);
  return m;
}

Mesh sphere_mesh(const Vec3f& centre, float radius, int rings, int sectors) {
  Mesh m;
  const auto s = static_cast<std::uint32_t>(sectors);
  m.add(centre + radius * Vec3f::UnitY(), Vec3f::UnitY());
  for (int r = 1; r < rings; ++r)
    for (int i = 0; i < sectors; ++i) {
      const float theta = static_cast<float>(kPi * r / rings);
      const Vec3f n(std::sin(theta) * std::sin(turn(i, sectors)), std::cos(theta),
                    std::sin(theta) * std::cos(turn(i, sectors)));
      m.add(centre + radius * n, n);
    }
  const std::uint32_t south = m.add(centre - radius * Vec3f::UnitY(), -Vec3f::UnitY());
  for (std::uint32_t i = 0; i < s; ++i) {
    const std::uint32_t next = (i + 1) % s;
    m.indices.insert(m.indices.end(), {0, 1 + i, 1 + next});
    for (std::uint32_t r = 0; r + 2 < static_cast<std::uint32_t>(rings); ++r)
      m.quad(1 + r * s + i, 1 + (r + 1) * s + i, 1 + (r + 1) * s + next, 1 + r * s + next);
    m.indices.insert(m.indices.end(), {south, south - s + next, south - s + i});
  }
  return m;
}

void add_bar(Mesh& m, const Vec3f& from, const Vec3f& to, float radius, int sides) {
  const Vec3f axis = (to - from).normalized();
  const Vec3f u = axis.unitOrthogonal();
  const Vec3f v = axis.cross(u);
  const auto base = static_cast<std::uint32_t>(m.positions.size());
  for (int i = 0; i < sides; ++i) {
    const Vec3f n = std::cos(turn(i, sides)) * u + std::sin(turn(i, sides)) * v;
    for (const bool side : {true, false}) {  // one corner for the side, one for the cap
      m.add(from + radius * n, side ? n : Vec3f(-axis));
      m.add(to + radius * n, side ? n : axis);
    }
  }
  const std::uint32_t bottom = m.add(from, -axis);
  const std::uint32_t top = m.add(to, axis);
  for (int i = 0; i < sides; ++i) {
    const std::uint32_t a = base + 4 * static_cast<std::uint32_t>(i);
    const std::uint32_t b = base + 4 * static_cast<std::uint32_t>((i + 1) % sides);
    m.quad(a, b, b + 1, a + 1);
    m.indices.insert(m.indices.end(), {bottom, b + 2, a + 2, top, a + 3, b + 3});
  }
}

void add_capsule(Mesh& m, const Vec3f& from, const Vec3f& to, float radius, int rings, int sides) {
  const Vec3f axis = (to - from).normalized();
  const Vec3f u = axis.unitOrthogonal();
  const Vec3f v = axis.cross(u);
  const auto s = static_cast<std::uint32_t>(sides);
  const std::uint32_t first = m.add(from - radius * axis, -axis);
  // Rows from the first end to the last: rings on each half sphere, both equators among them.
  for (int row = 1; row <= 2 * rings; ++row) {
    const bool upper = row > rings;
    const auto angle =
        static_cast<float>(kPi / 2 * (upper ? row - rings - 1 : row - rings) / static_cast<double>(rings));
    for (int i = 0; i < sides; ++i) {
      const Vec3f across = std::cos(turn(i, sides)) * u + std::sin(turn(i, sides)) * v;
      const Vec3f n = std::cos(angle) * across + std::sin(angle) * axis;
      m.add((upper ? to : from) + radius * n, n);
    }
  }
  const std::uint32_t last = m.add(to + radius * axis, axis);
  for (std::uint32_t i = 0; i < s; ++i) {
    const std::uint32_t next = (i + 1) % s;
    m.indices.insert(m.indices.end(), {first, first + 1 + next, first + 1 + i});
    for (std::uint32_t row = 0; row + 1 < 2 * static_cast<std::uint32_t>(rings); ++row) {
      const std::uint32_t a = first + 1 + row * s;
      m.quad(a + i, a + next, a + s + next, a + s + i);
    }
    m.indices.insert(m.indices.end(), {last, last - s + i, last - s + next});
  }
}

void add_box(Mesh& m, const Vec3f& low, const Vec3f& high) {
  const Vec3f middle = (low + high) / 2;
  for (int axis = 0; axis < 3; ++axis)
    for (const float side : {-1.0f, 1.0f}) {
      const Vec3f n = side * Vec3f::Unit(axis);
      const Vec3f u = Vec3f::Unit((axis + 1) % 3);
      const Vec3f v = n.cross(u);
      const auto corner = [&](float a, float b) {
        const Vec3f at = n + a * u + b * v;
        return m.add(middle + (at.array() * (high - low).array() / 2).matrix(), n);
      };
      const std::uint32_t a = corner(-1, -1);
      const std::uint32_t b = corner(1, -1);
      const std::uint32_t c = corner(1, 1);
      m.quad(a, b, c, corner(-1, 1));
    }
}

Mesh torus_mesh(const Vec3f& centre, const Vec3f& axis, float radius, float tube, int steps, int sides) {
  Mesh m;
  const Vec3f up = axis.normalized();
  const Vec3f u = up.unitOrthogonal();
  const Vec3f v = up.cross(u);
  for (int i = 0; i < steps; ++i) {
    const Vec3f out = std::cos(turn(i, steps)) * u + std::sin(turn(i, steps)) * v;
    for (int k = 0; k < sides; ++k) {
      const Vec3f n = std::cos(turn(k, sides)) * out - std::sin(turn(k, sides)) * up;
      m.add(centre + radius * out + tube * n, n);
    }
  }
  close_tube(m, static_cast<std::uint32_t>(steps), static_cast<std::uint32_t>(sides));
  return m;
}

Mesh knot_mesh(const Vec3f& centre, float size, float tube, int steps, int sides) {
  Mesh m;
  const auto curve = [&](int i) {
    const double t = 2 * kPi * (i % steps) / steps;
    const double r = 2 + std::cos(3 * t);
    return Vec3d(r * std::cos(2 * t), r * std::sin(2 * t), std::sin(3 * t));
  };
  for (int i = 0; i < steps; ++i) {
    const Vec3d p = curve(i);
    const Vec3d tangent = (curve(i + 1) - curve(i + steps - 1)).normalized();
    const Vec3d across = tangent.cross(p).normalized();
    const Vec3d out = across.cross(tangent);
    for (int k = 0; k < sides; ++k) {
      const double a = 2 * kPi * k / sides;
      const Vec3f n = (std::cos(a) * out + std::sin(a) * across).cast<float>();
      m.add(centre + size * p.cast<float>() + tube * n, n);
    }
  }
  close_tube(m, static_cast<std::uint32_t>(steps), static_cast<std::uint32_t>(sides));
  return m;
}

}  // namespace lightwell::render
