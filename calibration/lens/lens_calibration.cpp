// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/lens/lens_calibration.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "calibration/lens/lens_selection.h"
#include "calibration/lens/lens_start.h"
#include "calibration/lens/repeated_views.h"
#include "calibration/lens/view_geometry.h"
#include "lighting/median.h"

namespace lightwell::calibration {
namespace {

constexpr std::size_t kFewestViews = 3;
constexpr std::size_t kFewestPoints =
    6;  // twice what a pose has unknowns for, and some to tell wrong ones by
constexpr double kSquares = std::numeric_limits<double>::infinity();
constexpr double kGate = 5;  // standard deviations: Gauss's tail beyond it holds one point in 300,000

std::string text(const char* format, double a, double b = 0) {
  char buffer[160];
  std::snprintf(buffer, sizeof buffer, format, a, b);
  return buffer;
}

// A view while it is being judged.
struct Judged {
  const TargetView* view = nullptr;
  std::optional<TargetPose> pose;
  bool used = true;
  std::vector<bool> good;  // a point

  [[nodiscard]] std::vector<Correspondence> good_points() const {
    std::vector<Correspondence> out;
    for (std::size_t i = 0; i < good.size(); ++i)
      if (good[i]) out.push_back(view->points[i]);
    return out;
  }
};

// All points of the used views, or the good ones only, with the indices of the views in `judged`.
std::vector<PosedView> posed(const std::vector<Judged>& judged, bool good_only) {
  std::vector<PosedView> out;
  for (const Judged& j : judged)
    if (j.used) out.push_back({*j.pose, good_only ? j.good_points() : j.view->points});
  return out;
}

void take_poses(std::vector<Judged>& judged, const std::vector<PosedView>& views) {
  std::size_t i = 0;
  for (Judged& j : judged)
    if (j.used) j.pose = views[i++].pose;
}

// Standard deviation of a coordinate from the middle of the errors: a Rayleigh variable's median is 1.1774 σ.
double robust_noise_px(const Lens& lens, const std::vector<Judged>& judged) {
  std::vector<double> errors;
  for (const Judged& j : judged)
    if (j.used)
      for (const double e : errors_px(lens, *j.pose, j.view->points)) errors.push_back(e);
  return median(std::move(errors)) / 1.1774;
}

double robust_adjust(Lens& lens, std::vector<Judged>& judged, const LensFreedom& freedom, int iterations) {
  std::vector<PosedView> views = posed(judged, false);
  // The scale at which Cauchy's loss of a normal number has 95 % of the efficiency of least squares.
  const double scale = 2.385 * std::max(1e-4, robust_noise_px(lens, judged));
  if (!(adjust(lens, views, {freedom, scale, iterations}) >= 0)) return kSquares;
  take_poses(judged, views);
  const double noise = robust_noise_px(lens, judged);
  return std::isfinite(noise) ? noise : kSquares;
}

// Every view's pose under a lens; views without one are not used.
void find_poses(const Lens& lens, std::vector<Judged>& judged) {
  for (Judged& j : judged) {
    j.pose = robust_pose(lens, j.view->points);
    j.used = j.pose.has_value();
  }
}

std::size_t used_count(const std::vector<Judged>& judged) {
  return static_cast<std::size_t>(
      std::count_if(judged.begin(), judged.end(), [](auto& j) { return j.used; }));
}

struct Solution {
  Lens lens;
  std::vector<Judged> judged;
  double noise_px = kSquares;
};

// From each start a short robust adjustment; the one that leaves the least goes on. Where none leaves anything finite:
// the one that placed most boards.
Solution best_start(const TargetViews& target_views, const std::vector<Judged>& judged) {
  constexpr std::size_t kStarts = 4;
  Solution best, failed;
  for (const Lens& start : lens_starts(target_views, kStarts)) {
    Solution s{start, judged, kSquares};
    find_poses(s.lens, s.judged);
    if (failed.judged.empty() || used_count(s.judged) > used_count(failed.judged)) failed = s;
    if (used_count(s.judged) < kFewestViews) continue;
    robust_adjust(s.lens, s.judged, {1, false, true}, 8);
    s.noise_px = robust_adjust(s.lens, s.judged, {2, false, true}, 12);
    if (s.noise_px < best.noise_px) best = std::move(s);
    constexpr double kNeedsNoRival = 0.5;  // pixels: a detector's own noise
    if (best.noise_px < kNeedsNoRival) break;
  }
  return std::isfinite(best.noise_px) ? best : failed;
}

// Which points and views the lens explains. Views that were out are looked at anew. True where nothing changed.
bool judge(const Lens& lens, std::vector<Judged>& judged, double noise_px) {
  const double gate = std::max(kGate * noise_px, 1e-3);
  bool same = true;
  for (Judged& j : judged) {
    if (!j.used) j.pose = robust_pose(lens, j.view->points);
    std::vector<bool> good(j.view->points.size(), false);
    std::size_t count = 0;
    if (j.pose) {
      const std::vector<double> errors = errors_px(lens, *j.pose, j.view->points);
      for (std::size_t i = 0; i < errors.size(); ++i) count += (good[i] = errors[i] <= gate);
    }
    const bool used = count >= kFewestPoints && 2 * count >= good.size();
    same = same && used == j.used && good == j.good;
    j.used = used;
    j.good = std::move(good);
  }
  return same;
}

// Lens, poses and judgement in turns until nothing changes.
void settle(Solution& s, int rounds) {
  for (int round = 0; round < rounds; ++round) {
    s.noise_px = robust_adjust(s.lens, s.judged, {round == 0 ? 3 : 4, true, true}, round < 2 ? 30 : 15);
    if (!std::isfinite(s.noise_px)) return;
    const bool settled = judge(s.lens, s.judged, s.noise_px);
    if (used_count(s.judged) < kFewestViews || (settled && round > 1)) return;
  }
}

// The solution goes on with the points of the board of that shape, which are kept in `shaped`.
void take_shape(Solution& s, const TargetShape& shape, const TargetViews& square, TargetViews& shaped) {
  shaped = square;
  for (TargetView& view : shaped.views)
    for (Correspondence& p : view.points) p.target_mm = shape.place(p.target_mm);
  for (std::size_t i = 0; i < s.judged.size(); ++i) s.judged[i].view = &shaped.views[i];
  settle(s, 5);
}

// A printer stretches and shears by a percent or two. Rows of another pitch than the columns are another board.
Status printable(const TargetShape& shape) {
  constexpr double kMost = 0.05;
  const double stretch = std::abs(shape.change_mm[0]) / shape.half_mm;
  const double shear = std::abs(shape.change_mm[1]) / shape.half_mm;
  if (stretch <= kMost && shear <= kMost) return {};
  return Error{ErrorKind::bad_input, "the points are of a board stretched by " +
                                         text("%.1f %%", 100 * stretch) + " and sheared by " +
                                         text("%.1f %%", 100 * shear) + ", allowed at most " +
                                         text("%.0f %%", 100 * kMost) +
                                         ": is the board's size right, are the points in its order?"};
}

Status separable(const Lens& lens, const std::vector<Judged>& judged) {
  std::vector<Eigen::Matrix3d> turns;
  std::vector<std::vector<Correspondence>> points;
  for (const Judged& j : judged)
    if (j.used) {
      turns.push_back(j.pose->camera_from_target());
      points.push_back(j.good_points());
    }
  constexpr double kLeastTiltDeg = 5;
  if (const auto spread = spread_of_normals_deg(turns, points); spread && *spread < kLeastTiltDeg)
    return Error{ErrorKind::bad_input,
                 "all boards are parallel, their normals within " + text("%.1f", *spread) +
                     " degrees: focal length and distance cannot be separated; allowed: normals at least " +
                     text("%.0f", kLeastTiltDeg) + " degrees apart"};
  const double reach = reach_of_points(lens, points);
  constexpr double kLeastReach = 0.4;
  if (reach < kLeastReach)
    return Error{ErrorKind::bad_input,
                 "all boards are in the middle of the image: the farthest corner is " +
                     text("%.0f %% of the way from the centre to the nearest edge", 100 * reach) +
                     ", allowed at least " + text("%.0f %%", 100 * kLeastReach)};
  return {};
}

std::string names_of(const std::vector<Judged>& judged, bool used) {
  constexpr std::size_t kMost = 5;
  std::string out;
  std::size_t count = 0;
  for (const Judged& j : judged)
    if (j.used == used && ++count <= kMost) out += (out.empty() ? "" : ", ") + j.view->name;
  return count <= kMost ? out : out + " and " + std::to_string(count - kMost) + " more";
}

Error too_few(std::size_t seen, const std::string& detail) {
  return {ErrorKind::bad_input, "the board is usable in " + std::to_string(seen) +
                                    " views, allowed at least " + std::to_string(kFewestViews) + detail};
}

// Why no start led to a lens.
Error no_start(const Solution& s) {
  const std::size_t placed = used_count(s.judged);
  if (placed < kFewestViews)
    return too_few(placed, ": the points of " + names_of(s.judged, false) +
                               " do not determine where the board is, they lie on a line or at one place");
  return {ErrorKind::bad_input, "no lens can be fitted to the points of " + names_of(s.judged, true) +
                                    ": is the board's size right, are the points in its order?"};
}

Eigen::Matrix<double, 8, 1> change_of(const Lens& from, const Lens& to) {
  Eigen::Matrix<double, 8, 1> d;
  d << to.focal - from.focal, to.center - from.center, 0, 0, 0, 0;
  for (std::size_t i = 0; i < 4; ++i) d[static_cast<Eigen::Index>(4 + i)] = to.k[i] - from.k[i];
  return d;
}

// Where the lens leans on the wall that keeps its projection growing: that, with the shift which the wall caused taken
// into the covariance. The part that the data alone would leave stays as it is: the wall may be right or wrong.
void account_for_walls(LensCalibration& c, std::vector<PosedView> views) {
  constexpr double kNear = 0.001;     // the walls give a little
  constexpr double kNoShift = 0.001;  // standard deviations
  const LeastGrowth least = least_growth(c.lens, c.lens.max_theta_rad);
  if (!(least.slope < kLeastSlope + kNear)) return;
  Lens lens = c.lens;
  AdjustmentOptions options{c.freedom, kSquares, 100};
  options.walls = false;
  if (!(adjust(lens, views, options) >= 0)) return;
  const Eigen::Matrix<double, 8, 1> shift = change_of(c.lens, lens);
  LensConstraint constraint{least.theta_rad, 0, shift};
  for (Eigen::Index i = 0; i < 8; ++i)
    if (c.covariance(i, i) > 0)
      constraint.shift_sigma =
          std::max(constraint.shift_sigma, std::abs(shift[i]) / std::sqrt(c.covariance(i, i)));
  if (!(constraint.shift_sigma > kNoShift)) return;
  c.covariance += shift * shift.transpose();
  c.constraint = constraint;
}

// Final values on the points that count, with the freedom the data support.
Result<LensCalibration> concluded(Solution& s, const std::optional<TargetShape>& shape) {
  std::vector<PosedView> views = posed(s.judged, true);
  LensCalibration out;
  out.lens = s.lens;
  const Error undetermined{
      ErrorKind::bad_input,
      "the views do not determine a lens: move the board over the whole image and tilt it"};
  if (!(adjust(out.lens, views, {{}, kSquares, 50}) >= 0)) return undetermined;
  LensSelection selection = select_freedom(out.lens, views);
  const int selected = selection.freedom.coefficients;
  std::optional<Eigen::Matrix<double, 8, 8>> covariance;
  for (;; --selection.freedom.coefficients) {
    const double squared = adjust(out.lens, views, {selection.freedom, kSquares, 100});
    out.lens.max_theta_rad = std::min(kPi, largest_theta_rad(views));
    std::size_t points = 0;
    for (const PosedView& view : views) points += view.points.size();
    const double unknowns = 6.0 * static_cast<double>(views.size()) + 3 + selection.freedom.coefficients +
                            (selection.freedom.aspect ? 1 : 0) + (shape ? 5 : 0);
    out.rms_px = std::sqrt(squared / static_cast<double>(points));
    out.noise_px = std::sqrt(squared / std::max(1.0, 2 * static_cast<double>(points) - unknowns));
    covariance = lens_covariance(out.lens, views, selection.freedom, out.noise_px, shape ? &*shape : nullptr);
    if (squared >= 0 && covariance && check(out.lens)) break;
    if (selection.freedom.coefficients == 0) return undetermined;
  }
  out.supported_theta_rad = out.lens.max_theta_rad;
  out.freedom = selection.freedom;
  out.held_out_rms_px = out.freedom.coefficients == selected ? selection.held_out_rms_px
                                                             : held_out_rms_px(out.lens, views, out.freedom);
  out.covariance = *covariance;
  account_for_walls(out, views);
  take_poses(s.judged, views);
  constexpr double kLargestFocalError = 0.05;
  const double focal_error = std::sqrt(out.covariance(0, 0)) / out.lens.focal.x();
  if (focal_error > kLargestFocalError)
    return Error{ErrorKind::bad_input,
                 "the views do not determine the focal length: its standard deviation is " +
                     text("%.0f %%, allowed at most %.0f %%; ", 100 * focal_error, 100 * kLargestFocalError) +
                     "tilt the board and move it to the edges"};
  return out;
}

ViewResult result_of(const Lens& lens, const Judged& j, double gate_px) {
  ViewResult out;
  out.name = j.view->name;
  out.used = j.used;
  if (j.pose) {
    out.pose = *j.pose;
    const Eigen::Matrix3d rotation = j.pose->camera_from_target();
    double sum = 0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < j.view->points.size(); ++i) {
      const auto& p = j.view->points[i];
      out.residuals_px.push_back(lens.project(rotation * p.target_mm + j.pose->translation_mm) - p.pixel);
      if (!j.good[i]) out.rejected.push_back(i);
      if (j.used && !j.good[i]) continue;
      sum += out.residuals_px.back().squaredNorm();
      ++count;
    }
    out.rms_px = count > 0 ? std::sqrt(sum / static_cast<double>(count)) : 0;
  }
  if (j.used) return out;
  if (j.view->points.size() < kFewestPoints)
    out.reason =
        "has " + std::to_string(j.view->points.size()) + " points, needs " + std::to_string(kFewestPoints);
  else if (!j.pose)
    out.reason = "its points do not determine where the board is";
  else
    out.reason =
        std::to_string(out.rejected.size()) + " of " + std::to_string(j.view->points.size()) +
        text(" points are more than %.2g px from where the lens of the other views puts them", gate_px);
  return out;
}

// Repeats among the views that count; a view that does not weighs nothing.
void mark_repeats(LensCalibration& c, const TargetViews& target_views) {
  std::vector<TargetView> used;
  std::vector<std::size_t> index;
  for (std::size_t v = 0; v < c.views.size(); ++v)
    if (c.views[v].used) {
      TargetView good{c.views[v].name, {}};
      for (std::size_t i = 0, r = 0; i < target_views.views[v].points.size(); ++i)
        if (r < c.views[v].rejected.size() && c.views[v].rejected[r] == i)
          ++r;
        else
          good.points.push_back(target_views.views[v].points[i]);
      used.push_back(std::move(good));
      index.push_back(v);
    }
  const auto repeats = repeated_views(used, c.noise_px);
  for (std::size_t i = 0; i < repeats.size(); ++i)
    if (repeats[i]) c.views[index[i]].repeats = index[*repeats[i]];
}

}  // namespace

