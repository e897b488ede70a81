// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/photometric/vignetting_fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "lighting/median.h"

namespace lightwell::calibration {
namespace {

constexpr double kTukey = 4.685;  // 95 % efficient where the noise is normal

constexpr double kLeastLight = 0.03;  // of either factor: a first step may go too far

// 1 + tilt · (x, y): of the scene
double scene_light(const VignettingFit& fit, const EvenSample& s) {
  const Eigen::Index at = fit.levels + fit.terms + 2 * s.take;
  return std::max(1 + fit.p[at] * s.x + fit.p[at + 1] * s.y, kLeastLight);
}

// T(θ): what the lens leaves of it
double lens_light(const VignettingFit& fit, const EvenSample& s) {
  double value = 1, power = s.theta2;
  for (int k = 0; k < fit.terms; ++k, power *= s.theta2) value += fit.p[fit.levels + k] * power;
  return std::max(value, kLeastLight);
}

void start(VignettingFit& fit, const std::vector<EvenSample>& samples, const Response& response) {
  fit.p = Eigen::VectorXd::Zero(fit.levels + fit.terms + 2 * fit.takes);
  std::vector<std::vector<double>> codes(static_cast<std::size_t>(fit.levels));
  for (const EvenSample& s : samples) codes[static_cast<std::size_t>(s.level)].push_back(s.code);
  for (int c = 0; c < fit.levels; ++c) {
    auto& of_level = codes[static_cast<std::size_t>(c)];
    fit.p[c] = of_level.empty() ? 1 : std::max(response.luminance_cd_m2(median(std::move(of_level))), 1e-9);
  }
}

// One Gauss–Newton step; leaves (JᵀWJ)⁻¹ in the covariance.
void step(VignettingFit& fit, const std::vector<EvenSample>& samples, const Response& response) {
  const Eigen::Index n = fit.p.size();
  std::vector<double> residuals, sizes;
  residuals.reserve(samples.size());
  for (const EvenSample& s : samples) {
    residuals.push_back(fit.residual(s, response));
    sizes.push_back(std::abs(residuals.back()));
  }
  fit.scale = std::max(1.4826 * median(std::move(sizes)), 1e-3);  // of a normal distribution
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(n), row(n);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double u = residuals[i] / (kTukey * fit.scale);
    if (!(u * u < 1)) continue;
    fit.gradient(samples[i], response, row);
    const double weight = (1 - u * u) * (1 - u * u);
    information.noalias() += weight * row * row.transpose();
    gradient.noalias() += weight * residuals[i] * row;
  }
  const Eigen::LDLT<Eigen::MatrixXd> solver(information);
  fit.p += solver.solve(gradient);
  for (int c = 0; c < fit.levels; ++c) fit.p[c] = std::max(fit.p[c], 1e-12);
  fit.covariance = solver.solve(Eigen::MatrixXd::Identity(n, n));
}

// Residuals as a pixel's own part, its column's and its row's: their variances, from the means over columns and rows
// (method of moments). q: parameters, which take some of the columns' and rows' freedom away.
struct Components {
  double pixel = 0, column = 0, row = 0;
};
struct Line {
  double sum = 0, count = 0;
};
struct PixelResidual {
  int column = 0, row = 0;
  double sum = 0, count = 0;  // over the takes, which share a pixel's pattern
};

double square_of_means(const std::map<int, Line>& lines) {
  double sum = 0;
  for (const auto& [at, line] : lines) sum += line.sum * line.sum / line.count;
  return sum;
}

Components components_of(const std::map<std::size_t, PixelResidual>& pixels, double q) {
  std::map<int, Line> columns, rows;
  const auto n = static_cast<double>(pixels.size());
  for (const auto& [index, p] : pixels) {
    columns[p.column].sum += p.sum / p.count;
    ++columns[p.column].count;
    rows[p.row].sum += p.sum / p.count;
    ++rows[p.row].count;
  }
  const auto c = static_cast<double>(columns.size()), r = static_cast<double>(rows.size());
  double square = 0;
  for (const auto& [index, p] : pixels) {
    const Line &column = columns[p.column], &row = rows[p.row];
    square += std::pow(p.sum / p.count - column.sum / column.count - row.sum / row.count, 2);
  }
  Components out;
  out.pixel = square / std::max(n - c - r, 1.0);
  const auto freed = [q](double lines) { return lines / std::max(lines - q, 1.0); };
  for (int round = 0; round < 3;
       ++round) {  // a column's mean holds some of the rows, and the other way round
    out.column = std::max(0.0, square_of_means(columns) * freed(c) - c * (out.pixel + out.row)) / n;
    out.row = std::max(0.0, square_of_means(rows) * freed(r) - r * (out.pixel + out.column)) / n;
  }
  return out;
}

// (JᵀWJ)⁻¹ · Σ variance of a group · (Σ w J of the group)(…)ᵀ · (JᵀWJ)⁻¹ over pixels, columns and rows.
void set_covariance(VignettingFit& fit, const std::vector<EvenSample>& samples, const Response& response) {
  const Eigen::Index n = fit.p.size();
  std::map<std::size_t, PixelResidual> pixels;
  std::map<std::size_t, Eigen::VectorXd> of_pixel;
  std::map<int, Eigen::VectorXd> of_column, of_row;
  Eigen::VectorXd row(n);
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(n);
  for (const EvenSample& s : samples) {
    const double residual = fit.residual(s, response), u = residual / (kTukey * fit.scale);
    if (!(u * u < 1)) continue;
    PixelResidual& pixel = pixels.try_emplace(s.index, PixelResidual{s.column, s.row, 0, 0}).first->second;
    pixel.sum += residual;
    ++pixel.count;
    fit.gradient(s, response, row);
    row *= (1 - u * u) * (1 - u * u);
    of_pixel.try_emplace(s.index, zero).first->second += row;
    of_column.try_emplace(s.column, zero).first->second += row;
    of_row.try_emplace(s.row, zero).first->second += row;
  }
  const double shapes = static_cast<double>(fit.levels) / fit.takes + fit.terms + 1;
  const Components variance = components_of(pixels, shapes);
  Eigen::MatrixXd middle = Eigen::MatrixXd::Zero(n, n);
  for (const auto& [at, score] : of_pixel) middle.noalias() += variance.pixel * score * score.transpose();
  for (const auto& [at, score] : of_column) middle.noalias() += variance.column * score * score.transpose();
  for (const auto& [at, score] : of_row) middle.noalias() += variance.row * score * score.transpose();
  fit.covariance = fit.covariance * middle * fit.covariance;
}

VignettingFit fit_terms(const std::vector<EvenSample>& samples, const Response& response, int levels,
                        int takes, int terms) {
  VignettingFit fit;
  fit.levels = levels;
  fit.takes = takes;
  fit.terms = terms;
  start(fit, samples, response);
  for (int round = 0; round < 30; ++round) {
    const Eigen::VectorXd before = fit.p;
    step(fit, samples, response);
    if ((fit.p - before).cwiseQuotient(before.cwiseAbs().cwiseMax(1e-3)).cwiseAbs().maxCoeff() < 1e-9) break;
  }
  return fit;
}

}  // namespace

