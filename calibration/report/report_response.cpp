// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "calibration/report/html_report.h"
#include "calibration/report/json_access.h"
#include "calibration/report/svg_plot.h"
#include "interface/response_json.h"

namespace lightwell::calibration {
namespace {

using nlohmann::json;

double value_or(const json& object, const char* key, double otherwise) {
  const auto found = object.find(key);
  return found != object.end() && found->is_number() ? found->get<double>() : otherwise;
}

struct Range {
  double low = 0.01, high = 1e6;  // cd/m²
};

// What can be drawn of a luminance, and multiplied by 2; also of one that is not finite.
double bounded(double luminance) {
  return luminance > 1e-30 ? std::min(luminance, 1e30) : 1e-30;
}

Range range_of(const Response& response, const json& fit) {
  double low = 1e300, high = 0;
  for (const char* list : {"fit", "check"})
    if (fit.contains(list))
      for (const json& patch : fit.at(list))
        if (const double l = value_or(patch, "luminance_cd_m2", 0); l > 0)
          low = std::min(low, l), high = std::max(high, l);
  if (high > 0) return {bounded(low) / 2, bounded(high) * 2};
  high = response.luminance_cd_m2(response.clip_code);
  low = std::max(response.luminance_cd_m2(response.black_code + 1), high * 1e-9);
  return {bounded(low), std::max(bounded(high), 2 * bounded(low))};
}

// An end of a bar; NaN, which is not drawn, where it is not known.
double end_of(const json& interval, std::size_t end) {
  const json& value = interval.at(end);
  return value.is_null() ? NAN : value.get<double>();
}

std::string curve_plot(const Response& response, const json& fit, const Range& range) {
  double top = 0, bottom = 1e300;
  SvgPlot::Points curve;
  for (int i = 0; i <= 300; ++i) {
    const double l = range.low * std::pow(range.high / range.low, i / 300.0);
    curve.emplace_back(l, response.code(l));
    top = std::max(top, curve.back().second);
    bottom = std::min(bottom, curve.back().second);
  }
  SvgPlot plot(620, 330, {range.low, range.high, true, "luminance, cd/m²"},
               {std::min(0.0, bottom), 1.05 * top, false, "code"});
  plot.line(curve, "curve");
  for (const char* list : {"fit", "check"})
    if (fit.contains(list))
      for (const json& patch : fit.at(list)) {
        const double l = value_or(patch, "luminance_cd_m2", 0), code = value_or(patch, "code", 0);
        if (const auto interval = patch.find("interval_95_cd_m2");
            interval != patch.end() && !interval->is_null())
          plot.bar_x(std::max(end_of(*interval, 0), range.low), end_of(*interval, 1), code, "error");
        const bool used = patch.value("used", true);
        plot.dot(l, code,
                 std::string(list) == "check" ? "check"
                 : used                       ? "fit"
                                              : "out",
                 patch.value("patch", std::string()) + ": " + formatted("%.3g cd/m2", l) + ", code " +
                     formatted("%.1f", code));
      }
  return plot.svg();
}

// Measured over true luminance, with the claimed 95 %.
std::string error_plot(const json& file, const json& fit, const Range& range) {
  const double t95 = value_or(fit, "t95", 2);
  double most = 2;  // percent; a tenth more than the farthest end of a bar
  for (const char* list : {"fit", "check"})
    for (const json& patch : fit.value(list, json::array()))
      if (const double l = value_or(patch, "luminance_cd_m2", 0); l > 0 && patch.value("used", true)) {
        most = std::max(most, 110 * std::abs(value_or(patch, "relative_error", 0)));
        if (const auto interval = patch.find("interval_95_cd_m2"); interval != patch.end())
          for (const json& end : *interval)
            if (end.is_number()) most = std::max(most, 110 * std::abs(end.get<double>() / l - 1));
      }
  most = std::min(most, 100.0);
  SvgPlot plot(620, 220, {range.low, range.high, true, "luminance, cd/m²"}, {-most, most, false, "error, %"});
  SvgPlot::Points low, high;
  const json& table = file.at("table");
  if (table.contains("relative_sigma")) {
    const json &sigma = list_at(table, "relative_sigma"), &luminance = list_at(table, "luminance_cd_m2");
    for (std::size_t i = 0; i < sigma.size(); i += 4) {
      const double l = luminance.at(i).get<double>();
      if (!sigma.at(i).is_number() || !(l > 0)) continue;
      const double width = std::min(100 * t95 * sigma.at(i).get<double>(), 1000.0);
      low.emplace_back(l, -width);
      high.emplace_back(l, width);
    }
    plot.band(low, high, "band");
  }
  plot.line({{range.low, 0}, {range.high, 0}}, "zero");
  for (const char* list : {"fit", "check"})
    for (const json& patch : fit.value(list, json::array())) {
      const double l = value_or(patch, "luminance_cd_m2", 0),
                   error = 100 * value_or(patch, "relative_error", NAN);
      if (const auto interval = patch.find("interval_95_cd_m2");
          l > 0 && interval != patch.end() && !interval->is_null())
        plot.bar_y(l, 100 * (end_of(*interval, 0) / l - 1), 100 * (end_of(*interval, 1) / l - 1), "error");
      plot.dot(l, std::clamp(error, -most, most),
               std::string(list) == "check" ? "check"
               : patch.value("used", true)  ? "fit"
                                            : "out",
               patch.value("patch", std::string()) + ": " + formatted("%+.2f %%", error));
    }
  return plot.svg();
}

// "good to 4 % from 0.02 to 2e+05 cd/m²"
std::string verdict_of(const json& file, const json& fit) {
  const auto range = fit.find("usable_range");
  if (range == fit.end() || !range->is_object()) return "";
  const double low = range->at("luminance_cd_m2").at(0).get<double>(),
               high = range->at("luminance_cd_m2").at(1).get<double>();
  const double t95 = value_or(fit, "t95", 2);
  double worst = 0;
  const json& table = file.at("table");
  const json sigmas = list_or_none(table, "relative_sigma");
  for (std::size_t i = 0; i < sigmas.size(); ++i) {
    const double l = table.at("luminance_cd_m2").at(i).get<double>();
    const json& sigma = sigmas.at(i);
    if (l >= low && l <= high && sigma.is_number()) worst = std::max(worst, t95 * sigma.get<double>());
  }
  return formatted("%.1f %%", 100 * worst) + " from " + plain_number(low) + " to " + plain_number(high) +
         " cd/m²";
}

std::string assumed_of(const json& file) {
  std::string out;
  const json assumed = file.value("assumed", json::object());
  for (const auto& [key, value] : assumed.items())
    out += (out.empty() ? "" : ", ") + key + " = " + formatted("%g", value.get<double>());
  return out.empty()
             ? out
             : out + (out.find(',') == std::string::npos ? " was" : " were") + " assumed, not stated. ";
}

std::string warning_of(const json& fit) {
  std::string out;
  for (const json& name : fit.value("rejected", json::array()))
    out += "patch " + name.get<std::string>() + " contradicts the others and was left out. ";
  int outside = 0;
  for (const json& patch : fit.value("check", json::array())) outside += !patch.value("inside_95", true);
  if (outside > 0) out += std::to_string(outside) + " check patch(es) lie outside their 95 % interval. ";
  if (fit.value("check", json::array()).empty())
    out += "no check patches: nothing independent confirms the response. ";
  return out;
}

std::string parameters_of(const json& fit) {
  const json &order = list_at(fit, "parameter_order"), &covariance = list_at(fit, "covariance");
  const json& values = fit.at("parameters");
  std::string out;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const std::string name = order.at(i).get<std::string>();
    const std::string sigma =
        formatted("%.2g", std::sqrt(std::max(0.0, covariance.at(i).at(i).get<double>())));
    const auto value = values.find(name);
    out += (i > 0 ? ", " : " ") + escaped(name) +
           (value != values.end() && value->is_number() ? formatted(" = %.6g", value->get<double>())
                                                        : std::string()) +
           " ± " + sigma;
  }
  return " Parameters, with standard deviations:" + out + ".";
}

std::string patch_table(const json& fit) {
  std::string out =
      "<table class=\"patches\"><tr><th>patch</th><th>luminance, cd/m²</th><th>code</th><th>measured, "
      "cd/m²</th><th>error</th>"
      "<th>stops</th><th></th></tr>";
  for (const char* list : {"fit", "check"})
    for (const json& patch : fit.value(list, json::array())) {
      const double error = value_or(patch, "relative_error", NAN);
      const bool check = std::string(list) == "check";
      out += "<tr><td>" + escaped(patch.value("patch", std::string())) + "</td><td>" +
             plain_number(value_or(patch, "luminance_cd_m2", 0)) + "</td><td>" +
             formatted("%.1f", value_or(patch, "code", 0)) + "</td><td>" +
             plain_number(value_or(patch, "measured_cd_m2", 0)) + "</td><td>" +
             (std::isfinite(error) ? formatted("%+.2f %%", 100 * error) : "–") + "</td><td>" +
             (std::isfinite(error) ? formatted("%+.3f", value_or(patch, "stops", 0)) : "–") + "</td><td>" +
             (check ? patch.value("inside_95", true) ? "check, as foretold" : "check, OUTSIDE its 95 %"
              : patch.value("used", true) ? "fitted"
                                          : "left out: contradicts the others") +
             "</td></tr>";
    }
  return out + "</table>";
}

}  // namespace

