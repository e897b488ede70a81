// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "bench/ceres_lights.h"

#include <ceres/ceres.h>

#include <vector>

namespace lightwell::bench {
namespace {

// One face in one channel: blocks are the ambient radiance, then a direction (3) and a power (1) for every light.
class FaceResidual final : public ceres::CostFunction {
 public:
  FaceResidual(const Vec3d& normal, double observed, int lights) : normal_(normal), observed_(observed) {
    set_num_residuals(1);
    mutable_parameter_block_sizes()->push_back(1);
    for (int k = 0; k < lights; ++k) {
      mutable_parameter_block_sizes()->push_back(3);
      mutable_parameter_block_sizes()->push_back(1);
    }
  }
  bool Evaluate(double const* const* blocks, double* residual, double** jacobians) const override {
    residual[0] = kPi * blocks[0][0] - observed_;
    if (jacobians != nullptr && jacobians[0] != nullptr) jacobians[0][0] = kPi;
    for (std::size_t b = 1; b < parameter_block_sizes().size(); b += 2) {
      const double cosine = std::max(0.0, normal_.dot(Vec3d(blocks[b][0], blocks[b][1], blocks[b][2])));
      const double power = blocks[b + 1][0];
      residual[0] += power * cosine;
      if (jacobians == nullptr) continue;
      if (jacobians[b] != nullptr)
        for (int i = 0; i < 3; ++i) jacobians[b][i] = cosine > 0 ? power * normal_[i] : 0;
      if (jacobians[b + 1] != nullptr) jacobians[b + 1][0] = cosine;
    }
    return true;
  }

 private:
  Vec3d normal_;
  double observed_;
};

}  // namespace

double ceres_fit(const ProbeIrradiance& observed, const LightsTrial& start) {
  const ProbeNormals normals = probe_normals();
  const double scale = observed.matrix().norm();
  const auto count = static_cast<std::size_t>(start.count);
  Rgbd ambient = observed.colwise().mean().transpose() / (2 * kPi * scale);
  std::vector<Vec3d> directions;
  std::vector<Rgbd> powers(count, observed.colwise().mean().transpose() * 2 / (scale * start.count));
  for (int k = 0; k < start.count; ++k) directions.emplace_back(start.direction.col(k));

  ceres::Problem problem;
  for (int i = 0; i < kProbeNormals; ++i)
    for (int c = 0; c < 3; ++c) {
      std::vector<double*> blocks = {&ambient[c]};
      for (std::size_t k = 0; k < count; ++k) {
        blocks.push_back(directions[k].data());
        blocks.push_back(&powers[k][c]);
      }
      problem.AddResidualBlock(new FaceResidual(normals.col(i), observed(i, c) / scale, start.count), nullptr,
                               blocks);
    }
  for (std::size_t k = 0; k < count; ++k) {
    problem.SetManifold(directions[k].data(), new ceres::SphereManifold<3>());
    for (int c = 0; c < 3; ++c) problem.SetParameterLowerBound(&powers[k][c], 0, 0);
  }
  for (int c = 0; c < 3; ++c) problem.SetParameterLowerBound(&ambient[c], 0, 0);
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = 100;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return std::sqrt(2 * summary.final_cost);
}

}  // namespace lightwell::bench