double VignettingFit::luminance(const EvenSample& s) const {
  return p[s.level] * scene_light(*this, s) * lens_light(*this, s);
}

double VignettingFit::residual(const EvenSample& s, const Response& response) const {
  return s.code - response.code(luminance(s));
}

void VignettingFit::gradient(const EvenSample& s, const Response& response, Eigen::VectorXd& row) const {
  const double level = p[s.level], scene = scene_light(*this, s), lens = lens_light(*this, s);
  const double slope = 1 / response.dluminance_dcode(response.code(level * scene * lens));
  row.setZero();
  row[s.level] = slope * scene * lens;
  double power = s.theta2;
  for (int k = 0; k < terms; ++k, power *= s.theta2) row[levels + k] = slope * level * scene * power;
  row[levels + terms + 2 * s.take] = slope * level * lens * s.x;
  row[levels + terms + 2 * s.take + 1] = slope * level * lens * s.y;
}

double VignettingFit::tilt() const {
  double most = 0;
  for (int t = 0; t < takes; ++t) most = std::max(most, p.segment<2>(levels + terms + 2 * t).norm());
  return most;
}

VignettingFit fit_vignetting(const std::vector<EvenSample>& samples, const Response& response, int levels,
                             int takes) {
  std::set<int> columns, rows;
  for (const EvenSample& s : samples) columns.insert(s.column), rows.insert(s.row);
  // Lines are what the samples have of independent ones, at the worst.
  const double price = std::log(static_cast<double>(columns.size() + rows.size()));
  VignettingFit fit;
  for (int terms = 1; terms <= 3; ++terms) {
    VignettingFit next = fit_terms(samples, response, levels, takes, terms);
    set_covariance(next, samples, response);
    const Eigen::Index first = levels + (terms == 1 ? 0 : fit.terms), more = levels + terms - first;
    const Eigen::VectorXd added = next.p.segment(first, more);
    const double wald = added.dot(next.covariance.block(first, first, more, more).ldlt().solve(added));
    if (terms == 1 || wald > static_cast<double>(more) * price) fit = std::move(next);
  }
  return fit;
}

}  // namespace lightwell::calibration
