// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "calibration/photometric/response_curve.h"

// Every model is linear in some of its parameters once the others are given, so those are eliminated (variable
// projection, Golub and Pereyra 1973) and the search runs over none (linear), one (toe, knee) or few (knees).
namespace lightwell::calibration {
namespace {

using Points = std::vector<CurvePoint>;
constexpr double kNever = std::numeric_limits<double>::infinity();

struct LinearFit {
  Eigen::VectorXd beta;
  double chi2 = kNever;
};

// code ≈ Σ beta_j basis_j(L), weighted.
template <class Basis>
LinearFit solve(const Points& points, Eigen::Index columns, Basis basis) {
  const auto n = static_cast<Eigen::Index>(points.size());
  Eigen::MatrixXd m(n, columns);
  Eigen::VectorXd y(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const CurvePoint& p = points[static_cast<std::size_t>(i)];
    basis(p.luminance_cd_m2, m.row(i));
    m.row(i) /= p.sigma;
    y[i] = p.code / p.sigma;
  }
  // Luminances span many decades: columns to unit length first.
  Eigen::VectorXd length = m.colwise().norm();
  for (Eigen::Index j = 0; j < columns; ++j) {
    if (!(length[j] > 0)) length[j] = 1;
    m.col(j) /= length[j];
  }
  LinearFit fit;
  fit.beta = m.colPivHouseholderQr().solve(y);
  fit.chi2 = (m * fit.beta - y).squaredNorm();
  fit.beta = fit.beta.cwiseQuotient(length);
  return fit;
}

// code ≈ beta[0] + beta[1] f(L), weighted: about the means, so that no digits are lost; allocates nothing, for the search
// asks for it two hundred times a fit.
struct StraightFit {
  double beta[2] = {0, 0};
  double chi2 = kNever;
};
template <class Function>
StraightFit solve_straight(const Points& points, Function f) {
  const auto weight = [](const CurvePoint& p) { return 1 / (p.sigma * p.sigma); };
  double sum = 0, mean_x = 0, mean_y = 0;
  for (const CurvePoint& p : points) {
    sum += weight(p);
    mean_x += weight(p) / sum * (f(p.luminance_cd_m2) - mean_x);
    mean_y += weight(p) / sum * (p.code - mean_y);
  }
  double xx = 0, xy = 0;
  for (const CurvePoint& p : points) {
    const double x = f(p.luminance_cd_m2) - mean_x;
    xx += weight(p) * x * x;
    xy += weight(p) * x * (p.code - mean_y);
  }
  StraightFit fit;
  fit.beta[1] = xx > 0 ? xy / xx : 0;
  fit.beta[0] = mean_y - fit.beta[1] * mean_x;
  fit.chi2 = 0;
  for (const CurvePoint& p : points) {
    const double r = p.code - mean_y - fit.beta[1] * (f(p.luminance_cd_m2) - mean_x);
    fit.chi2 += weight(p) * r * r;
  }
  return fit;
}

// The lowest of value over ln x in [low, high]: the best of a grid, then golden section around it.
template <class Value>
double search(double low, double high, int steps, Value value) {
  const double h = (high - low) / steps;
  double best = low, least = kNever;
  for (int i = 0; i <= steps; ++i)
    if (const double v = value(low + h * i); v < least) {
      least = v;
      best = low + h * i;
    }
  const double golden = (std::sqrt(5.0) - 1) / 2;
  double a = std::max(low, best - h), b = std::min(high, best + h);
  double c = b - golden * (b - a), d = a + golden * (b - a);
  double at_c = value(c), at_d = value(d);
  for (int i = 0; i < 60 && b - a > 1e-10; ++i) {
    if (at_c < at_d) {
      b = d, d = c, at_d = at_c;
      c = b - golden * (b - a), at_c = value(c);
    } else {
      a = c, c = d, at_c = at_d;
      d = a + golden * (b - a), at_d = value(d);
    }
  }
  return (a + b) / 2;
}

double darkest(const Points& points) {
  for (const CurvePoint& p : points)
    if (p.luminance_cd_m2 > 0) return p.luminance_cd_m2;
  return 1;
}

std::optional<CurveFit> fit_linear(const Points& points) {
  const StraightFit fit = solve_straight(points, [](double l) { return l; });
  if (!(fit.beta[1] > 0)) return std::nullopt;
  return CurveFit{LinearResponse{fit.beta[0], fit.beta[1]}, fit.chi2};
}

std::optional<CurveFit> fit_log(const Points& points) {
  const auto given = [&](double c) {
    return solve_straight(points, [c](double l) { return std::log(l + c); });
  };
  // From a toe that no patch feels to one that all do; an eighth of a decade a step.
  const double least = darkest(points);
  const double low = std::log(least * 1e-4), high = std::log(points.back().luminance_cd_m2 * 10);
  const double ln_c = search(low, high, 120, [&](double x) { return given(std::exp(x)).chi2; });
  double c = std::exp(ln_c);
  StraightFit fit = given(c);
  if (points.front().luminance_cd_m2 > 0) {  // without a toe, a dark patch would have no code
    const StraightFit none = given(0);
    if (none.chi2 <= fit.chi2) fit = none, c = 0;
  }
  if (!(fit.beta[1] > 0)) return std::nullopt;
  return CurveFit{LogResponse{fit.beta[0], fit.beta[1], c}, fit.chi2};
}

std::optional<CurveFit> fit_lin_log(const Points& points) {
  const auto given = [&](double knee) {
    const LinLogResponse unit{0, 1, knee};
    return solve_straight(points, [&](double l) { return unit.code(l); });
  };
  const double low = std::log(darkest(points)), high = std::log(points.back().luminance_cd_m2);
  const double ln_knee = search(low, high, 120, [&](double x) { return given(std::exp(x)).chi2; });
  // At either end it is another model: a logarithm, or a straight line.
  if (ln_knee - low < 1e-6 || high - ln_knee < 1e-6) return std::nullopt;
  const StraightFit fit = given(std::exp(ln_knee));
  if (!(fit.beta[1] > 0)) return std::nullopt;
  return CurveFit{LinLogResponse{fit.beta[0], fit.beta[1], std::exp(ln_knee)}, fit.chi2};
}

// ---- piecewise linear ----

LinearFit fit_knees(const Points& points, const std::vector<double>& knees) {
  return solve(points, static_cast<Eigen::Index>(knees.size()) + 2, [&](double l, auto row) {
    row[0] = 1;
    row[1] = l;
    for (std::size_t k = 0; k < knees.size(); ++k)
      row[static_cast<Eigen::Index>(k) + 2] = std::max(0.0, l - knees[k]);
  });
}

// Weighted least-squares line through a run of points, one point added after the other (West 1979): no difference of
// large sums, so nothing is lost over many decades.
class RunningLine {
 public:
  void add(const CurvePoint& p) {
    const double w = 1 / (p.sigma * p.sigma);
    weight_ += w;
    const double dx = p.luminance_cd_m2 - x_, dy = p.code - y_;
    x_ += dx * w / weight_;
    y_ += dy * w / weight_;
    xx_ += w * dx * (p.luminance_cd_m2 - x_);
    xy_ += w * dx * (p.code - y_);
    yy_ += w * dy * (p.code - y_);
  }
  [[nodiscard]] double chi2() const { return xx_ > 0 ? std::max(0.0, yy_ - xy_ * xy_ / xx_) : yy_; }

