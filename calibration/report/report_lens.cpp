// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "calibration/report/html_report.h"
#include "calibration/report/svg_plot.h"

namespace lightwell::calibration {
namespace {

using nlohmann::json;

bool is_number(const json& object, const char* key) {
  return object.contains(key) && object.at(key).is_number();
}

// The image's frame with an arrow for every point, so much longer than the error that the median is seen.
std::string arrows(const Lens& lens, const json& views) {
  std::vector<double> lengths;
  for (const json& view : views)
    for (const json& r : view.value("residuals_px", json::array()))
      lengths.push_back(std::hypot(r[2].get<double>(), r[3].get<double>()));
  if (lengths.empty()) return "";
  std::nth_element(lengths.begin(), lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2),
                   lengths.end());
  const double median = std::max(lengths[lengths.size() / 2], 1e-6);
  const int width = lens.image_size[0], height = lens.image_size[1];
  const double gain = 0.012 * std::max(width, height) / median;
  std::string out = "<p>Residuals of every point, " + formatted("%.0f", gain) +
                    " times enlarged, a colour each view.</p><svg viewBox=\"0 0 " + std::to_string(width) +
                    " " + std::to_string(height) + "\" width=\"620\" class=\"image\">";
  const double stroke = 0.0016 * std::max(width, height);
  int hue = 0;
  for (const json& view : views) {
    out += "<g stroke=\"hsl(" + std::to_string(hue) + " 70% 40%)\" stroke-width=\"" +
           formatted("%.2f", stroke) + "\"><title>" + escaped(view.value("name", std::string())) + "</title>";
    hue = (hue + 137) % 360;  // the golden angle: neighbours differ
    for (const json& r : view.value("residuals_px", json::array())) {
      const double x = r[0].get<double>(), y = r[1].get<double>(), dx = gain * r[2].get<double>(),
                   dy = gain * r[3].get<double>();
      out += "<path d=\"M" + formatted("%.1f ", x) + formatted("%.1f", y) + "l" +
             formatted("%.1f ", std::clamp(dx, -1e4, 1e4)) + formatted("%.1f", std::clamp(dy, -1e4, 1e4)) +
             "\"/>";
    }
    out += "</g>";
  }
  return out + "</svg>";
}

std::string view_table(const json& views) {
  std::string out = "<table><tr><th>view</th><th>points</th><th>rejected</th><th>rms, px</th><th></th></tr>";
  for (const json& view : views)
    out += "<tr><td>" + escaped(view.value("name", std::string())) + "</td><td>" +
           (is_number(view, "points") ? formatted("%.0f", view.at("points").get<double>()) : "") +
           "</td><td>" + std::to_string(view.value("rejected", json::array()).size()) + "</td><td>" +
           (is_number(view, "rms_px") ? formatted("%.3f", view.at("rms_px").get<double>()) : "–") +
           "</td><td>" + (view.value("used", true) ? "" : "not used: ") +
           escaped(view.value("reason", std::string())) + "</td></tr>";
  return out + "</table>";
}

std::string coverage_map(const json& coverage) {
  const json& points = coverage.at("points");
  double most = 1;
  for (const json& ring : points)
    for (const json& count : ring) most = std::max(most, count.get<double>());
  std::vector<std::vector<std::string>> fill;
  std::vector<std::string> rim;
  const double ring_deg = coverage.at("ring_deg").get<double>();
  for (std::size_t r = 0; r < points.size(); ++r) {
    fill.emplace_back();
    for (const json& count : points[r]) {
      const double n = count.get<double>();
      fill.back().push_back(n > 0 ? shade(0.15 + 0.85 * std::sqrt(n / most)) : "#f6c9c4");
    }
    rim.push_back((r + 1) % 3 == 0 ? formatted("%.0f°", ring_deg * static_cast<double>(r + 1)) : "");
  }
  return "<figure>" + polar_cells(300, fill, rim) + "<figcaption>points in a cell: dark is " +
         formatted("%.0f", most) + ", red is none</figcaption></figure>";
}

std::string uncertainty_map(const json& uncertainty) {
  const json &sigma = uncertainty.at("sigma_px"), &theta = uncertainty.at("theta_deg");
  const double largest = uncertainty.at("largest_sigma_px").get<double>();
  std::vector<std::vector<std::string>> fill;
  std::vector<std::string> rim;
  for (std::size_t r = 0; r + 1 < sigma.size(); ++r) {  // a cell has the larger of its edges
    fill.emplace_back();
    for (std::size_t s = 0; s < sigma[r].size(); ++s)
      fill.back().push_back(shade(std::max(sigma[r][s].get<double>(), sigma[r + 1][s].get<double>()) /
                                  std::max(largest, 1e-9)));
    rim.push_back((r + 1) % 6 == 0 ? formatted("%.0f°", theta[r + 1].get<double>()) : "");
  }
  return "<figure>" + polar_cells(300, fill, rim) +
         "<figcaption>uncertainty of projection: white is 0, dark is " + formatted("%.3f px", largest) +
         "</figcaption></figure>";
}

// The largest angle that a ring with points reaches.
double covered_deg(const json& coverage) {
  double covered = 0;
  const json& points = coverage.at("points");
  for (std::size_t r = 0; r < points.size(); ++r)
    for (const json& count : points[r])
      if (count.get<double>() > 0)
        covered = coverage.at("ring_deg").get<double>() * static_cast<double>(r + 1);
  return covered;
}

// What an import says of itself.
std::string import_sentence(const json& imported) {
  if (!is_number(imported, "rms_px") || !is_number(imported, "max_px")) return "";
  return " Imported from " + escaped(imported.value("format", std::string())) + " (" +
         escaped(imported.value("model", std::string())) + "); the conversion is off by " +
         formatted("%.3g px rms, ", imported.at("rms_px").get<double>()) +
         formatted("%.3g px at most.", imported.at("max_px").get<double>());
}

// The angle beyond which most directions have no points, before those without any begin; else the largest of all.
double well_covered_deg(const json& coverage) {
  const json& points = coverage.at("points");
  std::size_t rings = points.size();
  const auto is_sparse = [&](const json& ring) {
    const auto none =
        std::count_if(ring.begin(), ring.end(), [](const json& n) { return n.get<double>() == 0; });
    return 2 * static_cast<std::size_t>(none) > ring.size();
  };
  while (rings > 0 && is_sparse(points[rings - 1])) --rings;
  return coverage.at("ring_deg").get<double>() * static_cast<double>(rings);
}

}  // namespace

