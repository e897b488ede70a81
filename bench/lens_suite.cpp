// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// Lens calibration: ours, OpenCV's fisheye model and mrcal on the same corners.
#include <malloc.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>

#include "bench/lens_peers.h"
#include "bench/suite.h"
#include "calibration/detection/picture_views.h"
#include "calibration/lens/lens_calibration.h"
#include "tests/support/babelcalib_corners.h"
#include "tests/support/board_views.h"

namespace lightwell::bench {
namespace {

using calibration::LensCalibration;
using calibration::TargetPose;
using calibration::TargetTrust;
using calibration::TargetView;
using calibration::TargetViews;

// What a lens is judged by: the lens that made the corners, or views that it was not fitted to.
struct Problem {
  std::string name;
  TargetViews views;
  TargetTrust trust = TargetTrust::exact;
  std::optional<Lens> truth;
  std::set<std::pair<std::size_t, std::size_t>> wrong;  // (view, point) that were moved on purpose
  std::optional<TargetViews> unseen;
  std::string mrcal_model;
};

SolvedLens solved_by_us(const LensCalibration& c) {
  SolvedLens out;
  out.project = [lens = c.lens](const Vec3d& direction) { return lens.project(direction); };
  for (const auto& view : c.views) out.poses.push_back(view.pose);
  if (c.shape) out.place = [shape = *c.shape](const Vec3d& nominal) { return shape.place(nominal); };
  return out;
}

// √mean(du² + dv²) of all points but the wrong ones.
double rms_px(const SolvedLens& solved, const Problem& problem) {
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t v = 0; v < problem.views.views.size(); ++v) {
    const Eigen::Matrix3d rotation = solved.poses[v].camera_from_target();
    const auto& points = problem.views.views[v].points;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (problem.wrong.contains({v, i})) continue;
      const Vec3d& nominal = points[i].target_mm;
      const Vec3d p =
          rotation * (solved.place ? solved.place(nominal) : nominal) + solved.poses[v].translation_mm;
      sum += (solved.project(p) - points[i].pixel).squaredNorm();
      ++count;
    }
  }
  return std::sqrt(sum / static_cast<double>(count));
}

// Gauss–Newton on a function of few parameters with differences for a Jacobian: all models alike.
template <int n>
Eigen::Matrix<double, n, 1> least_squares(
    const std::function<Eigen::VectorXd(const Eigen::Matrix<double, n, 1>&)>& residuals,
    const Eigen::Matrix<double, n, 1>& step) {
  Eigen::Matrix<double, n, 1> x = Eigen::Matrix<double, n, 1>::Zero();
  for (int round = 0; round < 10; ++round) {
    const Eigen::VectorXd r = residuals(x);
    Eigen::Matrix<double, Eigen::Dynamic, n> j(r.size(), n);
    for (int i = 0; i < n; ++i) {
      const Eigen::Matrix<double, n, 1> d = step[i] * Eigen::Matrix<double, n, 1>::Unit(i);
      j.col(i) = (residuals(x + d) - residuals(x - d)) / (2 * step[i]);
    }
    x -= j.colPivHouseholderQr().solve(r).eval();
  }
  return x;
}

Eigen::Matrix3d turn(const Vec3d& v) {
  const double angle = v.norm();
  return angle > 0 ? Eigen::AngleAxisd(angle, v / angle).toRotationMatrix() : Eigen::Matrix3d::Identity();
}

struct FieldError {
  double rms_px = 0, median_px = 0, worst_px = 0;
};
// Against the true lens over its field, equal solid angles alike. A camera turned a little looks the same to any
// calibration: the turn that agrees best is taken out, of every solver's result alike.
FieldError field_error(const SolvedLens& solved, const Lens& truth) {
  constexpr int kDirections = 2000;
  constexpr double kGoldenAngle = 2.399963229728653;
  std::vector<Vec3d> directions;
  for (int i = 0; i < kDirections; ++i) {
    const double z = 1 - (1 - std::cos(truth.max_theta_rad)) * (i + 0.5) / kDirections;
    const double r = std::sqrt(1 - z * z);
    directions.emplace_back(r * std::cos(kGoldenAngle * i), r * std::sin(kGoldenAngle * i), z);
  }
  const auto residuals = [&](const Vec3d& v) {
    Eigen::VectorXd out(2 * kDirections);
    for (int i = 0; i < kDirections; ++i) {
      const Vec3d& d = directions[static_cast<std::size_t>(i)];
      out.segment<2>(2 * i) = solved.project(turn(v) * d) - truth.project(d);
    }
    return out;
  };
  const Eigen::VectorXd left = residuals(least_squares<3>(residuals, Vec3d::Constant(1e-5)));
  std::vector<double> errors;
  for (int i = 0; i < kDirections; ++i) errors.push_back(left.segment<2>(2 * i).norm());
  std::sort(errors.begin(), errors.end());
  return {std::sqrt(left.squaredNorm() / kDirections), errors[kDirections / 2], errors.back()};
}

