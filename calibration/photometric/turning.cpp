// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/photometric/turning.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "lighting/median.h"

namespace lightwell::calibration {
namespace {

constexpr double kFinestCell_deg = 2;  // of the scene
constexpr double kCellPixels = 2.5;    // wide, at the least
constexpr double kTukey = 4.685;
constexpr std::size_t kFewestPixels = 3;  // of a take in a cell
constexpr double kMostNoise = 0.05;       // of a pixel's luminance; darker ones say little
constexpr double kMostScatter = 0.15;     // between takes of one scene
constexpr double kMostSigma = 0.05;       // of T at the edge

// What one take sees of one cell of the scene.
struct Glimpse {
  double ln_luminance = 0, theta2 = 0;  // means over the pixels
  double pixels = 0;
};
struct Cell {
  std::vector<Glimpse> glimpses;
};

// Bands of the scene from pole to pole.
int bands_of(const Lens& lens) {
  const double cell = std::max(kFinestCell_deg * kPi / 180, kCellPixels / lens.focal.mean());
  return std::clamp(static_cast<int>(std::lround(kPi / cell)), 12, 90);
}

int cell_of(const Vec3d& d, int bands) {
  const double polar = std::acos(std::clamp(d.y(), -1.0, 1.0));
  const int band = std::min(static_cast<int>(polar / kPi * bands), bands - 1);
  const int sectors =
      std::max(1, static_cast<int>(std::lround(2 * bands * std::sin((band + 0.5) * kPi / bands))));
  const double turn = std::atan2(d.x(), d.z()) / (2 * kPi) + 0.5;
  return 4 * bands * band + std::min(static_cast<int>(turn * sectors), sectors - 1);
}

void look(const TurnedTake& take, const MeanFrame* black, const Lens& lens, const Response& response,
          std::map<int, Cell>& scene) {
  const Eigen::Matrix3d scene_from_camera =
      Eigen::AngleAxisd(take.angle_deg * kPi / 180, Vec3d::UnitY()).toRotationMatrix();
  const double margin = is_bayer(take.mean.format.pixel_format) ? 3 : 1.5;  // as for even scenes
  const double edge = lens.max_theta_rad - margin / lens.focal.minCoeff();
  const double exposure =
      take.mean.exposure_us > 0 ? take.mean.exposure_us / response.reference_exposure_us : 1;
  const int bands = bands_of(lens);
  std::map<int, Glimpse> seen;
  for (int y = 0; y < lens.image_size[1]; ++y)
    for (int x = 0; x < lens.image_size[0]; ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * static_cast<std::size_t>(lens.image_size[0]) +
                            static_cast<std::size_t>(x);
      if (is_bayer(take.mean.format.pixel_format) && colour_of(take.mean.format, x, y) != 1) continue;
      const Vec3d d = lens.unproject(Vec2d(x, y));
      const double theta = std::atan2(d.head<2>().norm(), d.z());
      double code = take.mean.code[i];
      if (!(theta < edge) || code <= 0.5 || code >= response.clip_code - 0.5) continue;
      if (black != nullptr) code -= black->code[i] - response.code(0);
      const double luminance = response.luminance_cd_m2(code);
      if (!(luminance > 0) || response.dluminance_dcode(code) > kMostNoise * luminance) continue;
      Glimpse& g = seen[cell_of(scene_from_camera * d, bands)];
      ++g.pixels;
      g.ln_luminance += (std::log(luminance / exposure) - g.ln_luminance) / g.pixels;
      g.theta2 += (theta * theta - g.theta2) / g.pixels;
    }
  for (const auto& [cell, glimpse] : seen)
    if (glimpse.pixels >= static_cast<double>(kFewestPixels)) scene[cell].glimpses.push_back(glimpse);
}

struct Fit {
  Eigen::VectorXd v;
  Eigen::MatrixXd covariance;
  double scale = 0.05, deviance = 0;
  bool told = true;  // the information has full rank
};

double transmission(const Eigen::VectorXd& v, double theta2) {
  double value = 0;
  for (Eigen::Index k = v.size(); k-- > 0;) value = theta2 * (v[k] + value);
  return std::max(1 + value, 1e-3);
}

// One round: residuals about each cell's weighted mean, weights by the scale of the round before.
void step(Fit& fit, const std::vector<Cell>& cells) {
  const Eigen::Index n = fit.v.size();
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(n, n), middle = information;
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(n);
  std::vector<double> sizes;
  double loss = 0;
  for (const Cell& cell : cells) {
    const auto m = static_cast<Eigen::Index>(cell.glimpses.size());
    Eigen::VectorXd r(m), w(m);
    Eigen::MatrixXd rows(m, n);
    for (Eigen::Index i = 0; i < m; ++i) {
      const Glimpse& g = cell.glimpses[static_cast<std::size_t>(i)];
      const double t = transmission(fit.v, g.theta2);
      r[i] = g.ln_luminance - std::log(t);
      double power = g.theta2;
      for (Eigen::Index k = 0; k < n; ++k, power *= g.theta2) rows(i, k) = power / t;
    }
    std::vector<double> all(r.data(), r.data() + m);
    const double centre = m > 2 ? median(all) : r.mean();
    for (Eigen::Index i = 0; i < m; ++i) {
      const double u = (r[i] - centre) / (kTukey * fit.scale);
      w[i] = u * u < 1 ? (1 - u * u) * (1 - u * u) : 0;
      loss += u * u < 1 ? 1 - std::pow(1 - u * u, 3) : 1;
    }
    if (!(w.sum() > 0)) continue;
    const Eigen::RowVectorXd mean_row = (w.transpose() * rows) / w.sum();
    const double mean = w.dot(r) / w.sum();
    Eigen::VectorXd score = Eigen::VectorXd::Zero(n);
    for (Eigen::Index i = 0; i < m; ++i) {
      const Eigen::VectorXd row = (rows.row(i) - mean_row).transpose();
      sizes.push_back(std::abs(r[i] - mean));
      information.noalias() += w[i] * row * row.transpose();
      score.noalias() += w[i] * (r[i] - mean) * row;
    }
    gradient += score;
    middle.noalias() += score * score.transpose();
  }
  // As a share of what the terms themselves are: θ² to θ⁶ are of very different size and nearly alike.
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> spectrum(information);
  fit.told = spectrum.eigenvalues().minCoeff() > 1e-9;
  if (!fit.told) return;
  const Eigen::LDLT<Eigen::MatrixXd> solver(information);
  fit.v += solver.solve(gradient);
  const Eigen::MatrixXd inverse = solver.solve(Eigen::MatrixXd::Identity(n, n));
  fit.covariance = inverse * middle * inverse;
  fit.deviance = static_cast<double>(sizes.size()) * std::log(std::max(loss * fit.scale * fit.scale, 1e-300));
  fit.scale = std::max(1.4826 * median(std::move(sizes)), 1e-4);
}

Fit fit_terms(const std::vector<Cell>& cells, int terms) {
  Fit fit;
  fit.v = Eigen::VectorXd::Zero(terms);
  for (int round = 0; round < 30 && fit.told; ++round) {
    const Eigen::VectorXd before = fit.v;
    step(fit, cells);
    if (round > 2 && (fit.v - before).cwiseAbs().maxCoeff() < 1e-8) break;
  }
  return fit;
}

// Of T at an angle.
double sigma_at(const Fit& fit, double theta_rad) {
  Eigen::VectorXd row(fit.v.size());
  double power = theta_rad * theta_rad;
  for (Eigen::Index k = 0; k < row.size(); ++k, power *= theta_rad * theta_rad) row[k] = power;
  return std::sqrt(row.dot(fit.covariance * row));
}

Error bad(const char* format, double value) {
  char text[240];
  std::snprintf(text, sizeof text, format, value);
  return {ErrorKind::bad_input, text};
}

}  // namespace

Result<TurningFit> fit_turning(const std::vector<TurnedTake>& takes, const MeanFrame* black, const Lens& lens,
                               const Response& response) {
  if (takes.size() < 2)
    return bad("number of turned takes = %g: allowed at least 2; six are good",
               static_cast<double>(takes.size()));
  std::map<int, Cell> scene;
  for (const TurnedTake& take : takes) look(take, black, lens, response, scene);
  std::vector<Cell> cells;
  for (auto& [index, cell] : scene)
    if (cell.glimpses.size() > 1) cells.push_back(std::move(cell));
  constexpr std::size_t kFewestCells = 50;
  if (cells.size() < kFewestCells)
    return bad(
        "%g places of the scene are seen twice: allowed at least 50; turn less, or expose for the scene",
        static_cast<double>(cells.size()));
  Fit fit = fit_terms(cells, 1);
  for (int more = 2; more <= 3; ++more) {
    const Fit next = fit_terms(cells, more);
    const double price =
        std::log(static_cast<double>(cells.size())) * static_cast<double>(more - fit.v.size());
    if (next.told && next.deviance + price < fit.deviance) fit = next;
  }
  const char* turn_more =
      "vignetting at the edge is known to %.0f %% only: allowed 5; the turns do not tell it from the scene: "
      "turn the "
      "camera farther, about an axis across the lens's";
  if (!fit.told) return bad(turn_more, 100);
  if (!(fit.scale < kMostScatter))
    return bad(
        "the takes differ by %.0f %% where they show one place: allowed 15; is the light constant, are the "
        "angles "
        "right, to the right positive?",
        100 * fit.scale);
  if (const double sigma = sigma_at(fit, lens.max_theta_rad); !(sigma < kMostSigma))
    return bad(turn_more, 100 * std::min(sigma, 1.0));
  TurningFit out;
  out.terms = static_cast<int>(fit.v.size());
  for (int k = 0; k < out.terms; ++k) out.vignetting[static_cast<std::size_t>(k)] = fit.v[k];
  out.covariance.topLeftCorner(out.terms, out.terms) = fit.covariance;
  out.scene_scatter = fit.scale;
  out.cells = cells.size();
  return out;
}

}  // namespace lightwell::calibration
