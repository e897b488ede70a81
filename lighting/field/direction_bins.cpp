// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/direction_bins.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "lighting/harmonics.h"
#include "lighting/result.h"

namespace lightwell {
namespace {

constexpr int kPiecesACell =
    3;  // along a side: a picture's pixel is cut so that cells are this many pieces wide
constexpr int kMostPieces = 512;   // of a pixel, along a side: an image of one pixel still reaches every cell
constexpr double kStep_px = 1e-3;  // of the differences that give a place's solid angle

// A small piece of a pixel: where it looks, and how much of the sphere it sees.
struct Piece {
  std::uint32_t pixel;
  int cell;
  ProbeRay ray;
  double solid_angle_sr;
};

// How a place's direction moves with the place, a pixel; one-sided at the edge of what is seen, zero where that is no wider
// than a step.
struct Slopes {
  Vec3d along_x = Vec3d::Zero(), along_y = Vec3d::Zero();
};

class Picture {
 public:
  Picture(const ProbeProjection& projection, int width, int height)
      : projection_(projection), width_(width), height_(height) {}

  [[nodiscard]] std::optional<ProbeRay> ray(double x, double y) const {
    return ray_of(projection_, width_, height_, x, y);
  }
  [[nodiscard]] Slopes slopes(double x, double y, const ProbeRay& here) const {
    return {slope(x, y, kStep_px, 0, here), slope(x, y, 0, kStep_px, here)};
  }