ReportSection response_section(const Response& response, const json& file) {
  ReportSection out;
  const json fit = file.value("fit", json::object());
  const Range range = range_of(response, fit);
  out.html = "<h2>Response</h2><p>" + std::string(model_name(response)) + " model, " +
             std::to_string(response.bits) + " bits, at " +
             formatted("%g µs", response.reference_exposure_us) + ".";
  if (fit.contains("parameters") && fit.contains("covariance") && fit.contains("parameter_order"))
    out.html += parameters_of(fit);
  out.html +=
      "</p><p class=\"note\">The line is the response, the dots are the patches: <i class=\"key "
      "fit\"></i>fitted <i class=\"key check\"></i>check <i class=\"key out\"></i>left out. "
      "Bars, where they are wide enough to be seen, hold the true luminance with 95 % probability.</p>" +
      curve_plot(response, fit, range);
  if (!fit.empty() && file.contains("table"))
    out.html +=
        "<p class=\"note\">How far the measured luminance of each patch lies from the meter's. The band "
        "holds the error "
        "of the response itself with 95 % probability; the bars add the meter's and the code's noise.</p>" +
        error_plot(file, fit, range) + patch_table(fit);
  if (!fit.empty() && file.contains("table")) {
    out.verdict = verdict_of(file, fit);
    out.warning = assumed_of(file) + warning_of(fit);
    if (out.verdict.empty()) out.warning += "the response is nowhere known to 5 %. ";
  } else if (file.contains("brackets")) {
    if (has_number(file.at("brackets"), "median_error"))
      out.verdict =
          formatted("%.1f %% between exposures", 100 * file.at("brackets").at("median_error").get<double>());
    else
      out.warning = "the response says nothing about its error: too few exposures. ";
    if (!file.at("brackets").value("absolute", false))
      out.warning += "luminance is relative: compare with a meter. ";
  } else {
    out.warning = "the response says nothing about its error. ";
  }
  return out;
}

}  // namespace lightwell::calibration
