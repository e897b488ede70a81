// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "calibration/report/html_report.h"
#include "calibration/report/svg_plot.h"

namespace lightwell::calibration {
namespace {

using nlohmann::json;

constexpr double kSure = 1.96;         // 95 %, normal
constexpr double kWorthSaying = 0.05;  // of a scene's tilt

bool is_number(const json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_number();
}

// Standard deviation of T at an angle; 0 where the file does not say.
double sigma_of_transmission(const json& fit, double theta_rad) {
  const auto covariance = fit.find("covariance");
  if (covariance == fit.end() || covariance->size() != 3) return 0;
  double variance = 0;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      variance +=
          covariance->at(i).at(j).get<double>() * std::pow(theta_rad, 2.0 * static_cast<double>(i + j + 2));
  return std::sqrt(std::max(0.0, variance));
}

std::string vignetting_plot(const FlatField& flat, double max_theta_rad, const json& fit) {
  SvgPlot::Points curve, low, high;
  double least = 1, most = 1;
  for (int i = 0; i <= 100; ++i) {
    const double theta = max_theta_rad * i / 100, deg = theta * 180 / kPi;
    const double t = flat.transmission(theta), wide = kSure * sigma_of_transmission(fit, theta);
    curve.emplace_back(deg, 100 * t);
    low.emplace_back(deg, 100 * (t - wide));
    high.emplace_back(deg, 100 * (t + wide));
    least = std::min(least, t - wide);
    most = std::max(most, t + wide);
  }
  SvgPlot plot(
      620, 240, {0, max_theta_rad * 180 / kPi, false, "angle off axis, degrees"},
      {std::floor(10 * std::max(least, 0.0)) * 10, 100 * std::min(most, 2.0) + 5, false, "transmission, %"});
  plot.band(low, high, "band");
  plot.line(curve, "curve");
  return plot.svg();
}

std::string pattern_text(const json& fit) {
  std::string out;
  if (is_number(fit, "offset_rms_codes") && is_number(fit, "offset_sigma_codes") &&
      fit.value("offset_from", std::string()) != "nothing")
    out +=
        " Pixels add " + formatted("%.2f codes rms", fit.at("offset_rms_codes").get<double>()) +
        ", known to " +
        formatted("%.2f", std::hypot(fit.at("offset_sigma_codes").get<double>(),
                                     fit.value("offset_shared_sigma_codes", 0.0))) +
        (fit.contains("offset_from") ? ", from " + escaped(fit.at("offset_from").get<std::string>()) : "") +
        ".";
  if (fit.value("gain_supported", false))
    out += " Their gains differ by " + formatted("%.2f %%", 100 * fit.at("gain_rms").get<double>()) +
           ", known to " + formatted("%.2f %%.", 100 * fit.at("gain_sigma").get<double>());
  if (is_number(fit, "masked_pixels") && fit.at("masked_pixels").get<double>() > 0)
    out += formatted(" %.0f pixels of lamps or dust were left out.", fit.at("masked_pixels").get<double>());
  if (is_number(fit, "temperature_c"))
    out += " Measured at " + formatted("%.1f °C", fit.at("temperature_c").get<double>()) +
           ": the pattern changes with temperature.";
  return out;
}

}  // namespace

ReportSection flat_section(const FlatField& flat, double max_theta_rad, const json& file) {
  ReportSection out;
  const json fit = file.value("fit", json::object());
  const double edge = flat.transmission(max_theta_rad), sigma = sigma_of_transmission(fit, max_theta_rad);
  out.html =
      "<h2>Flat field</h2><p>" + formatted("%.1f", 100 * edge) +
      (sigma > 0 ? formatted(" ± %.1f", 100 * kSure * sigma) : std::string()) +
      " % of the light is left at the edge of the field, " + formatted("%.0f°", max_theta_rad * 180 / kPi) +
      " off axis" +
      (fit.value("vignetting_from", std::string()) == "turning" ? ", found by turning the camera"
                                                                : ", if the scene was as bright there") +
      "." + pattern_text(fit) + "</p>";
  if (is_number(fit, "scene_tilt") && fit.at("scene_tilt").get<double>() > kWorthSaying)
    out.warning = "the scene for the flat field changed by " +
                  formatted("%.0f %%", 100 * fit.at("scene_tilt").get<double>()) +
                  " from the centre to the edge. ";
  if (sigma > kWorthSaying / kSure)
    out.warning +=
        "vignetting at the edge is known to " + formatted("%.0f %%", 100 * kSure * sigma) + " only. ";
  out.html += vignetting_plot(flat, max_theta_rad, fit) +
              "<p class=\"note\">The line is what the lens lets through" +
              (sigma > 0 ? std::string(", the band where it lies with 95 % probability") : "") + ".</p>";
  return out;
}

}  // namespace lightwell::calibration
