// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/field_sparsity.h"

#include <algorithm>
#include <cmath>

#include "lighting/result.h"

namespace lightwell {
namespace {

using Point = std::array<int, 3>;

bool on_lattice(int index, int size, int stride) {
  return index % stride == 0 || index == size - 1;
}

// The points of a lattice of this stride that the next coarser does not have.
template <class Visit>
void visit_new_points(const FieldGrid& grid, int stride, const Visit& visit) {
  const auto [nx, ny, nz] = grid.size;
  for (int z = 0; z < nz; ++z)
    for (int y = 0; y < ny; ++y)
      for (int x = 0; x < nx; ++x) {
        if (!on_lattice(x, nx, stride) || !on_lattice(y, ny, stride) || !on_lattice(z, nz, stride)) continue;
        if (on_lattice(x, nx, 2 * stride) && on_lattice(y, ny, 2 * stride) && on_lattice(z, nz, 2 * stride))
          continue;
        visit(Point{x, y, z});
      }
}

int coarsest_stride(const FieldGrid& grid) {
  int stride = 1;
  while (2 * stride < grid.longest_side()) stride *= 2;
  return stride;
}

// All harmonics and colours of one point lie a slab's plane apart.
struct PointValues {
  float* first;
  std::size_t step, count;
  [[nodiscard]] float& operator[](std::size_t i) const { return first[i * step]; }
};
PointValues values_of(LightField& field, const Point& p) {
  return {field.plane(p[2], 0, 0) + p[1] * field.grid.size[0] + p[0], field.slab_points(),
          3 * static_cast<std::size_t>(field.harmonics())};
}

// A point between the lattice points of this stride around it.
void foretell(LightField& field, const Point& p, int stride, std::vector<float>& out) {
  Point low, high;
  std::array<float, 3> part;
  for (std::size_t a = 0; a < 3; ++a) {
    low[a] = p[a] / stride * stride;
    high[a] = std::min(low[a] + stride, field.grid.size[a] - 1);
    if (p[a] == field.grid.size[a] - 1) low[a] = p[a];
    part[a] = high[a] > low[a] ? static_cast<float>(p[a] - low[a]) / static_cast<float>(high[a] - low[a]) : 0;
  }
  std::fill(out.begin(), out.end(), 0.0f);
  for (int corner = 0; corner < 8; ++corner) {
    Point at;
    float weight = 1;
    for (std::size_t a = 0; a < 3; ++a) {
      const bool upper = (corner >> a & 1) != 0;
      at[a] = upper ? high[a] : low[a];
      weight *= upper ? part[a] : 1 - part[a];
    }
    if (weight <= 0) continue;
    const PointValues values = values_of(field, at);
    for (std::size_t i = 0; i < out.size(); ++i) out[i] += weight * values[i];
  }
}

std::size_t index_of(const FieldGrid& grid, const Point& p) {
  return static_cast<std::size_t>((p[2] * grid.size[1] + p[1]) * grid.size[0] + p[0]);
}

}  // namespace

std::vector<std::uint8_t> stored_points(const LightField& field, double bound) {
  std::vector<std::uint8_t> stored(field.grid.points(), 1);
  if (!(bound > 0)) return stored;
  double square = 0;
  for (const float value : field.radiance) square += static_cast<double>(value) * static_cast<double>(value);
  const double most = bound * bound * square / static_cast<double>(field.grid.points());
  LightField as_read = field;
  std::vector<float> foretold(3 * static_cast<std::size_t>(field.harmonics()));
  for (int stride = coarsest_stride(field.grid); stride >= 1; stride /= 2)
    visit_new_points(field.grid, stride, [&](const Point& p) {
      foretell(as_read, p, 2 * stride, foretold);
      const PointValues values = values_of(as_read, p);
      double error = 0;
      for (std::size_t i = 0; i < foretold.size(); ++i) {
        const double difference = static_cast<double>(foretold[i]) - static_cast<double>(values[i]);
        error += difference * difference;
      }
      if (error > most) return;
      stored[index_of(field.grid, p)] = 0;
      for (std::size_t i = 0; i < foretold.size(); ++i) values[i] = foretold[i];
    });
  return stored;
}

void fill_left_out(LightField& field, const std::vector<std::uint8_t>& stored) {
  verify_bug(stored.size() == field.grid.points(), "one mark a point");
  std::vector<float> foretold(3 * static_cast<std::size_t>(field.harmonics()));
  for (int stride = coarsest_stride(field.grid); stride >= 1; stride /= 2)
    visit_new_points(field.grid, stride, [&](const Point& p) {
      if (stored[index_of(field.grid, p)] != 0) return;
      foretell(field, p, 2 * stride, foretold);
      const PointValues values = values_of(field, p);
      for (std::size_t i = 0; i < foretold.size(); ++i) values[i] = foretold[i];
    });
}

}  // namespace lightwell
