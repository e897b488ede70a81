// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "calibration/report/html_report.h"
#include "calibration/report/json_access.h"
#include "calibration/report/residual_plots.h"
#include "calibration/report/svg_plot.h"

namespace lightwell::calibration {
namespace {

using nlohmann::json;

std::string view_table(const json& views) {
  std::string out = "<table><tr><th>view</th><th>points</th><th>rejected</th><th>rms, px</th><th></th></tr>";
  for (const json& view : views)
    out += "<tr><td>" + escaped(file_name(view.value("name", std::string()))) + "</td><td>" +
           (has_number(view, "points") ? formatted("%.0f", view.at("points").get<double>()) : "") +
           "</td><td>" + std::to_string(list_or_none(view, "rejected").size()) + "</td><td>" +
           (has_number(view, "rms_px") ? formatted("%.3f", view.at("rms_px").get<double>()) : "–") +
           "</td><td>" + (view.value("used", true) ? "" : "not used: ") +
           escaped(view.value("reason", std::string())) +
           (view.contains("repeats")
                ? "the pose of " + escaped(file_name(view.at("repeats").get<std::string>())) + " again"
                : "") +
           "</td></tr>";
  return out + "</table>";
}

// Where a ring of the coverage ends; the last one with the field.
double ring_end_deg(const json& coverage, std::size_t ring, double max_deg) {
  const double width = coverage.at("ring_deg").get<double>(), end = width * static_cast<double>(ring + 1);
  const bool last = ring + 1 == coverage.at("points").size();
  return last && std::abs(max_deg - end) <= width / 2 ? max_deg : end;
}

std::string coverage_map(const json& coverage, double max_deg) {
  const json& points = list_at(coverage, "points");
  double most = 1;
  for (const json& ring : points)
    for (const json& count : list(ring)) most = std::max(most, count.get<double>());
  std::vector<std::vector<std::string>> fill;
  std::vector<std::string> rim;
  for (const json& ring : points) {
    fill.emplace_back();
    for (const json& count : ring) {
      const double n = count.get<double>();
      fill.back().push_back(n > 0 ? shade(0.15 + 0.85 * std::sqrt(n / most)) : "#f6c9c4");
    }
    rim.push_back(fill.size() % 3 == 0 ? formatted("%.0f°", ring_end_deg(coverage, fill.size() - 1, max_deg))
                                       : "");
  }
  return "<figure>" + polar_cells(300, fill, rim) + "<figcaption>points in a cell: dark is " +
         formatted("%.0f", most) + ", red is none</figcaption></figure>";
}

std::string uncertainty_map(const json& uncertainty) {
  const json &sigma = list_at(uncertainty, "sigma_px"), &theta = list_at(uncertainty, "theta_deg");
  const double largest = uncertainty.at("largest_sigma_px").get<double>();
  std::vector<std::vector<std::string>> fill;
  std::vector<std::string> rim;
  for (std::size_t r = 0; r + 1 < sigma.size(); ++r) {  // a cell has the larger of its edges
    fill.emplace_back();
    const json &inner = list(sigma.at(r)), &outer = sigma.at(r + 1);
    for (std::size_t s = 0; s < inner.size(); ++s)
      fill.back().push_back(
          shade(std::max(inner.at(s).get<double>(), outer.at(s).get<double>()) / std::max(largest, 1e-9)));
    rim.push_back((r + 1) % 6 == 0 ? formatted("%.0f°", theta.at(r + 1).get<double>()) : "");
  }
  return "<figure>" + polar_cells(300, fill, rim) +
         "<figcaption>uncertainty of projection: white is 0, dark is " + formatted("%.3f px", largest) +
         "</figcaption></figure>";
}

// The largest uncertainty up to an angle; straight lines between the map's rings.
double largest_sigma_px(const json& uncertainty, double to_deg) {
  const json &sigma = list_at(uncertainty, "sigma_px"), &theta = list_at(uncertainty, "theta_deg");
  double largest = 0;
  for (std::size_t r = 0; r < sigma.size(); ++r) {
    const std::size_t inner = r > 0 ? r - 1 : 0;
    const double here = theta.at(r).get<double>(), before = theta.at(inner).get<double>();
    if (before > to_deg) break;
    const double part = here > to_deg && here > before ? (to_deg - before) / (here - before) : 1;
    for (std::size_t s = 0; s < list(sigma.at(r)).size(); ++s) {
      const double from = sigma.at(inner).at(s).get<double>(), to = sigma.at(r).at(s).get<double>();
      largest = std::max(largest, from + part * (to - from));
    }
  }
  return largest;
}

// The largest angle that a ring with points reaches.
double covered_deg(const json& coverage, double max_deg) {
  double covered = 0;
  const json& points = list_at(coverage, "points");
  for (std::size_t r = 0; r < points.size(); ++r)
    for (const json& count : points.at(r))
      if (count.get<double>() > 0) covered = ring_end_deg(coverage, r, max_deg);
  return covered;
}

// What an import says of itself.
std::string import_sentence(const json& imported) {
  if (!has_number(imported, "rms_px") || !has_number(imported, "max_px")) return "";
  return " Imported from " + escaped(imported.value("format", std::string())) + " (" +
         escaped(imported.value("model", std::string())) + "); the conversion is off by " +
         formatted("%.3g px rms, ", imported.at("rms_px").get<double>()) +
         formatted("%.3g px at most.", imported.at("max_px").get<double>());
}

// The angle beyond which most directions have no points, before those without any begin; else the largest of all.
double well_covered_deg(const json& coverage, double max_deg) {
  const json& points = list_at(coverage, "points");
  std::size_t rings = points.size();
  const auto is_sparse = [&](const json& ring) {
    const auto none =
        std::count_if(ring.begin(), ring.end(), [](const json& n) { return n.get<double>() == 0; });
    return 2 * static_cast<std::size_t>(none) > ring.size();
  };
  while (rings > 0 && is_sparse(points.at(rings - 1))) --rings;
  return rings > 0 ? ring_end_deg(coverage, rings - 1, max_deg) : 0;
}

// How far off axis the lens is held by what was seen, as far as the file says.
struct Support {
  double deg = 0;
  bool ends = false;  // before the field does
};
Support support_of(const json& file, double max_deg) {
  constexpr double kShownDeg = 0.05;  // half of the last digit that is printed
  if (const auto stated = file.find("supported_theta_deg"); stated != file.end()) {
    const double deg = std::min(stated->get<double>(), max_deg);
    return {deg, deg < max_deg - kShownDeg};
  }
  if (!file.contains("coverage")) return {max_deg, false};
  const double covered = std::min(covered_deg(file.at("coverage"), max_deg), max_deg);
  return {covered, covered < max_deg - 1};
}

// "uncertain by 0.05 px": the projection, where the lens is held.
std::string uncertainty_words(const json& file, const Support& support) {
  if (!file.contains("projection_uncertainty")) return "";
  return ", projection uncertain by " +
         formatted("%.2f px", largest_sigma_px(file.at("projection_uncertainty"), support.deg)) +
         (support.ends ? formatted(" up to %.1f°", support.deg) : "");
}

std::string support_warning(const json& file, const Support& support, double max_deg) {
  if (!support.ends) return "";
  if (!file.contains("supported_theta_deg"))
    return "no points beyond " + formatted("%.0f°", support.deg) + ". ";
  return (file.contains("imported") ? "its image shows nothing beyond " : "no points beyond ") +
         formatted("%.1f°, ", support.deg) + "extrapolated " + formatted("to %.1f°", max_deg) +
         (file.contains("projection_uncertainty")
              ? formatted(", where projection is uncertain by %.2f px or more",
                          largest_sigma_px(file.at("projection_uncertainty"), max_deg))
              : "") +
         ". ";
}

// What makes the lens less sure than its numbers say.
std::string trust_warning(const json& file) {
  std::string out;
  if (file.contains("constrained"))
    out += "the points would have the projection stop growing at " +
           formatted("%.1f°", file.at("constrained").at("theta_deg").get<double>()) +
           ", where it is held; the uncertainty has that shift in it. ";
  const json views = list_or_none(file, "views");
  const auto repeats =
      std::count_if(views.begin(), views.end(), [](const json& view) { return view.contains("repeats"); });
  if (repeats > 0)
    out += std::to_string(repeats) + (repeats == 1 ? " view shows" : " views show") +
           " the board where another does, and count as new evidence. ";
  return out;
}

}  // namespace

ReportSection lens_section(const Lens& lens, const json& file) {
  ReportSection out;
  const double max_deg = lens.max_theta_rad * 180 / kPi;
  const Support support = support_of(file, max_deg);
  out.html = "<h2>Lens</h2><p>Kannala–Brandt to " + formatted("%.1f°", max_deg) + " off axis, " +
             (support.ends && file.contains("supported_theta_deg")
                  ? formatted("extrapolated beyond %.1f°, ", support.deg)
                  : "") +
             "focal " + formatted("%.2f", lens.focal.x()) + " / " + formatted("%.2f px", lens.focal.y()) +
             ", centre " + formatted("%.2f", lens.center.x()) + " / " + formatted("%.2f", lens.center.y()) +
             ".";
  if (has_number(file, "rms_px")) {
    out.html += " Residual " + formatted("%.3f px rms", file.at("rms_px").get<double>());
    const bool held_out = has_number(file, "held_out_rms_px");
    if (held_out)
      out.html +=
          ", " + formatted("%.3f px on views that were held out", file.at("held_out_rms_px").get<double>());
    out.html += ".";
    out.verdict = formatted("%.2f px", file.at(held_out ? "held_out_rms_px" : "rms_px").get<double>()) +
                  uncertainty_words(file, support);
  } else {
    out.warning = "the lens says nothing about its error. ";
  }
  if (file.contains("imported") && file.at("imported").is_object())
    out.html += import_sentence(file.at("imported"));
  out.html += "</p>";
  if (file.contains("coverage") || file.contains("projection_uncertainty")) {
    out.html += "<div class=\"row\">";
    if (file.contains("coverage")) out.html += coverage_map(file.at("coverage"), max_deg);
    if (file.contains("projection_uncertainty"))
      out.html += uncertainty_map(file.at("projection_uncertainty"));
    out.html += "</div>";
  }
  out.warning += trust_warning(file) + support_warning(file, support, max_deg);
  if (file.contains("coverage"))
    if (const double well = well_covered_deg(file.at("coverage"), max_deg); well < support.deg - 1)
      out.warning += "points in less than half of the directions beyond " + formatted("%.0f°", well) + ". ";
  if (file.contains("views"))
    out.html += residual_plots(lens, list_at(file, "views")) + view_table(file.at("views"));
  return out;
}

}  // namespace lightwell::calibration