 private:
  double weight_ = 0, x_ = 0, y_ = 0, xx_ = 0, xy_ = 0, yy_ = 0;
};

// In which gap between neighbouring points each knee lies: every segment holds two points at least, or its line is not
// determined.
using Gaps = std::vector<std::size_t>;

// Where to cut the points so that separate lines leave the least χ²: dynamic programming over the segments' ends
// (Bellman and Roth 1969), O(segments · n²). points.size() ≥ 2 · segments.
Gaps best_cuts(const Points& points, std::size_t segments) {
  const std::size_t n = points.size();
  // least[s][j]: χ² of the first j points in s + 1 segments; start[s][j]: where the last of these begins.
  std::vector<std::vector<double>> least(segments, std::vector<double>(n + 1, kNever));
  std::vector<std::vector<std::size_t>> start(segments, std::vector<std::size_t>(n + 1, 0));
  for (std::size_t j = 2; j <= n; ++j) {
    RunningLine line;
    line.add(points[j - 1]);
    for (std::size_t i = j - 1; i-- > 0;) {
      line.add(points[i]);
      const double chi2 = line.chi2();
      if (i == 0) least[0][j] = chi2;
      for (std::size_t s = 1; s < segments; ++s)
        if (const double sum = least[s - 1][i] + chi2; sum < least[s][j]) {
          least[s][j] = sum;
          start[s][j] = i;
        }
    }
  }
  Gaps gaps(segments - 1);
  std::size_t end = n;
  for (std::size_t s = segments; s-- > 1;) {
    end = start[s][end];
    gaps[s - 1] = end - 1;
  }
  return gaps;
}

struct KneeFit {
  std::vector<double> knees;
  double chi2 = kNever;
};

// The knees are where the lines of neighbouring segments meet; the best there are with these gaps, as long as they meet
// inside. Where they meet beyond, the knee stands at the gap's end.
KneeFit knees_in(const Points& points, const Gaps& gaps) {
  KneeFit fit;
  std::vector<Eigen::VectorXd> lines;
  for (std::size_t k = 0; k <= gaps.size(); ++k) {
    const auto first = points.begin() + (k == 0 ? 0 : static_cast<std::ptrdiff_t>(gaps[k - 1]) + 1);
    const auto end =
        k == gaps.size() ? points.end() : points.begin() + static_cast<std::ptrdiff_t>(gaps[k]) + 1;
    lines.push_back(solve(Points(first, end), 2, [](double l, auto row) { row << 1, l; }).beta);
  }
  for (std::size_t k = 0; k < gaps.size(); ++k) {
    const double low = points[gaps[k]].luminance_cd_m2, high = points[gaps[k] + 1].luminance_cd_m2;
    const double meet = (lines[k + 1][0] - lines[k][0]) / (lines[k][1] - lines[k + 1][1]);
    fit.knees.push_back(std::isfinite(meet) ? std::clamp(meet, low, high) : (low + high) / 2);
  }
  fit.chi2 = fit_knees(points, fit.knees).chi2;
  return fit;
}

std::optional<CurveFit> as_model(const Points& points, const KneeFit& best) {
  const Eigen::VectorXd beta = fit_knees(points, best.knees).beta;
  PiecewiseLinearResponse model;
  double code = beta[0], slope = beta[1], from = 0;
  model.points.push_back({0, code});
  std::vector<double> ends = best.knees;
  ends.push_back(points.back().luminance_cd_m2);
  for (std::size_t i = 0; i < ends.size(); ++i) {
    if (!(slope > 0) || !(ends[i] > from)) return std::nullopt;
    code += slope * (ends[i] - from);
    from = ends[i];
    model.points.push_back({from, code});
    if (i + 1 < ends.size()) slope += beta[static_cast<Eigen::Index>(i) + 2];
  }
  return CurveFit{std::move(model), best.chi2};
}

// Separate lines need not meet between their points, nor rise; the cuts move from where they leave the least χ² to
// where joined and rising lines do: one after the other, a few points at a time, until no move is better.
std::optional<CurveFit> fit_piecewise(const Points& points, int segments) {
  if (segments == 1) return fit_linear(points);
  if (points.size() < 2 * static_cast<std::size_t>(segments)) return std::nullopt;
  constexpr std::size_t kFarthest = 6;
  constexpr int kMostRounds = 20;
  Gaps gaps = best_cuts(points, static_cast<std::size_t>(segments));
  std::optional<CurveFit> best = as_model(points, knees_in(points, gaps));
  bool better = true;
  for (int round = 0; better && round < kMostRounds; ++round) {
    better = false;
    for (std::size_t k = 0; k < gaps.size(); ++k) {
      const std::size_t first = k == 0 ? 1 : gaps[k - 1] + 2;
      const std::size_t last = k + 1 == gaps.size() ? points.size() - 3 : gaps[k + 1] - 2;
      const std::size_t now = gaps[k];
      Gaps trial = gaps;
      for (trial[k] = std::max(first, now - std::min(now, kFarthest));
           trial[k] <= std::min(last, now + kFarthest); ++trial[k]) {
        if (trial[k] == now) continue;
        auto fit = as_model(points, knees_in(points, trial));
        if (!fit || (best && !(fit->chi2 < best->chi2))) continue;
        best = std::move(fit);
        gaps = trial;
        better = true;
      }
    }
  }
  return best;
}

}  // namespace

std::optional<CurveFit> fit_curve(Curve curve, const std::vector<CurvePoint>& points, int segments) {
  switch (curve) {
    case Curve::linear:
      return fit_linear(points);
    case Curve::log:
      return fit_log(points);
    case Curve::linlog:
      return fit_lin_log(points);
    case Curve::pwl:
      return fit_piecewise(points, segments);
  }
  return std::nullopt;
}

}  // namespace lightwell::calibration
