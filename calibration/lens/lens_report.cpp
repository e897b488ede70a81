// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/lens/lens_report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "calibration/lens/field_coverage.h"
#include "calibration/lens/lens_selection.h"
#include "calibration/lens/lens_uncertainty.h"
#include "interface/lens_json.h"

namespace lightwell::calibration {
namespace {

using nlohmann::ordered_json;

constexpr double kDegreesPerRadian = 180 / kPi;

ordered_json number_or_null(double value) {
  return std::isfinite(value) ? ordered_json(value) : ordered_json(nullptr);
}

// 61.5, and 70 without a zero behind it.
std::string tenths(double degrees) {
  char text[32];
  std::snprintf(text, sizeof text, "%.12g", std::round(10 * degrees) / 10);
  return text;
}

ordered_json view_json(const LensCalibration& calibration, const ViewResult& result, const TargetView& view) {
  ordered_json out = {
      {"name", result.name},
      {"used", result.used},
      {"points", view.points.size()},
      {"rms_px", result.residuals_px.empty() ? ordered_json(nullptr) : ordered_json(result.rms_px)},
      {"rejected", result.rejected},
      {"reason", result.reason}};
  if (result.repeats) out["repeats"] = calibration.views[*result.repeats].name;
  ordered_json arrows = ordered_json::array();
  for (std::size_t i = 0; i < result.residuals_px.size(); ++i) {
    // Thousandths of a pixel are finer than can be seen.
    const auto rounded = [](double v) { return std::round(v * 1000) / 1000; };
    const Vec2d& at = view.points[i].pixel;
    const Vec2d& error = result.residuals_px[i];
    arrows.push_back({rounded(at.x()), rounded(at.y()), rounded(error.x()), rounded(error.y())});
  }
  out["residuals_px"] = std::move(arrows);
  if (!result.residuals_px.empty()) {
    const Vec3d& r = result.pose.rotation;
    const Vec3d& t = result.pose.translation_mm;
    out["pose"] = {{"rotation_rad", {r.x(), r.y(), r.z()}}, {"translation_mm", {t.x(), t.y(), t.z()}}};
  }
  return out;
}

ordered_json uncertainty_json(const LensCalibration& calibration) {
  // The turn that is taken out is that of the field that the points support, not of its extrapolation.
  Lens supported = calibration.lens;
  supported.max_theta_rad = std::min(supported.max_theta_rad, calibration.supported_theta_rad);
  const ProjectionUncertainty uncertainty(supported, calibration.covariance);
  constexpr int kRings = 24, kSectors = 24;
  ordered_json theta = ordered_json::array(), azimuth = ordered_json::array(), sigma = ordered_json::array();
  double largest = 0;
  for (int s = 0; s < kSectors; ++s) azimuth.push_back(360.0 * s / kSectors);
  for (int ring = 0; ring <= kRings; ++ring) {
    const double t = calibration.lens.max_theta_rad * ring / kRings;
    theta.push_back(t * kDegreesPerRadian);
    ordered_json row = ordered_json::array();
    for (int s = 0; s < kSectors; ++s) {
      const double a = 2 * kPi * s / kSectors;
      row.push_back(
          uncertainty.worst_px({std::sin(t) * std::sin(a), -std::sin(t) * std::cos(a), std::cos(t)}));
      largest = std::max(largest, row.back().get<double>());
    }
    sigma.push_back(std::move(row));
  }
  return {{"theta_deg", std::move(theta)},
          {"azimuth_deg", std::move(azimuth)},
          {"sigma_px", std::move(sigma)},
          {"largest_sigma_px", largest}};
}

ordered_json shape_json(const TargetShape& shape) {
  const auto& c = shape.change_mm;
  return {{"stretch", c[0]}, {"shear", c[1]}, {"bow_x", c[2]},
          {"bow_y", c[3]},   {"twist", c[4]}, {"half_width", shape.half_mm}};
}

}  // namespace

ordered_json lens_report(const LensCalibration& calibration, const TargetViews& target_views) {
  const nlohmann::json lens = lens_to_json(calibration.lens);
  ordered_json out;
  for (const char* key : {"schema", "model", "image_size", "focal", "center", "k", "max_theta_deg"})
    out[key] = lens.at(key);
  out["supported_theta_deg"] = calibration.supported_theta_rad * kDegreesPerRadian;
  if (lens.contains("zenith")) out["zenith"] = lens.at("zenith");
  ordered_json covariance = ordered_json::array();
  for (Eigen::Index r = 0; r < 8; ++r) {
    ordered_json row = ordered_json::array();
    for (Eigen::Index c = 0; c < 8; ++c) row.push_back(calibration.covariance(r, c));
    covariance.push_back(std::move(row));
  }
  out["covariance"] = std::move(covariance);
  out["rms_px"] = calibration.rms_px;
  out["held_out_rms_px"] = number_or_null(calibration.held_out_rms_px);
  out["noise_px"] = calibration.noise_px;
  out["coefficients"] = calibration.freedom.coefficients;
  out["coefficients_rule"] = kCoefficientsRule;
  out["aspect_free"] = calibration.freedom.aspect;
  if (const auto& held = calibration.constraint)
    out["constrained"] = {{"theta_deg", held->theta_rad * kDegreesPerRadian},
                          {"least_slope", kLeastSlope},
                          {"shift_sigma", held->shift_sigma}};
  out["projection_uncertainty"] = uncertainty_json(calibration);
  out["target"] = calibration.trust == TargetTrust::exact ? "exact" : "printed";
  if (calibration.shape) out["board_shape_mm"] = shape_json(*calibration.shape);
  if (calibration.doubted_shape) out["doubted_board_shape_mm"] = shape_json(*calibration.doubted_shape);
  const FieldCoverage coverage = field_coverage(calibration, target_views);
  out["coverage"] = {{"ring_deg", coverage.ring_deg},
                     {"sector_deg", 360.0 / static_cast<double>(FieldCoverage::kSectors)},
                     {"points", coverage.points}};
  ordered_json views = ordered_json::array();
  for (std::size_t i = 0; i < calibration.views.size(); ++i)
    views.push_back(view_json(calibration, calibration.views[i], target_views.views[i]));
  out["views"] = std::move(views);
  return out;
}

std::vector<std::string> lens_warnings(const LensCalibration& calibration) {
  std::vector<std::string> out;
  if (const auto& held = calibration.constraint) {
    char text[240];
    std::snprintf(
        text, sizeof text,
        "the points would have the projection stop growing at %.1f degrees off axis, where it is held; the "
        "uncertainty has that shift, of %.1f standard deviations, in it",
        held->theta_rad * kDegreesPerRadian, held->shift_sigma);
    out.emplace_back(text);
  }
  for (const ViewResult& view : calibration.views)
    if (view.repeats)
      out.push_back(view.name + " shows the board where " + calibration.views[*view.repeats].name +
                    " does, within the noise: they count as two, so the lens is less sure than it says");
  return out;
}

std::string coverage_gaps(const LensCalibration& calibration, const TargetViews& target_views) {
  const FieldCoverage coverage = field_coverage(calibration, target_views);
  const auto sector_deg = static_cast<int>(360 / FieldCoverage::kSectors);
  std::string out;
  for (std::size_t ring = 0; ring < coverage.points.size(); ++ring) {
    std::string sectors;
    const auto& row = coverage.points[ring];
    for (std::size_t s = 0; s < row.size(); ++s) {
      if (row[s] > 0) continue;
      std::size_t end = s;
      while (end + 1 < row.size() && row[end + 1] == 0) ++end;
      sectors += (sectors.empty() ? "" : ", ") + std::to_string(static_cast<int>(s) * sector_deg) + " to " +
                 std::to_string(static_cast<int>(end + 1) * sector_deg);
      s = end;
    }
    if (sectors.empty()) continue;
    const double begin = coverage.ring_deg * static_cast<double>(ring);
    const double end = ring + 1 < coverage.points.size() ? begin + coverage.ring_deg
                                                         : calibration.lens.max_theta_rad * kDegreesPerRadian;
    out += (out.empty() ? "" : "; ") + tenths(begin) + " to " + tenths(end) + " degrees off axis: azimuth " +
           sectors;
  }
  return out;
}

}  // namespace lightwell::calibration
