// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <fstream>
#include <nlohmann/json.hpp>

#include "bench/suite.h"
#include "bench/xml_text.h"

namespace lightwell::bench {
namespace {

std::string cpu_model() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);)
    if (line.starts_with("model name") || line.starts_with("Model"))
      if (const auto colon = line.find(": "); colon != std::string::npos) return line.substr(colon + 2);
  return "unknown";
}

std::string utc_now() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  gmtime_r(&now, &parts);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &parts);
  return text;
}

std::string number(double v) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", v);
  return text;
}

// A line's width in the plot's sans-serif face of 12 px, from above.
int text_width(const std::string& text) {
  return static_cast<int>(6.7 * static_cast<double>(text.size()));
}

std::string label_of(const Row& row) {
  std::string label = number(row.timing.p50_ms) + " ms";
  for (const auto& [key, value] : row.values) label += ", " + key + " " + number(value);
  return label;
}

}  // namespace

std::string to_json(const std::vector<std::pair<std::string, std::vector<Row>>>& results) {
  nlohmann::ordered_json json;
  json["schema"] = "lightwell.bench/1";
  json["date_utc"] = utc_now();
  json["cpu"] = cpu_model();
  json["compiler"] = LIGHTWELL_BENCH_COMPILER;
  json["flags"] = LIGHTWELL_BENCH_FLAGS;
  json["commit"] = LIGHTWELL_BENCH_COMMIT;
  for (const auto& [suite, rows] : results)
    for (const Row& row : rows) {
      nlohmann::ordered_json entry = {{"suite", suite},
                                      {"setting", row.setting},
                                      {"name", row.name},
                                      {"p10_ms", row.timing.p10_ms},
                                      {"p50_ms", row.timing.p50_ms},
                                      {"p99_ms", row.timing.p99_ms},
                                      {"runs", row.timing.runs}};
      for (const auto& [key, value] : row.values) entry[key] = value;
      json["rows"].push_back(std::move(entry));
    }
  return json.dump(2) + "\n";
}

std::string to_svg(const std::string& suite, const std::vector<Row>& rows) {
  constexpr int kLine = 18;
  constexpr int kBar = 300;
  int left = 60, right = 0;
  for (const Row& row : rows) {
    left = std::max(left, text_width(row.name) + 16);
    right = std::max(right, text_width(label_of(row)) + 14);
  }
  std::string body;
  int y = 34;
  std::string setting;
  double longest = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Row& row = rows[i];
    if (row.setting != setting) {  // each setting has a scale of its own
      setting = row.setting;
      longest = 0;
      for (const Row& other : rows)
        if (other.setting == setting) longest = std::max(longest, other.timing.p50_ms);
      y += 10;
      body +=
          "<text x='8' y='" + std::to_string(y) + "' font-weight='bold'>" + escaped(setting) + "</text>\n";
      y += kLine;
    }
    const double width = longest > 0 ? kBar * row.timing.p50_ms / longest : 0;
    body += "<text x='" + std::to_string(left - 8) + "' y='" + std::to_string(y) + "' text-anchor='end'>" +
            escaped(row.name) + "</text><rect x='" + std::to_string(left) + "' y='" + std::to_string(y - 11) +
            "' width='" + number(width) + "' height='13' fill='#4a7ab5'/><text x='" +
            number(left + width + 6) + "' y='" + std::to_string(y) + "' fill='#444'>" +
            escaped(label_of(row)) + "</text>\n";
    y += kLine;
  }
  return "<svg xmlns='http://www.w3.org/2000/svg' width='" + std::to_string(left + kBar + right) +
         "' height='" + std::to_string(y + 10) +
         "' font-family='sans-serif' font-size='12'>\n<rect width='100%' height='100%' fill='white'/>\n" +
         "<text x='8' y='20' font-size='15'>lightwell bench: " + escaped(suite) + ", median, " +
         escaped(cpu_model()) + "</text>\n" + body + "</svg>\n";
}

std::string to_text(const std::string& suite, const std::vector<Row>& rows) {
  std::string out = suite + "\n";
  for (const Row& row : rows) {
    out += fmt::format("  {:<12} {:<28} p50 {:9.4f}", row.setting, row.name, row.timing.p50_ms);
    if (std::isfinite(row.timing.p10_ms)) out += fmt::format("  p10 {:9.4f}", row.timing.p10_ms);
    out += fmt::format("  p99 {:9.4f} ms", row.timing.p99_ms);
    for (const auto& [key, value] : row.values) out += "  " + key + " " + number(value);
    out += "\n";
  }
  return out;
}

}  // namespace lightwell::bench