// √mean(du² + dv²) of all points of views that the lens was not fitted to, their poses refined from ours.
double unseen_rms_px(const SolvedLens& solved, const TargetViews& unseen, const Lens& ours) {
  double sum = 0;
  Eigen::Index count = 0;
  for (const TargetView& view : unseen.views) {
    const calibration::ViewResult start = calibration::fit_view(ours, view);
    if (!start.used) continue;
    const Eigen::Matrix3d rotation = start.pose.camera_from_target();
    const auto residuals = [&](const Eigen::Matrix<double, 6, 1>& x) {
      Eigen::VectorXd out(2 * static_cast<Eigen::Index>(view.points.size()));
      for (std::size_t i = 0; i < view.points.size(); ++i)
        out.segment<2>(2 * static_cast<Eigen::Index>(i)) =
            solved.project(turn(x.head<3>()) * rotation * view.points[i].target_mm +
                           start.pose.translation_mm + x.tail<3>()) -
            view.points[i].pixel;
      return out;
    };
    Eigen::Matrix<double, 6, 1> step;
    step << Vec3d::Constant(1e-6), Vec3d::Constant(1e-6 * start.pose.translation_mm.norm());
    const Eigen::VectorXd left = residuals(least_squares<6>(residuals, step));
    sum += left.squaredNorm();
    count += left.size() / 2;
  }
  return std::sqrt(sum / static_cast<double>(count));
}

Case judged(const std::string& name, const SolvedLens& solved, const Problem& problem, const Lens& ours,
            std::function<void()> run) {
  Case out{name, [run = std::move(run)](std::size_t) { run(); }, {}};
  if (!solved.refused.empty()) {
    out.name += " (refused: " + solved.refused + ")";
    return out;
  }
  out.values.emplace_back("rms_px", rms_px(solved, problem));
  if (problem.truth) {
    const FieldError error = field_error(solved, *problem.truth);
    out.values.emplace_back("field_error_px", error.rms_px);
    out.values.emplace_back("median_field_error_px", error.median_px);
    out.values.emplace_back("worst_field_error_px", error.worst_px);
  }
  if (problem.unseen) out.values.emplace_back("unseen_rms_px", unseen_rms_px(solved, *problem.unseen, ours));
  return out;
}

// Highest resident memory while it runs, MB; NaN where the system does not tell.
double peak_memory_mb(const std::function<void()>& run) {
  malloc_trim(0);                                 // what earlier rows freed is not counted against this one
  std::ofstream("/proc/self/clear_refs") << "5";  // restarts the count
  run();
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("VmHWM:")) return std::stod(line.substr(6)) / 1024;
  return std::nan("");
}

// For a row of the plot; the model in full is what the problem names.
std::string short_name(const std::string& mrcal_model) {
  return mrcal_model.find("SPLINED") != std::string::npos ? "splined" : "OpenCV 8";
}

std::vector<Row> rows_of(const Problem& problem, const Options& options) {
  const auto calibrate = [&] { return calibration::calibrate_lens(problem.views, problem.trust); };
  const auto ours = calibrate();
  verify_bug(ours.ok(), "bench corners refused");
  const SolvedLens solved = solved_by_us(*ours);
  std::vector<Case> cases;
  cases.push_back(judged("Lightwell", solved, problem, ours->lens, [&] { (void)calibrate(); }));
  cases.back().values.emplace_back("accepted_rms_px", ours->rms_px);
  cases.back().values.emplace_back("views", static_cast<double>(ours->views.size()));
  cases.back().values.emplace_back(
      "views_used", static_cast<double>(std::count_if(ours->views.begin(), ours->views.end(),
                                                      [](const auto& view) { return view.used; })));
  if (problem.truth)  // after pictures were read, their memory is what is measured
    cases.back().values.emplace_back("peak_memory_mb", peak_memory_mb([&] { (void)calibrate(); }));
  for (const bool recompute : {false, true})
    cases.push_back(judged(recompute ? "OpenCV fisheye, recompute extrinsics" : "OpenCV fisheye, as it comes",
                           solve_opencv(problem.views, recompute), problem, ours->lens,
                           [&, recompute] { (void)solve_opencv(problem.views, recompute); }));
  const MrcalStart start{ours->lens, solved.poses};
  const bool bend = problem.trust == TargetTrust::printed;
  cases.push_back(judged("mrcal " + short_name(problem.mrcal_model) + ", from our result",
                         solve_mrcal(problem.views, start, problem.mrcal_model, bend), problem, ours->lens,
                         [&] { (void)solve_mrcal(problem.views, start, problem.mrcal_model, bend); }));
  return time_in_turns(problem.name, std::move(cases), options, "Lightwell", {1, 7});
}

