// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/light_lists.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "render/shaders.h"

namespace lightwell::render {
namespace {

// A normal on a cell's border may be taken for the neighbour's by rounding, of 1e-6.
constexpr float kBorder_rad = 0.001f;

struct Cell {
  Vec3f middle;
  float least;  // cosine of a light's angle from the middle, from which on it reaches no normal of the cell
};

// across, up: of the face, in [-1, 1]
Vec3f on_cube(int face, float across, float up) {
  const float along = face % 2 == 0 ? 1.0f : -1.0f;
  switch (face / 2) {
    case 0:
      return Vec3f(along, across, up).normalized();
    case 1:
      return Vec3f(up, along, across).normalized();
    default:
      return Vec3f(across, up, along).normalized();
  }
}

Cell make_cell(int index) {
  constexpr int kSide = LightLists::kSide;
  const int face = index / (kSide * kSide);
  const auto at = [&](float x, float y) {
    const auto place = [](float k) { return 2 * k / kSide - 1; };
    return on_cube(face, place(static_cast<float>(index % kSide) + x),
                   place(static_cast<float>(index / kSide % kSide) + y));
  };
  Cell cell{at(0.5f, 0.5f), 0};
  float radius = 0;
  for (const float x : {0.0f, 1.0f})
    for (const float y : {0.0f, 1.0f})
      radius = std::max(radius, std::acos(std::min(cell.middle.dot(at(x, y)), 1.0f)));
  cell.least = -std::sin(radius + kBorder_rad);
  return cell;
}

const std::array<Cell, LightLists::kCells>& cells() {
  static const auto all = [] {
    std::array<Cell, LightLists::kCells> made;
    for (int i = 0; i < LightLists::kCells; ++i) made[static_cast<std::size_t>(i)] = make_cell(i);
    return made;
  }();
  return all;
}

// One cell's row of the table. subset_of: each weak light's
void list(const Cell& cell, std::span<const LightRow> rows, std::size_t strong, std::size_t subsets,
          std::span<const std::uint8_t> subset_of, std::span<std::uint16_t> row) {
  std::size_t count = 0, strong_count = 0;
  std::array<std::uint16_t, LightLists::kMostSubsets>
      next{};  // of each subset: how many, then where the next one goes
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const float* d = rows[i].to_light;
    if (cell.middle[0] * d[0] + cell.middle[1] * d[1] + cell.middle[2] * d[2] <= cell.least) continue;
    row[LightLists::kListed + count++] = static_cast<std::uint16_t>(i);
    if (i < strong)
      ++strong_count;
    else
      ++next[subset_of[i]];
  }
  row[0] = static_cast<std::uint16_t>(count);
  row[1] = static_cast<std::uint16_t>(strong_count);
  std::uint16_t begin = 0;
  for (std::size_t subset = 0; subset < subsets; ++subset) {
    row[2 + subset] = begin;
    begin = static_cast<std::uint16_t>(begin + std::exchange(next[subset], begin));
  }
  row[2 + subsets] = begin;
  for (const std::uint16_t i : row.subspan(LightLists::kListed + strong_count, count - strong_count))
    row[LightLists::kGrouped + static_cast<std::size_t>(next[subset_of[i]]++)] = i;
}

}  // namespace

std::vector<std::uint16_t> LightLists::table(std::span<const LightRow> rows, std::size_t strong,
                                             int subsets) {
  std::vector<std::uint16_t> all(static_cast<std::size_t>(kCells) * kColumns);
  std::vector<std::uint8_t> subset_of(rows.size());
  for (std::size_t i = strong; i < rows.size(); ++i)
    subset_of[i] = static_cast<std::uint8_t>((i - strong) % static_cast<std::size_t>(subsets));
  std::span<std::uint16_t> left(all);
  for (const Cell& cell : cells()) {
    list(cell, rows, strong, static_cast<std::size_t>(subsets), subset_of, left.first(kColumns));
    left = left.subspan(kColumns);
  }
  return all;
}

int LightLists::cell_of(const Vec3f& normal) {
  const Vec3f a = normal.cwiseAbs();
  const int axis = a.x() >= std::max(a.y(), a.z()) ? 0 : a.y() >= a.z() ? 1 : 2;
  const float along = normal[axis];
  const auto place = [&](float x) {
    return std::min(static_cast<int>((x / std::abs(along) * 0.5f + 0.5f) * kSide), kSide - 1);
  };
  const int face = 2 * axis + (along < 0 ? 1 : 0);
  return (face * kSide + place(normal[(axis + 2) % 3])) * kSide + place(normal[(axis + 1) % 3]);
}

std::string LightLists::facts() {
  return "#define LIST_SIDE " + std::to_string(kSide) + "\n#define LISTED " + std::to_string(kListed) +
         "\n#define GROUPED " + std::to_string(kGrouped) + "\n" +
         std::string(shader_text("light_lists.glsl"));
}

void LightLists::set(std::span<const LightRow> rows, std::size_t strong, int subsets) {
  std::vector<std::array<float, 3>> directions;
  directions.reserve(rows.size());
  for (const LightRow& row : rows) directions.push_back({row.to_light[0], row.to_light[1], row.to_light[2]});
  if (texture_.id() != 0 && directions == listed_ && strong == strong_ && subsets == subsets_) return;
  listed_ = std::move(directions);
  strong_ = strong;
  subsets_ = subsets;
  if (texture_.id() == 0) texture_ = gl::make_texture(GL_R16UI, kColumns, kCells);
  const std::vector<std::uint16_t> texels = table(rows, strong, subsets);
  glBindTexture(GL_TEXTURE_2D, texture_.id());
  glPixelStorei(GL_UNPACK_ALIGNMENT, 2);
  glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, kColumns, kCells, GL_RED_INTEGER, GL_UNSIGNED_SHORT, texels.data());
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
}

}  // namespace lightwell::render
