// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/lens/lens_adjustment.h"

#include <ceres/ceres.h>
#include <glog/logging.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

namespace lightwell::calibration {
namespace {

// The solver's numbers: fx, fy / fx, cx, cy, k1 … k4.
using LensNumbers = std::array<double, 8>;
using PoseNumbers = std::array<double, 6>;  // angle-axis, translation

LensNumbers numbers_of(const Lens& lens, const LensFreedom& freedom) {
  LensNumbers n = {lens.focal.x(), freedom.aspect ? lens.focal.y() / lens.focal.x() : 1, lens.center.x(),
                   lens.center.y()};
  for (std::size_t i = 0; i < 4; ++i) n[4 + i] = static_cast<int>(i) < freedom.coefficients ? lens.k[i] : 0;
  return n;
}

void set_numbers(Lens& lens, const double* n) {
  lens.focal = {n[0], n[0] * n[1]};
  lens.center = {n[2], n[3]};
  std::copy(n + 4, n + 8, lens.k.begin());
}

// dfocal_dnumbers: fy = fx · aspect, all else is itself.
Eigen::Matrix<double, 8, 8> dlens_dnumbers(const Lens& lens) {
  Eigen::Matrix<double, 8, 8> j = Eigen::Matrix<double, 8, 8>::Identity();
  j(1, 0) = lens.focal.y() / lens.focal.x();
  j(1, 1) = lens.focal.x();
  return j;
}

// d(R(ω) p) = −[R p]× · left_jacobian(ω) · dω (Barfoot, State Estimation for Robotics, equation 7.77).
Eigen::Matrix3d left_jacobian(const Vec3d& rotation) {
  const double angle2 = rotation.squaredNorm();
  const Eigen::Matrix3d w = cross_matrix(rotation);
  if (angle2 < 1e-8) return Eigen::Matrix3d::Identity() + w / 2 + w * w / 6;
  const double angle = std::sqrt(angle2);
  return Eigen::Matrix3d::Identity() + (1 - std::cos(angle)) / angle2 * w +
         (angle - std::sin(angle)) / (angle2 * angle) * w * w;
}

// Cauchy's loss as a factor on the error: |factor · error|² = scale² ln(1 + |error|² / scale²).
struct CauchyFactor {
  double factor = 1;
  double slope = 0;  // by |error|²
};
CauchyFactor cauchy_factor(double scale, double error2) {
  const double x = error2 / (scale * scale);
  if (x < 1e-8) return {};  // infinite scale: least squares
  const double log = std::log1p(x);
  const double factor = std::sqrt(log / x);
  return {factor, (x / (1 + x) - log) / (2 * x * x * factor * scale * scale)};
}

// Projection less pixel of all points of one view.
class ViewCost : public ceres::CostFunction {
 public:
  ViewCost(const Lens& lens, const TargetShape& shape, const std::vector<Correspondence>& points,
           double cauchy_px)
      : lens_(lens), shape_(shape), points_(points), cauchy_px_(cauchy_px) {
    set_num_residuals(static_cast<int>(2 * points.size()));
    *mutable_parameter_block_sizes() = {8, 6, 5};
  }

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    Lens lens = lens_;
    set_numbers(lens, parameters[0]);
    const Eigen::Matrix<double, 8, 8> by_numbers = dlens_dnumbers(lens);
    const TargetPose pose{Vec3d(parameters[1]), Vec3d(parameters[1] + 3)};
    const Eigen::Matrix3d rotation = pose.camera_from_target();
    const Eigen::Matrix3d turn = left_jacobian(pose.rotation);
    const Eigen::Matrix<double, 5, 1> change(parameters[2]);
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const Eigen::Matrix<double, 3, 5> basis = shape_.basis(points_[i].target_mm);
      const Vec3d place = points_[i].target_mm + basis * change;
      const Vec3d turned = rotation * place;
      const Vec3d direction = turned + pose.translation_mm;
      if (!jacobians) {
        const Vec2d error = lens.project(direction) - points_[i].pixel;
        Eigen::Map<Vec2d>{residuals + 2 * i} = cauchy_factor(cauchy_px_, error.squaredNorm()).factor * error;
        continue;
      }
      const LensJacobian j = project_with_jacobian(lens, direction);
      const Vec2d error = j.pixel - points_[i].pixel;
      const CauchyFactor loss = cauchy_factor(cauchy_px_, error.squaredNorm());
      Eigen::Map<Vec2d>{residuals + 2 * i} = loss.factor * error;
      const Eigen::Matrix2d weighted =
          loss.factor * Eigen::Matrix2d::Identity() + 2 * loss.slope * error * error.transpose();
      if (jacobians[0])
        Eigen::Map<Eigen::Matrix<double, 2, 8, Eigen::RowMajor>>{jacobians[0] + 16 * i} =
            weighted * j.dpixel_dlens * by_numbers;
      if (jacobians[1]) {
        Eigen::Matrix<double, 2, 6> by_pose;
        by_pose << -j.dpixel_ddirection * cross_matrix(turned) * turn, j.dpixel_ddirection;
        Eigen::Map<Eigen::Matrix<double, 2, 6, Eigen::RowMajor>>{jacobians[1] + 12 * i} = weighted * by_pose;
      }
      if (jacobians[2])
        Eigen::Map<Eigen::Matrix<double, 2, 5, Eigen::RowMajor>>{jacobians[2] + 10 * i} =
            weighted * j.dpixel_ddirection * rotation * basis;
    }
    // False makes the solver try a shorter step; numbers that are not finite would end it.
    if (!finite(residuals, 1)) return false;
    constexpr int kSizes[] = {8, 6, 5};
    for (int b = 0; jacobians && b < 3; ++b)
      if (jacobians[b] && !finite(jacobians[b], kSizes[b])) return false;
    return true;
  }