// 30 boards of 10 × 10 corners, .1 px of noise.
Problem synthetic(double field_of_view_deg, double wrong, const std::string& mrcal_model) {
  Lens lens;
  lens.max_theta_rad = field_of_view_deg / 2 * kPi / 180;
  lens.focal = {300, 300};
  lens.k = {-0.05, 0.0013, -0.0028, 0.00025};
  lens.image_size = {1280, 1024};
  lens.center = {655, 498};
  test::BoardSetup setup;
  setup.field_rad = lens.max_theta_rad;
  setup.outliers = wrong;
  test::SyntheticViews made = test::board_views(lens, setup);
  std::string name = "30 x 100 corners, " + std::to_string(std::lround(field_of_view_deg)) + " degrees";
  if (wrong > 0) name += ", " + std::to_string(std::lround(100 * wrong)) + " % wrong";
  return {name,       std::move(made.target_views), TargetTrust::exact, lens, std::move(made.wrong), {},
          mrcal_model};
}

std::optional<Problem> urban_fisheye1(const std::filesystem::path& data) {
  std::vector<std::string> files;
  for (int i = 1; i <= 15; ++i)
    files.push_back((data / "urban_fisheye1" / ("Fisheye1_" + std::to_string(i) + ".jpg")).string());
  if (!std::filesystem::exists(files.front())) return {};
  const auto board = calibration::board_from_text("6x8:32.5");
  verify_bug(board.ok(), "bench board refused");
  auto found = calibration::views_of_pictures(files, *board, [](std::size_t) {});
  verify_bug(found.ok(), "bench pictures refused");
  std::erase_if(found->target_views.views, [](const TargetView& view) { return view.points.empty(); });
  return Problem{"urban_fisheye1",
                 std::move(found->target_views),
                 TargetTrust::printed,
                 {},
                 {},
                 {},
                 "LENSMODEL_SPLINED_STEREOGRAPHIC_order=3_Nx=12_Ny=10_fov_x_deg=200"};
}

std::optional<Problem> ov_plane(const std::filesystem::path& data) {
  auto train = test::babelcalib_corners(data / "babelcalib_ov_plane" / "corners" / "train");
  auto unseen = test::babelcalib_corners(data / "babelcalib_ov_plane" / "corners" / "test");
  if (!train || !unseen) return {};
  return Problem{"ov_plane",
                 *std::move(train),
                 TargetTrust::exact,
                 {},
                 {},
                 *std::move(unseen),
                 "LENSMODEL_SPLINED_STEREOGRAPHIC_order=3_Nx=16_Ny=10_fov_x_deg=200"};
}

}  // namespace

std::vector<Row> lens_suite(const Options& options) {
  const std::string wide = "LENSMODEL_SPLINED_STEREOGRAPHIC_order=3_Nx=16_Ny=14_fov_x_deg=200";
  std::vector<Problem> problems = {synthetic(120, 0, "LENSMODEL_OPENCV8"), synthetic(180, 0, wide),
                                   synthetic(180, 0.05, wide)};
  if (!options.data_folder.empty()) {
    const auto data = std::filesystem::path(options.data_folder) / "fisheye_cal";
    if (auto real = urban_fisheye1(data)) problems.push_back(*std::move(real));
    if (auto real = ov_plane(data)) problems.push_back(*std::move(real));
  }
  std::vector<Row> rows;
  for (const Problem& problem : problems)
    for (Row& row : rows_of(problem, options)) rows.push_back(std::move(row));
  return rows;
}

}  // namespace lightwell::bench
