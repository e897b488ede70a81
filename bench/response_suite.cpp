// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// The camera's response from patches of known luminance, and from exposure brackets where the data are there.

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <random>
#include <string>

#include "bench/suite.h"
#include "calibration/photometric/brackets.h"
#include "calibration/photometric/response_fit.h"

namespace lightwell::bench {
namespace {

using calibration::Patch;
using calibration::PatchSet;

// 12 bits over six decades and a half, with a toe.
const LogResponse kSensor{800, 208, 0.05};
constexpr double kPatchError = 0.01;  // relative, of the meter
constexpr double kCodeNoise = 0.3;

std::vector<Patch> measured(const std::vector<double>& luminances, std::mt19937& random) {
  std::normal_distribution<double> normal;
  std::vector<Patch> out;
  for (const double l : luminances) {
    const double code = kSensor.code(l) + kCodeNoise * normal(random);
    out.push_back({"patch", l * (1 + kPatchError * normal(random)), code, kCodeNoise, ""});
  }
  return out;
}

// Six patches to fit and two to check, drawn anew.
PatchSet draw(unsigned seed) {
  std::mt19937 random(seed);
  PatchSet set;
  set.file = "bench";
  set.fit = measured({0.1, 1.6, 25, 400, 6300, 1e5}, random);
  set.check = measured({8, 2000}, random);
  return set;
}

// What a spreadsheet does with a logarithmic sensor: a straight line through the codes over ln L.
LogResponse line_through(const std::vector<Patch>& patches) {
  Eigen::MatrixX2d m(static_cast<Eigen::Index>(patches.size()), 2);
  Eigen::VectorXd codes(m.rows());
  for (Eigen::Index i = 0; i < m.rows(); ++i) {
    m.row(i) << 1, std::log(patches[static_cast<std::size_t>(i)].luminance_cd_m2);
    codes[i] = patches[static_cast<std::size_t>(i)].code;
  }
  const Eigen::Vector2d x = m.colPivHouseholderQr().solve(codes);
  return {x[0], x[1], 0};
}

// Largest relative luminance error between the darkest and the brightest patch.
template <class Fitted>
double worst_error(const Fitted& fitted) {
  double worst = 0;
  for (double l = 0.1; l <= 1e5; l *= 1.2)
    worst = std::max(worst, std::abs(fitted.luminance_cd_m2(kSensor.code(l)) / l - 1));
  return worst;
}

struct Errors {
  std::vector<double> worst;
  void give(Case& out) {
    std::sort(worst.begin(), worst.end());
    out.values.emplace_back("median_of_largest_error", worst[worst.size() / 2]);
    out.values.emplace_back("p95_of_largest_error", worst[worst.size() * 95 / 100]);
  }
};

std::vector<Row> patch_rows(const Options& options) {
  constexpr unsigned kDraws = 200;
  Errors ours, line;
  int inside = 0, checks = 0;
  for (unsigned seed = 1; seed <= kDraws; ++seed) {
    const PatchSet set = draw(seed);
    const auto fit = calibration::fit_response(set, {});
    verify_bug(fit.ok(), "bench patches refused");
    ours.worst.push_back(worst_error(fit->response));
    line.worst.push_back(worst_error(line_through(set.fit)));
    for (const auto& check : fit->check) inside += check.inside, ++checks;
  }
  std::vector<Case> cases(2);
  cases[0] = {
      "Lightwell",
      [](std::size_t i) { (void)calibration::fit_response(draw(static_cast<unsigned>(i % kDraws) + 1), {}); },
      {}};
  ours.give(cases[0]);
  cases[0].values.emplace_back("check_patches_in_95_percent", static_cast<double>(inside) / checks);
  cases[1] = {"line through ln L",
              [](std::size_t i) { (void)line_through(draw(static_cast<unsigned>(i % kDraws) + 1).fit); },
              {}};
  line.give(cases[1]);
  return time_in_turns("response, 6 patches over 6 decades, 1 % error", std::move(cases), options,
                       "Lightwell");
}

std::vector<Row> bracket_rows(const std::filesystem::path& folder, const Options& options) {
  std::vector<calibration::Photograph> photographs;
  for (int i = 6955; i <= 6971; i += 2) {
    const auto file = folder / ("IMG_" + std::to_string(i) + ".JPG");
    if (!std::filesystem::exists(file)) return {};
    auto read = calibration::read_photograph(file, 0, 4);
    verify_bug(read.ok(), "bench photograph refused");
    photographs.push_back(*std::move(read));
  }
  std::vector<Case> cases;
  for (const auto& [name, solver] : {std::pair{"Debevec", calibration::BracketSolver::debevec},
                                     {"Robertson", calibration::BracketSolver::robertson}}) {
    const auto fit = calibration::fit_brackets(photographs, solver);
    verify_bug(fit.ok(), "bench brackets refused");
    cases.push_back({std::string("medians of codes, OpenCV ") + name,
                     [&photographs, solver = solver](std::size_t) {
                       (void)calibration::fit_brackets(photographs, solver);
                     },
                     {{"median_error_of_unseen_exposures", fit->median_error.value()}}});
  }
  const std::string baseline = cases.front().name;
  return time_in_turns("office brackets", std::move(cases), options, baseline, {1, 3});
}

}  // namespace

std::vector<Row> response_suite(const Options& options) {
  std::vector<Row> rows = patch_rows(options);
  if (!options.data_folder.empty())
    for (Row& row : bracket_rows(
             std::filesystem::path(options.data_folder) / "photometric" / "office_fisheye_brackets", options))
      rows.push_back(std::move(row));
  return rows;
}

}  // namespace lightwell::bench
