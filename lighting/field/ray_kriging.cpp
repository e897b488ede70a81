// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/ray_kriging.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace lightwell {
namespace {

constexpr double kPower = 1.5;
// Variance of a measured value, relative to that of the light over the usual distance of two places.
constexpr double kNugget = 1e-4;
// Below this a double's rounding would tell places apart. Relative to the variance over the spread, as all that follows.
constexpr double kLeastNugget = 1e-10;
constexpr double kSlope = 2;  // variance of the mean slope over the spread
// Any number that makes the covariance positive definite: it falls out with the unknown mean.
constexpr double kLevel = 10;

Vec2d across_m(const Vec3d& offset, const Vec3d& u, const Vec3d& v) {
  return {offset.dot(u), offset.dot(v)};
}

Eigen::MatrixXd rays_of(const Vec3d& direction, std::span<const Vec3d> positions) {
  const Vec3d u = direction.unitOrthogonal(), v = direction.cross(u);
  Eigen::MatrixXd rays(2, static_cast<Eigen::Index>(positions.size()));
  for (std::size_t n = 0; n < positions.size(); ++n)
    rays.col(static_cast<Eigen::Index>(n)) = across_m(positions[n], u, v);
  return rays;
}

// Distance of two places of one neighbourhood: the first quartile, so that neither few far places nor two neighbourhoods
// far apart count. 0 where no two places differ.
double usual_distance(const Eigen::MatrixXd& places) {
  std::vector<double> distances;
  for (Eigen::Index i = 0; i < places.cols(); ++i)
    for (Eigen::Index j = 0; j < i; ++j)
      if (const double distance = (places.col(i) - places.col(j)).norm(); distance > 0)
        distances.push_back(distance);
  if (distances.empty()) return 0;
  const auto quartile = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 4);
  std::nth_element(distances.begin(), quartile, distances.end());
  return *quartile;
}

}  // namespace

double Kriging::covariance(double distance, double product) const {
  return kLevel - std::pow(distance / spread_, kPower) + kSlope * product / (spread_ * spread_);
}

Kriging::Kriging(const Eigen::MatrixXd& places)
    : centre_(places.rowwise().mean()), places_(places.colwise() - centre_) {
  const Eigen::Index count = places.cols();
  spread_ = std::sqrt(places_.colwise().squaredNorm().mean());
  if (!(spread_ > 0)) spread_ = 1;
  Eigen::MatrixXd covariances(count, count);
  for (Eigen::Index i = 0; i < count; ++i)
    for (Eigen::Index j = 0; j < count; ++j)
      covariances(i, j) =
          covariance((places_.col(i) - places_.col(j)).norm(), places_.col(i).dot(places_.col(j)));
  const double usual = std::min(usual_distance(places_) / spread_, 1.0);
  covariances.diagonal().array() += std::max(kNugget * std::pow(usual, kPower), kLeastNugget);
  const Eigen::MatrixXd inverse = covariances.ldlt().solve(Eigen::MatrixXd::Identity(count, count));
  mean_ = inverse.rowwise().sum();
  const double total = mean_.sum();
  mean_ /= total;
  precision_ = inverse - total * mean_ * mean_.transpose();
}

Eigen::VectorXd Kriging::weights(const Eigen::VectorXd& at) const {
  const Eigen::VectorXd offset = at - centre_;
  Eigen::VectorXd covariances(places_.cols());
  for (Eigen::Index i = 0; i < places_.cols(); ++i)
    covariances[i] = covariance((offset - places_.col(i)).norm(), offset.dot(places_.col(i)));
  return precision_ * covariances + mean_;
}

Eigen::MatrixXd Kriging::completion(const Eigen::VectorXd& given) const {
  const Eigen::Index count = given.size();
  Eigen::MatrixXd result = Eigen::MatrixXd::Identity(count, count);
  if (!(given.maxCoeff() > 0)) return result;
  // Where all count little, they are still all that is known: to fade together must not make the light smoother.
  const Eigen::VectorXd weights = given / given.maxCoeff();
  std::vector<Eigen::Index> open;
  for (Eigen::Index i = 0; i < count; ++i)
    if (weights[i] < 1) open.push_back(i);
  if (open.empty()) return result;
  // The likeliest values: least valuesᵀ P values + Σ P_ii w / (1 − w) (value − measured)², those that count 1 held.
  Eigen::MatrixXd system(open.size(), open.size());
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(open.size()), count);
  for (std::size_t a = 0; a < open.size(); ++a) {
    const auto row = static_cast<Eigen::Index>(a);
    const Eigen::Index i = open[a];
    for (std::size_t b = 0; b < open.size(); ++b)
      system(row, static_cast<Eigen::Index>(b)) = precision_(i, open[b]);
    for (Eigen::Index j = 0; j < count; ++j)
      if (!(weights[j] < 1)) right(row, j) = -precision_(i, j);
    // Of the order of what is known of the value from the others, so that it fades evenly; never 0, which would leave a
    // single place without a value.
    const double trust = std::max(precision_(i, i), 1e-9) * weights[i] / (1 - weights[i]);
    system(row, row) += trust;
    right(row, i) = trust;
  }
  const Eigen::MatrixXd solved = system.ldlt().solve(right);
  for (std::size_t a = 0; a < open.size(); ++a)
    result.row(open[a]) = solved.row(static_cast<Eigen::Index>(a));
  return result;
}

RayKriging::RayKriging(const FieldGrid& grid, const Vec3d& direction, std::span<const Vec3d> positions)
    : plane(grid, direction, 1), kriging(rays_of(direction, positions)) {
  const Vec3d u = direction.unitOrthogonal(), v = direction.cross(u);
  const auto count = static_cast<Eigen::Index>(positions.size());
  std::vector<Vec2d> crossings;  // of the rays, in cells
  for (const Vec3d& position : positions)
    crossings.push_back(plane.across(plane.pixel_of(grid.grid_from_world(position))));
  // Any point of the middle slice: where pixel (0, 0) lies is what pixel_of says of it.
  Vec3d middle = Vec3d::Zero();
  const auto main = static_cast<std::size_t>(plane.axes()[2]);
  middle[plane.axes()[2]] = (grid.size[main] - 1) / 2.0;
  const Vec2d start = plane.pixel_of(middle);
  weights.resize(Eigen::Index{plane.width()} * plane.height(), count);
  square_cells.resize(weights.rows(), count);
  for (int y = 0; y < plane.height(); ++y)
    for (int x = 0; x < plane.width(); ++x) {
      const Vec2d pixel(x, y);
      Vec3d at = middle;
      for (std::size_t a = 0; a < 2; ++a)
        at[plane.axes()[a]] = pixel[static_cast<Eigen::Index>(a)] - start[static_cast<Eigen::Index>(a)];
      const Vec3d world = grid.low + grid.cell().cwiseProduct(at);
      const Eigen::Index row = Eigen::Index{y} * plane.width() + x;
      weights.row(row) = kriging.weights(across_m(world, u, v)).transpose().cast<float>();
      for (Eigen::Index n = 0; n < count; ++n)
        square_cells(row, n) =
            static_cast<float>((plane.across(pixel) - crossings[static_cast<std::size_t>(n)]).squaredNorm());
    }
}

}  // namespace lightwell
