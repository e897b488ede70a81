// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "lighting/response.h"

// A response model as a vector of parameters, and its weighted least-squares fit to points.
namespace lightwell::calibration {

enum class Curve { linear, log, linlog, pwl };
std::string_view name(Curve curve);
std::optional<Curve> curve_from_name(std::string_view name);

using Model = decltype(Response::model);
double model_code(const Model& model, double luminance_cd_m2);

// What is fitted. linear: black, gain. log: a, b, c. linlog: black, gain, knee. pwl: the codes at darkness, at every
// knee and at the brightest patch, then the knees' luminances.
std::vector<std::string> parameter_names(const Model& model);
std::vector<double> parameters_of(const Model& model);
// like: a model of the same form, from which what is not a parameter is taken.
Model with_parameters(const Model& like, const std::vector<double>& parameters);
// ∂code/∂parameters at a luminance, by central differences (relative step 1e-6).
Eigen::VectorXd dcode_dparameters(const Model& model, double luminance_cd_m2);

struct CurvePoint {
  double luminance_cd_m2 = 0;
  double code = 0;
  double sigma = 1;  // standard deviation of code
};
struct CurveFit {
  Model model;
  double chi2 = 0;
};
// The least-squares curve: linear parameters in closed form, the others (toe, knees) by search over them, so that there
// is no start to guess and no local minimum to end in. points: in order of luminance, at least as many as parameters.
// segments: of a piecewise-linear curve, 1 to 4. Nothing where the best curve does not rise, or no knee lies between the
// points.
std::optional<CurveFit> fit_curve(Curve curve, const std::vector<CurvePoint>& points, int segments = 2);

}  // namespace lightwell::calibration
