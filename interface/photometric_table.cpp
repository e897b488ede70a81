// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/photometric_table.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>

namespace lightwell {

std::optional<double> photometric_number(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return std::nullopt;
  std::string digits(text.substr(first, text.find_last_not_of(" \t\r") - first + 1));
  std::replace(digits.begin(), digits.end(), ',', '.');
  const char* begin = digits.data() + (digits.front() == '+' ? 1 : 0);
  const char* end = digits.data() + digits.size();
  double value = 0;
  const auto read = std::from_chars(begin, end, value);
  if (read.ec != std::errc() || read.ptr != end || !std::isfinite(value)) return std::nullopt;
  return value;
}

FarField unfold_planes(const FarField& file, const std::function<std::vector<double>(double)>& mirrors) {
  std::map<double, std::size_t> planes;  // angle → the file's plane
  const auto around = [](double c) { return std::fmod(c + 720, 360); };
  for (std::size_t i = 0; i < file.horizontal_deg.size(); ++i)
    planes.emplace(around(file.horizontal_deg[i]), i);
  for (std::size_t i = 0; i < file.horizontal_deg.size(); ++i)
    for (const double c : mirrors(file.horizontal_deg[i])) planes.emplace(around(c), i);
  FarField full;
  full.system = file.system;
  full.vertical_deg = file.vertical_deg;
  full.horizontal_deg.clear();
  for (const auto& [angle, plane] : planes) {
    full.horizontal_deg.push_back(angle);
    for (std::size_t v = 0; v < file.vertical_deg.size(); ++v) full.candela.push_back(file.at(plane, v));
  }
  return full;
}

void clear_negative(FarField& lamp, std::vector<std::string>& remarks) {
  std::size_t count = 0;
  for (double& candela : lamp.candela)
    if (candela < 0) {
      candela = 0;
      ++count;
    }
  if (count > 0) remarks.push_back(std::to_string(count) + " negative intensities count as 0");
}

}  // namespace lightwell
