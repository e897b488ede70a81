// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/lens/lens_start.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>
#include <random>

#include "calibration/lens/target_pose.h"
#include "lighting/median.h"

namespace lightwell::calibration {
namespace {

using Row9 = Eigen::Matrix<double, 9, 1>;
using Matrix9 = Eigen::Matrix<double, 9, 9>;

Vec2d middle_of(const std::array<int, 2>& size) {
  return {(size[0] - 1) / 2.0, (size[1] - 1) / 2.0};
}
double half_size(const std::array<int, 2>& size) {
  return std::max(size[0], size[1]) / 2.0;
}

// The rows (x, y, 1) ⊗ (a, b, 1) of pixels and places on the target's plane, both scaled to about 1.
std::vector<Row9> radial_rows(const TargetView& view, const std::array<int, 2>& size) {
  Vec3d centre = Vec3d::Zero();
  for (const auto& p : view.points) centre += p.target_mm / static_cast<double>(view.points.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const auto& p : view.points) spread += (p.target_mm - centre) * (p.target_mm - centre).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(spread);
  const double scale = std::sqrt(eigen.eigenvalues()[2] / static_cast<double>(view.points.size()));
  std::vector<Row9> rows;
  if (!(scale > 0) || eigen.eigenvalues()[0] > 1e-4 * eigen.eigenvalues()[2])
    return rows;  // flat targets only
  for (const auto& p : view.points) {
    const Vec2d m = (p.pixel - middle_of(size)) / half_size(size);
    const Vec3d local = (p.target_mm - centre) / scale;
    const Vec3d x(local.dot(eigen.eigenvectors().col(2)), local.dot(eigen.eigenvectors().col(1)), 1);
    Row9 row;
    row << m.x() * x, m.y() * x, x;
    rows.push_back(row);
  }
  return rows;
}

Matrix9 normal_matrix(const std::vector<Row9>& rows, const std::vector<std::size_t>& which) {
  Matrix9 normal = Matrix9::Zero();
  for (const std::size_t i : which) normal += rows[i] * rows[i].transpose();
  return normal;
}

Row9 least(const Matrix9& normal) {
  return Eigen::SelfAdjointEigenSolver<Matrix9>(normal).eigenvectors().col(0);
}

// Radial fundamental matrix of one view, the best half of its points deciding (least median of squares).
std::optional<Eigen::Matrix3d> radial_fundamental(const std::vector<Row9>& rows) {
  constexpr std::size_t kSize = 8;
  if (rows.size() < 2 * kSize) return {};
  std::mt19937 random(1);
  std::vector<std::size_t> order(rows.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  const auto errors = [&](const Row9& f) {
    std::vector<double> e;
    for (const Row9& row : rows) e.push_back(std::abs(row.dot(f)));
    return e;
  };
  Row9 best = least(normal_matrix(rows, order));
  double best_median = median(errors(best));
  constexpr int kSamples = 40;  // one without a wrong point in 99.9 % of the cases with every tenth wrong
  for (int s = 0; s < kSamples; ++s) {
    for (std::size_t i = 0; i < kSize; ++i) std::swap(order[i], order[i + random() % (order.size() - i)]);
    const Row9 f = least(normal_matrix(rows, {order.begin(), order.begin() + kSize}));
    if (const double m = median(errors(f)); m < best_median) {
      best_median = m;
      best = f;
    }
  }
  const std::vector<double> e = errors(best);
  std::vector<std::size_t> good;
  for (std::size_t i = 0; i < e.size(); ++i)
    if (e[i] <= 4 * best_median) good.push_back(i);
  const Row9 f = least(normal_matrix(rows, good));
  Eigen::Matrix3d out;
  out << f.segment<3>(0).transpose(), f.segment<3>(3).transpose(), f.segment<3>(6).transpose();
  return out;
}

// The epipole of matrices that share it: the direction that all of them send to 0 from the left.
std::optional<Vec2d> epipole(const Eigen::Matrix3d& squares, const std::array<int, 2>& size) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(squares);
  const Vec3d e = eigen.eigenvectors().col(0);
  if (std::abs(e.z()) < 1e-6) return {};
  const Vec2d center = middle_of(size) + half_size(size) * e.head<2>() / e.z();
  // A lens off its sensor by more than a quarter of it is an accident of the numbers.
  if ((center - middle_of(size)).cwiseAbs().maxCoeff() > 0.5 * half_size(size)) return {};
  return center;
}

// How far a target seen through the lens is from a target: the mean over the views of the median error in
// radians, each error cut at `cut` so that a view that fits nowhere does not decide.
double misfit(const Lens& lens, const std::vector<TargetView>& views) {
  constexpr double kCut = 0.2;
  double sum = 0;
  for (const TargetView& view : views) {
    const auto pose = pose_from_rays(lens, view.points);
    double error = kCut;
    if (pose) {
      const Eigen::Matrix3d rotation = pose->camera_from_target();
      std::vector<Vec3d> rays;
      std::vector<double> angles;
      Vec3d mean = Vec3d::Zero();
      for (const auto& p : view.points) {
        const Vec3d seen = rotation * p.target_mm + pose->translation_mm;
        rays.push_back(lens.unproject(p.pixel));
        angles.push_back(std::atan2(seen.cross(rays.back()).norm(), seen.dot(rays.back())));
        mean += rays.back() / static_cast<double>(view.points.size());
      }
      // Against the target's own angular size: far targets look good through any lens.
      double size = 1e-6;
      for (const Vec3d& ray : rays) size = std::max(size, (ray - mean).norm());
      error = std::min(kCut, median(angles) / size);
    }
    sum += error;
  }
  return sum / static_cast<double>(views.size());
}

// The views with the most points, and every n-th point of them: enough to rank starts by.
std::vector<TargetView> telling_views(const TargetViews& target_views) {
  constexpr std::size_t kMostViews = 10, kMostPoints = 40;
  std::vector<TargetView> views = target_views.views;
  std::stable_sort(views.begin(), views.end(),
                   [](const auto& a, const auto& b) { return a.points.size() > b.points.size(); });
  views.resize(std::min(views.size(), kMostViews));
  for (TargetView& view : views) {
    const std::size_t step = (view.points.size() + kMostPoints - 1) / kMostPoints;
    std::vector<Correspondence> points;
    for (std::size_t i = 0; i < view.points.size(); i += step) points.push_back(view.points[i]);
    view.points = std::move(points);
  }
  return views;
}

}  // namespace

std::vector<Vec2d> distortion_centers(const TargetViews& target_views) {
  std::vector<Vec2d> single, out;
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  for (const TargetView& view : target_views.views) {
    const auto f = radial_fundamental(radial_rows(view, target_views.image_size));
    if (!f) continue;
    squares += *f * f->transpose() / f->squaredNorm();
    if (const auto e = epipole(*f * f->transpose(), target_views.image_size)) single.push_back(*e);
  }
  if (single.size() >= 3) {
    std::vector<double> x, y;
    for (const Vec2d& c : single) {
      x.push_back(c.x());
      y.push_back(c.y());
    }
    out.emplace_back(median(x), median(y));
  }
  if (const auto all = epipole(squares, target_views.image_size); all && !squares.isZero())
    out.push_back(*all);
  out.push_back(middle_of(target_views.image_size));
  return out;
}

std::vector<Lens> lens_starts(const TargetViews& target_views, std::size_t count) {
  const std::vector<TargetView> views = telling_views(target_views);
  // First terms of tan, 2 tan(θ/2), θ, 2 sin(θ/2), sin θ; tan is kept from running away.
  constexpr double kProjections[] = {0.15, 1.0 / 12, 0, -1.0 / 24, -1.0 / 9};
  constexpr double kFieldDeg[] = {8, 12, 18, 26, 36, 48, 60, 72, 84, 96, 108, 120, 135};
  struct Ranked {
    double misfit;
    Lens lens;
  };
  std::vector<Ranked> ranked;
  for (const Vec2d& center : distortion_centers(target_views)) {
    double radius = 0;
    for (const TargetView& view : views) {
      std::vector<double> distance;
      for (const auto& p : view.points) distance.push_back((p.pixel - center).norm());
      radius = std::max(radius, median(distance));
    }
    for (const double k1 : kProjections)
      for (const double field_deg : kFieldDeg) {
        Lens lens;
        lens.image_size = target_views.image_size;
        lens.center = center;
        lens.k = {k1, 0, 0, 0};
        lens.max_theta_rad = kPi;
        const double theta = field_deg * kPi / 180;
        if (k1 < 0) lens.max_theta_rad = 0.999 * std::sqrt(-1 / (3 * k1));  // where its slope ends
        if (theta >= lens.max_theta_rad) continue;
        lens.focal.setConstant(radius / (theta * (1 + k1 * theta * theta)));
        ranked.push_back({misfit(lens, views), lens});
      }
  }
  std::stable_sort(ranked.begin(), ranked.end(),
                   [](const auto& a, const auto& b) { return a.misfit < b.misfit; });
  // Neighbours on the grid end in the same place: every start differs from those before it.
  std::vector<Lens> out;
  for (const Ranked& r : ranked) {
    const bool near = std::any_of(out.begin(), out.end(), [&](const Lens& lens) {
      return std::abs(std::log(lens.focal.x() / r.lens.focal.x())) < 0.25 &&
             (lens.center - r.lens.center).norm() < 2;
    });
    if (!near) out.push_back(r.lens);
    if (out.size() == count) break;
  }
  return out;
}

}  // namespace lightwell::calibration