 private:
  [[nodiscard]] bool finite(const double* rows, int columns) const {
    return Eigen::Map<const Eigen::VectorXd>(rows, num_residuals() * columns).allFinite();
  }

  const Lens& lens_;  // what is not solved for
  const TargetShape& shape_;
  const std::vector<Correspondence>& points_;
  double cauchy_px_;
};

// A wall where θd stops growing: nothing above the least slope, steep below it. At one angle.
class SlopeCost : public ceres::SizedCostFunction<1, 8> {
 public:
  explicit SlopeCost(double theta) : theta_(theta) {}
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    constexpr double kSteepness = 1e4;  // pixels a unit of slope: heavier than all points together
    double slope = 1, power = 1;
    std::array<double, 4> by_k{};
    for (std::size_t i = 0; i < 4; ++i) {
      power *= theta_ * theta_;
      by_k[i] = static_cast<double>(2 * i + 3) * power;
      slope += by_k[i] * parameters[0][4 + i];
    }
    const bool below = slope < kLeastSlope;
    residuals[0] = below ? kSteepness * (kLeastSlope - slope) : 0;
    if (jacobians && jacobians[0])
      for (std::size_t i = 0; i < 8; ++i) jacobians[0][i] = below && i >= 4 ? -kSteepness * by_k[i - 4] : 0;
    return true;
  }

 private:
  double theta_;
};

constexpr int kWalls = 48;

std::vector<int> held(const LensFreedom& freedom) {
  std::vector<int> out;
  if (!freedom.aspect) out.push_back(1);
  if (!freedom.center) out.insert(out.end(), {2, 3});
  for (int i = freedom.coefficients; i < 4; ++i) out.push_back(4 + i);
  return out;
}

double squared_error(const Lens& lens, const TargetShape& shape, const std::vector<PosedView>& views) {
  double sum = 0;
  for (const PosedView& view : views) {
    std::vector<Correspondence> points = view.points;
    for (auto& p : points) p.target_mm = shape.place(p.target_mm);
    for (const double e : errors_px(lens, view.pose, points)) sum += e * e;
  }
  return sum;
}

// Ceres logs a step that cannot be computed whatever its logging type is; that it failed is in its summary.
class QuietLog {
 public:
  QuietLog() { FLAGS_minloglevel = google::GLOG_FATAL; }
  ~QuietLog() { FLAGS_minloglevel = before_; }
  QuietLog(const QuietLog&) = delete;
  QuietLog& operator=(const QuietLog&) = delete;

 private:
  int before_ = FLAGS_minloglevel;
};

}  // namespace

LeastGrowth least_growth(const Lens& lens, double to_rad) {
  LeastGrowth least;
  for (int i = 1; i <= kWalls; ++i) {
    const double theta = to_rad * i / kWalls;
    double slope = 1, power = 1;
    for (std::size_t k = 0; k < 4; ++k) {
      power *= theta * theta;
      slope += static_cast<double>(2 * k + 3) * power * lens.k[k];
    }
    if (slope < least.slope) least = {theta, slope};
  }
  return least;
}

double largest_theta_rad(const std::vector<PosedView>& views) {
  double largest = 0;
  for (const PosedView& view : views) {
    const Eigen::Matrix3d rotation = view.pose.camera_from_target();
    for (const auto& p : view.points) {
      const Vec3d d = rotation * p.target_mm + view.pose.translation_mm;
      largest = std::max(largest, std::atan2(d.head<2>().norm(), d.z()));
    }
  }
  return largest;
}