 private:
  [[nodiscard]] Vec3d slope(double x, double y, double dx, double dy, const ProbeRay& here) const {
    const auto before = ray(x - dx, y - dy), after = ray(x + dx, y + dy);
    const int steps = (before ? 1 : 0) + (after ? 1 : 0);
    if (steps == 0) return Vec3d::Zero();
    return (after.value_or(here).direction - before.value_or(here).direction) / (steps * kStep_px);
  }
  const ProbeProjection& projection_;
  int width_, height_;
};

// Into how many pieces a pixel is cut along each side. Its corners are asked too: at a ball's rim or a map's pole the
// middle alone says little.
int pieces_of(const Picture& picture, int x, int y, double cell_width_rad) {
  double fastest = 0;
  for (const Vec2d& part :
       {Vec2d(0.5, 0.5), Vec2d(0.02, 0.02), Vec2d(0.98, 0.02), Vec2d(0.02, 0.98), Vec2d(0.98, 0.98)})
    if (const auto ray = picture.ray(x + part.x(), y + part.y())) {
      const Slopes slopes = picture.slopes(x + part.x(), y + part.y(), *ray);
      fastest = std::max({fastest, slopes.along_x.norm(), slopes.along_y.norm()});
    }
  return std::clamp(static_cast<int>(std::ceil(kPiecesACell * fastest / cell_width_rad)), 1, kMostPieces);
}

void add_pixel(const Picture& picture, const SpherePartition& partition, int x, int y, std::uint32_t pixel,
               std::vector<Piece>& out) {
  const int pieces = pieces_of(picture, x, y, partition.cell_width_rad());
  const double side = 1.0 / pieces;
  for (int j = 0; j < pieces; ++j)
    for (int i = 0; i < pieces; ++i) {
      const double px = x + (i + 0.5) * side, py = y + (j + 0.5) * side;
      const auto ray = picture.ray(px, py);
      if (!ray) continue;
      const Slopes slopes = picture.slopes(px, py, *ray);
      const double solid_angle = slopes.along_x.cross(slopes.along_y).norm() * side * side;
      if (solid_angle > 0) out.push_back({pixel, partition.cell_of(ray->direction), *ray, solid_angle});
    }
}

}  // namespace

DirectionBins::DirectionBins(const ProbeProjection& projection, int width, int height, int cells, int degree)
    : pixels_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {
  const SpherePartition partition(cells);
  const Picture picture(projection, width, height);
  std::vector<Piece> pieces;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      add_pixel(picture, partition, x, y, static_cast<std::uint32_t>(y * width + x), pieces);
  std::stable_sort(pieces.begin(), pieces.end(),
                   [](const Piece& a, const Piece& b) { return a.cell < b.cell; });

  std::vector<Eigen::VectorXd> columns;
  Eigen::VectorXd values(harmonic_count(degree));
  for (std::size_t begin = 0; begin < pieces.size();) {
    std::size_t end = begin;
    MeasuredDirection mean{Vec3d::Zero()};
    Eigen::VectorXd column = Eigen::VectorXd::Zero(values.size());
    for (; end < pieces.size() && pieces[end].cell == pieces[begin].cell; ++end) {
      const Piece& piece = pieces[end];
      mean.solid_angle_sr += piece.solid_angle_sr;
      mean.direction += piece.solid_angle_sr * piece.ray.direction;
      mean.origin += piece.solid_angle_sr * piece.ray.origin;
      lightwell::harmonics(piece.ray.direction, degree, values.data());
      column += piece.solid_angle_sr * values;
    }
    first_share_.push_back(shares_.size());
    for (std::size_t i = begin; i < end; ++i) {  // pieces of a pixel stand together
      const auto weight = static_cast<float>(pieces[i].solid_angle_sr / mean.solid_angle_sr);
      if (i > begin && pieces[i].pixel == pieces[i - 1].pixel)
        shares_.back().weight += weight;
      else
        shares_.push_back({pieces[i].pixel, weight});
    }
    mean.direction.normalize();
    mean.origin /= mean.solid_angle_sr;
    directions_.push_back(mean);
    columns.push_back(std::move(column));
    begin = end;
  }
  first_share_.push_back(shares_.size());
  harmonics_.resize(values.size(), static_cast<Eigen::Index>(columns.size()));
  for (std::size_t d = 0; d < columns.size(); ++d) harmonics_.col(static_cast<Eigen::Index>(d)) = columns[d];
  if (const auto* ball = std::get_if<MirrorBallProbe>(&projection))
    fill_blind_cone(*ball, partition.cell_width_rad() / kPiecesACell, degree);
}

// Pieces, their copy for sorting and room to grow were measured at 970 bytes a cell; harmonics are there twice.
double DirectionBins::bytes_needed(int cells, int degree) {
  return cells * (1000.0 + 2 * sizeof(double) * harmonic_count(degree));
}

double DirectionBins::coverage() const {
  double seen = 0;
  for (const MeasuredDirection& direction : directions_) seen += direction.solid_angle_sr;
  return std::min(1.0, seen / (4 * kPi));
}

// The cone about −Z in rings of pieces, each given to the nearest direction that is seen.
void DirectionBins::fill_blind_cone(const MirrorBallProbe& ball, double step_rad, int degree) {
  const double cone_rad = blind_cone_rad(ball);
  const int rings = static_cast<int>(std::ceil(cone_rad / step_rad));
  if (rings == 0 || directions_.empty()) return;
  // Only those at the rim can be nearest: within a cell's diagonal or so of the cone.
  std::vector<std::size_t> rim;
  double lowest = 1;
  for (const MeasuredDirection& d : directions_) lowest = std::min(lowest, d.direction.z());
  for (std::size_t d = 0; d < directions_.size(); ++d)
    if (std::acos(std::clamp(-directions_[d].direction.z(), -1.0, 1.0)) <
        std::acos(std::clamp(-lowest, -1.0, 1.0)) + 2 * cone_rad)
      rim.push_back(d);
  Eigen::VectorXd values(harmonic_count(degree));
  for (int ring = 0; ring < rings; ++ring) {
    const double inner = cone_rad * ring / rings, outer = cone_rad * (ring + 1) / rings;
    const double middle = (inner + outer) / 2;
    const int count = 3 * (2 * ring + 1);
    const double solid_angle = 2 * kPi * (std::cos(inner) - std::cos(outer)) / count;
    for (int i = 0; i < count; ++i) {
      const double turn = 2 * kPi * (i + 0.5) / count;
      const Vec3d direction(std::sin(middle) * std::cos(turn), std::sin(middle) * std::sin(turn),
                            -std::cos(middle));
      const auto nearest = *std::max_element(rim.begin(), rim.end(), [&](std::size_t a, std::size_t b) {
        return directions_[a].direction.dot(direction) < directions_[b].direction.dot(direction);
      });
      lightwell::harmonics(direction, degree, values.data());
      harmonics_.col(static_cast<Eigen::Index>(nearest)) += solid_angle * values;
    }
  }
}

void DirectionBins::mean_radiance(std::span<const Rgb> pixels, std::span<Rgb> out) const {
  verify_bug(pixels.size() == pixels_ && out.size() == directions_.size(),
             "a picture of the size of the bins");
  for (std::size_t d = 0; d < directions_.size(); ++d) {
    Rgb sum = Rgb::Zero();
    float unseen = 0;
    for (std::size_t i = first_share_[d]; i < first_share_[d + 1]; ++i) {
      const Rgb& pixel = pixels[shares_[i].pixel];
      if (std::isnan(pixel.x()))
        unseen += shares_[i].weight;
      else
        sum += shares_[i].weight * pixel;
    }
    if (unseen > 0.5f)
      sum.setConstant(std::numeric_limits<float>::quiet_NaN());
    else if (unseen > 0)
      sum /= 1 - unseen;
    out[d] = sum;
  }
}

}  // namespace lightwell
