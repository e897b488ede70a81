// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/photometric/response_curve.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace lightwell::calibration {
namespace {

constexpr std::array<std::string_view, 4> kNames = {"linear", "log", "linlog", "pwl"};

std::vector<std::string> pwl_names(std::size_t points) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < points; ++i) names.push_back("code[" + std::to_string(i) + "]");
  for (std::size_t i = 1; i + 1 < points; ++i) names.push_back("luminance_cd_m2[" + std::to_string(i) + "]");
  return names;
}

}  // namespace

std::string_view name(Curve curve) {
  return kNames[static_cast<std::size_t>(curve)];
}

std::optional<Curve> curve_from_name(std::string_view wanted) {
  const auto found = std::find(kNames.begin(), kNames.end(), wanted);
  if (found == kNames.end()) return std::nullopt;
  return static_cast<Curve>(found - kNames.begin());
}

double model_code(const Model& model, double luminance_cd_m2) {
  return std::visit([&](const auto& m) { return m.code(luminance_cd_m2); }, model);
}

std::vector<std::string> parameter_names(const Model& model) {
  if (std::holds_alternative<LogResponse>(model)) return {"a", "b", "c"};
  if (std::holds_alternative<LinearResponse>(model)) return {"black", "gain"};
  if (std::holds_alternative<LinLogResponse>(model)) return {"black", "gain", "knee_cd_m2"};
  return pwl_names(std::get<PiecewiseLinearResponse>(model).points.size());
}

std::vector<double> parameters_of(const Model& model) {
  if (const auto* log = std::get_if<LogResponse>(&model)) return {log->a, log->b, log->c};
  if (const auto* linear = std::get_if<LinearResponse>(&model)) return {linear->black, linear->gain};
  if (const auto* m = std::get_if<LinLogResponse>(&model)) return {m->black, m->gain, m->knee_cd_m2};
  const auto& points = std::get<PiecewiseLinearResponse>(model).points;
  std::vector<double> out;
  for (const auto& p : points) out.push_back(p.code);
  for (std::size_t i = 1; i + 1 < points.size(); ++i) out.push_back(points[i].luminance_cd_m2);
  return out;
}

Model with_parameters(const Model& like, const std::vector<double>& p) {
  if (std::holds_alternative<LogResponse>(like)) return LogResponse{p[0], p[1], p[2]};
  if (std::holds_alternative<LinearResponse>(like)) return LinearResponse{p[0], p[1]};
  if (std::holds_alternative<LinLogResponse>(like)) return LinLogResponse{p[0], p[1], p[2]};
  auto out = std::get<PiecewiseLinearResponse>(like);
  const std::size_t n = out.points.size();
  for (std::size_t i = 0; i < n; ++i) out.points[i].code = p[i];
  for (std::size_t i = 1; i + 1 < n; ++i) out.points[i].luminance_cd_m2 = p[n + i - 1];
  return out;
}

Eigen::VectorXd dcode_dparameters(const Model& model, double luminance_cd_m2) {
  const std::vector<double> parameters = parameters_of(model);
  Eigen::VectorXd out(static_cast<Eigen::Index>(parameters.size()));
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    // A toe of 0 has no scale but the light's: the step is one-sided there.
    const double scale = parameters[i] != 0 ? std::abs(parameters[i]) : std::max(luminance_cd_m2, 1e-9);
    std::vector<double> up = parameters, down = parameters;
    up[i] += 1e-6 * scale;
    if (parameters[i] != 0) down[i] -= 1e-6 * scale;
    out[static_cast<Eigen::Index>(i)] = (model_code(with_parameters(model, up), luminance_cd_m2) -
                                         model_code(with_parameters(model, down), luminance_cd_m2)) /
                                        (up[i] - down[i]);
  }
  return out;
}

}  // namespace lightwell::calibration