double adjust(Lens& lens, std::vector<PosedView>& views, const AdjustmentOptions& options,
              TargetShape* shape) {
  TargetShape square;
  TargetShape& target = shape ? *shape : square;
  LensNumbers numbers = numbers_of(lens, options.freedom);
  std::vector<PoseNumbers> poses;
  for (const PosedView& view : views) {
    PoseNumbers pose{};
    Eigen::Map<Vec3d>{pose.data()} = view.pose.rotation;
    Eigen::Map<Vec3d>{pose.data() + 3} = view.pose.translation_mm;
    poses.push_back(pose);
  }
  ceres::Problem problem;
  problem.AddParameterBlock(numbers.data(), 8);
  if (const std::vector<int> constant = held(options.freedom); !constant.empty())
    problem.SetManifold(numbers.data(), new ceres::SubsetManifold(8, constant));
  problem.SetParameterLowerBound(numbers.data(), 0, 1e-3);
  for (std::size_t i = 0; i < views.size(); ++i)
    problem.AddResidualBlock(new ViewCost(lens, target, views[i].points, options.cauchy_px), nullptr,
                             numbers.data(), poses[i].data(), target.change_mm.data());
  if (!shape) problem.SetParameterBlockConstant(target.change_mm.data());
  const double field = largest_theta_rad(views);
  for (int i = 1; options.walls && i <= kWalls && options.freedom.coefficients > 0; ++i)
    problem.AddResidualBlock(new SlopeCost(field * i / kWalls), nullptr, numbers.data());
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::DENSE_SCHUR;
  solver.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  for (PoseNumbers& pose : poses) solver.linear_solver_ordering->AddElementToGroup(pose.data(), 0);
  solver.linear_solver_ordering->AddElementToGroup(numbers.data(), 1);
  solver.linear_solver_ordering->AddElementToGroup(target.change_mm.data(), 1);
  solver.max_num_iterations = options.iterations;
  solver.function_tolerance = options.tolerance;
  solver.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  const QuietLog quiet;
  ceres::Solve(solver, &problem, &summary);
  if (!summary.IsSolutionUsable()) return std::numeric_limits<double>::quiet_NaN();
  set_numbers(lens, numbers.data());
  for (std::size_t i = 0; i < views.size(); ++i)
    views[i].pose = {Vec3d(poses[i].data()), Vec3d(poses[i].data() + 3)};
  return squared_error(lens, target, views);
}

std::optional<Eigen::Matrix<double, 8, 8>> lens_covariance(const Lens& lens,
                                                           const std::vector<PosedView>& views,
                                                           const LensFreedom& freedom, double noise_px,
                                                           const TargetShape* shape) {
  using Matrix13 = Eigen::Matrix<double, 13, 13>;  // the lens's numbers, the shape's
  const Eigen::Matrix<double, 8, 8> by_numbers = dlens_dnumbers(lens);
  Matrix13 information = Matrix13::Zero();
  for (const PosedView& view : views) {
    const Eigen::Matrix3d rotation = view.pose.camera_from_target();
    Matrix13 own = Matrix13::Zero();
    Eigen::Matrix<double, 6, 6> pose = Eigen::Matrix<double, 6, 6>::Zero();
    Eigen::Matrix<double, 13, 6> mixed = Eigen::Matrix<double, 13, 6>::Zero();
    for (const auto& p : view.points) {
      const Vec3d turned = rotation * p.target_mm;
      const LensJacobian j = project_with_jacobian(lens, turned + view.pose.translation_mm);
      Eigen::Matrix<double, 2, 13> by_shared = Eigen::Matrix<double, 2, 13>::Zero();
      by_shared.leftCols<8>() = j.dpixel_dlens * by_numbers;
      if (shape) by_shared.rightCols<5>() = j.dpixel_ddirection * rotation * shape->basis(p.target_mm);
      Eigen::Matrix<double, 2, 6> by_pose;
      by_pose << -j.dpixel_ddirection * cross_matrix(turned), j.dpixel_ddirection;
      own += by_shared.transpose() * by_shared;
      pose += by_pose.transpose() * by_pose;
      mixed += by_shared.transpose() * by_pose;
    }
    // What the view says of the rest once its pose is free (Schur complement).
    information += own - mixed * pose.ldlt().solve(mixed.transpose());
  }
  std::vector<int> free;
  const std::vector<int> constant = held(freedom);
  for (int i = 0; i < (shape ? 13 : 8); ++i)
    if (std::find(constant.begin(), constant.end(), i) == constant.end()) free.push_back(i);
  Eigen::MatrixXd reduced = information(free, free);
  // To a unit diagonal first: pixels and eighth powers of the angle differ by many decades.
  const Eigen::VectorXd scale = reduced.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  reduced = (scale.asDiagonal() * reduced * scale.asDiagonal()).eval();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(reduced);
  if (!reduced.allFinite() || eigen.eigenvalues()[0] < 1e-13) return {};
  const Eigen::MatrixXd inverse = eigen.eigenvectors() * eigen.eigenvalues().cwiseInverse().asDiagonal() *
                                  eigen.eigenvectors().transpose();
  Matrix13 covariance = Matrix13::Zero();
  covariance(free, free) = noise_px * noise_px * (scale.asDiagonal() * inverse * scale.asDiagonal());
  return Eigen::Matrix<double, 8, 8>(by_numbers * covariance.topLeftCorner<8, 8>() * by_numbers.transpose());
}

}  // namespace lightwell::calibration