Result<LensCalibration> calibrate_lens(const TargetViews& target_views, TargetTrust trust) {
  std::vector<Judged> judged;
  TargetViews usable{target_views.image_size, {}};
  for (const TargetView& view : target_views.views)
    if (view.points.size() >= kFewestPoints) {
      usable.views.push_back(view);
      judged.push_back({&view, {}, true, std::vector<bool>(view.points.size(), true)});
    }
  if (judged.size() < kFewestViews)
    return too_few(judged.size(), judged.empty() ? "" : " (" + names_of(judged, true) + ")");

  Solution s = best_start(usable, judged);
  if (!std::isfinite(s.noise_px)) return no_start(s);
  settle(s, 10);
  // A hundredth of the image is not a detector's error: the numbers are not of one board and one lens.
  const double limit = 0.01 * std::max(target_views.image_size[0], target_views.image_size[1]);
  if (!(s.noise_px < limit))
    return Error{ErrorKind::bad_input, "the points fit no lens, they are off by " + text("%.1f", s.noise_px) +
                                           " px, allowed below " + text("%.1f", limit) +
                                           ": is the board's size right, are the points in its order?"};
  if (used_count(s.judged) < kFewestViews)
    return too_few(used_count(s.judged), ": no one lens explains " + names_of(s.judged, false));
  if (const Status status = separable(s.lens, s.judged); !status) return status.error();
  const auto found = supported_shape(s.lens, posed(s.judged, true), square_shape(usable.views));
  if (found)
    if (const Status status = printable(*found); !status) return status.error();
  const bool take = found && trust == TargetTrust::printed;
  TargetViews shaped;
  if (take) take_shape(s, *found, usable, shaped);
  auto out = concluded(s, take ? found : std::nullopt);
  if (!out) return out.error();
  out->trust = trust;
  (take ? out->shape : out->doubted_shape) = found;
  std::size_t next = 0;
  for (const TargetView& view : target_views.views) {
    const bool known = view.points.size() >= kFewestPoints;
    const Judged few{&view, {}, false, std::vector<bool>(view.points.size(), false)};
    out->views.push_back(result_of(out->lens, known ? s.judged[next++] : few, kGate * s.noise_px));
  }
  mark_repeats(*out, target_views);
  return out;
}

Status set_field(LensCalibration& calibration, double max_theta_rad) {
  const double limit = increasing_to_rad(calibration.lens);
  if (!(max_theta_rad > 0 && max_theta_rad <= limit))
    return Error{ErrorKind::bad_input,
                 "a field to " +
                     text("%.1f degrees, allowed above 0, at most %.1f", max_theta_rad * 180 / kPi,
                          std::floor(limit * 1800 / kPi) / 10) +
                     ": beyond it the projection of this lens stops growing"};
  calibration.lens.max_theta_rad = max_theta_rad;
  return {};
}

ViewResult fit_view(const Lens& lens, const TargetView& view) {
  Judged j{&view, robust_pose(lens, view.points), false, std::vector<bool>(view.points.size(), true)};
  if (j.pose) j.pose = refined_pose(lens, *j.pose, view.points, kSquares);
  j.used = j.pose.has_value();
  return result_of(lens, j, 0);
}

}  // namespace lightwell::calibration