ReportSection lens_section(const Lens& lens, const json& file) {
  ReportSection out;
  const double max_deg = lens.max_theta_rad * 180 / kPi;
  out.html = "<h2>Lens</h2><p>Kannala–Brandt to " + formatted("%.1f°", max_deg) + " off axis, " +
             (is_number(file, "supported_theta_deg") && file.at("supported_theta_deg").get<double>() < max_deg
                  ? formatted("extrapolated beyond %.1f°, ", file.at("supported_theta_deg").get<double>())
                  : "") +
             "focal " + formatted("%.2f", lens.focal.x()) + " / " + formatted("%.2f px", lens.focal.y()) +
             ", centre " + formatted("%.2f", lens.center.x()) + " / " + formatted("%.2f", lens.center.y()) +
             ".";
  if (is_number(file, "rms_px")) {
    out.html += " Residual " + formatted("%.3f px rms", file.at("rms_px").get<double>());
    const bool held_out = is_number(file, "held_out_rms_px");
    if (held_out)
      out.html +=
          ", " + formatted("%.3f px on views that were held out", file.at("held_out_rms_px").get<double>());
    out.html += ".";
    out.verdict = formatted("%.2f px", file.at(held_out ? "held_out_rms_px" : "rms_px").get<double>());
  } else {
    out.warning = "the lens says nothing about its error. ";
  }
  if (file.contains("imported") && file.at("imported").is_object())
    out.html += import_sentence(file.at("imported"));
  out.html += "</p>";
  if (file.contains("coverage") || file.contains("projection_uncertainty")) {
    out.html += "<div class=\"row\">";
    if (file.contains("coverage")) out.html += coverage_map(file.at("coverage"));
    if (file.contains("projection_uncertainty"))
      out.html += uncertainty_map(file.at("projection_uncertainty"));
    out.html += "</div>";
  }
  if (file.contains("coverage"))
    if (const double covered = covered_deg(file.at("coverage")); covered < max_deg - 1)
      out.warning += "no points beyond " + formatted("%.0f°", covered) + ". ";
  if (file.contains("coverage"))
    if (const double covered = covered_deg(file.at("coverage")), well = well_covered_deg(file.at("coverage"));
        well < std::min(covered, max_deg) - 1)
      out.warning += "points in less than half of the directions beyond " + formatted("%.0f°", well) + ". ";
  if (file.contains("views")) out.html += arrows(lens, file.at("views")) + view_table(file.at("views"));
  return out;
}

}  // namespace lightwell::calibration
