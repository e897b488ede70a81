// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/light_set_io.h"

#include <cmath>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <span>
#include <sstream>

#include "interface/atomic_file.h"
#include "interface/json_fields.h"

namespace lightwell {
namespace {

constexpr const char* kSchema = "lightwell.lights/1";

// Of floats, for writing: the shortest decimals that read back as the same float.
using Json = nlohmann::basic_json<nlohmann::ordered_map, std::vector, std::string, bool, std::int64_t,
                                  std::uint64_t, float>;

template <class Vector>
Json triple(const Vector& v) {
  return Json::array({v[0], v[1], v[2]});
}

constexpr double kMostFloat = std::numeric_limits<float>::max();

Eigen::Array3d numbers(const JsonFields& fields, const char* key, double lowest) {
  Eigen::Array3d values;
  fields.numbers(key, std::span(values.data(), 3), lowest, kMostFloat);
  return values;
}

DirectionalLight light_from_json(const JsonFields& fields, std::size_t index) {
  DirectionalLight light;
  light.direction = numbers(fields, "direction", -kMostFloat).matrix().cast<float>();
  const Vec3d direction = light.direction.cast<double>();
  const double length = direction.norm();
  if (!(std::abs(length - 1) <= 1e-3))
    fields.fail("direction", "has length " + std::to_string(length) + ", allowed 1 within 0.001");
  // What we wrote is unit to rounding and must come back as it was.
  if (std::abs(length - 1) > 4e-7) light.direction = (direction / length).cast<float>();
  light.illuminance = numbers(fields, "illuminance", 0).cast<float>();
  if (fields.has("parent"))
    light.parent = static_cast<std::int32_t>(
        fields.whole("parent", index == 0 ? -1 : 0, static_cast<std::int64_t>(index) - 1));
  if (fields.has("id"))
    light.id = static_cast<std::uint32_t>(fields.whole("id", 0, std::numeric_limits<std::uint32_t>::max()));
  if (fields.has("predicted_error")) {
    const double error = fields.number("predicted_error");
    if (!(error >= 0 && error <= kMostFloat)) fields.fail("predicted_error", "is below 0 or no float");
    light.predicted_error = static_cast<float>(error);
  }
  if (fields.has("angular_radius_rad")) {
    const double radius = fields.number("angular_radius_rad");
    if (!(radius >= 0 && radius <= kPi)) fields.fail("angular_radius_rad", "is outside 0 to pi");
    light.angular_radius_rad = static_cast<float>(radius);
  }
  return light;
}

LightSet set_from_json(const JsonFields& root) {
  root.require_schema(kSchema);
  LightSet set;
  if (root.has("method")) set.method = root.text("method");
  const std::string coverage = root.text("coverage");
  if (coverage != "hemisphere" && coverage != "sphere")
    root.fail("coverage", "= \"" + coverage.substr(0, 60) + "\": allowed \"hemisphere\", \"sphere\"");
  set.coverage = coverage == "sphere" ? Coverage::sphere : Coverage::hemisphere;
  std::size_t with_parent = 0;
  for (const JsonFields& light : root.objects("lights")) {
    set.lights.push_back(light_from_json(light, set.lights.size()));
    with_parent += light.has("parent") ? 1 : 0;
  }
  set.has_parents = !set.lights.empty() && with_parent == set.lights.size();
  if (!set.has_parents)
    for (DirectionalLight& light : set.lights) light.parent = -1;
  set.total_illuminance = numbers(root, "total_illuminance", 0).cast<float>();
  if (root.has("ambient")) set.ambient = numbers(root, "ambient", 0).cast<float>();
  return set;
}

}  // namespace

std::string light_set_to_json(const LightSet& set, bool one_line) {
  Json head;
  head["schema"] = kSchema;
  head["method"] = set.method;
  head["coverage"] = set.coverage == Coverage::sphere ? "sphere" : "hemisphere";
  head["total_illuminance"] = triple(set.total_illuminance);
  head["ambient"] = triple(set.ambient);
  // One light a line: a file that a person can read and a diff can show.
  const std::string line = one_line ? "" : "\n";
  std::string text = head.dump();
  text.pop_back();
  text += "," + line + "\"lights\":[";
  const char* separator = "";
  for (const DirectionalLight& light : set.lights) {
    Json value;
    value["direction"] = triple(light.direction);
    value["illuminance"] = triple(light.illuminance);
    if (set.has_parents) value["parent"] = light.parent;
    if (light.id != 0) value["id"] = light.id;
    if (light.predicted_error > 0) value["predicted_error"] = light.predicted_error;
    if (light.angular_radius_rad > 0) value["angular_radius_rad"] = light.angular_radius_rad;
    text += separator + line + value.dump();
    separator = ",";
  }
  return text + line + "]}\n";
}

Result<LightSet> light_set_from_json(const std::string& text, const std::string& name_for_errors) {
  const auto json = parse_json(text, name_for_errors);
  if (!json) return json.error();
  try {
    return set_from_json(JsonFields(*json, name_for_errors));
  } catch (const FieldFailure& failure) {
    return failure.error;
  }
}

Result<LightSet> read_light_set(const std::filesystem::path& file) {
  const auto text = read_text_file(file);
  if (!text) return text.error();
  return light_set_from_json(*text, file.string());
}

Result<std::vector<LightSet>> read_light_sets(const std::filesystem::path& file) {
  const auto text = read_text_file(file);
  if (!text) return text.error();
  std::istringstream lines(*text);
  std::vector<LightSet> sets;
  std::size_t number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    auto set = light_set_from_json(line, file.string() + ", line " + std::to_string(number));
    if (!set) return set.error();
    sets.push_back(std::move(set).value());
  }
  if (sets.empty()) return Error{ErrorKind::bad_input, file.string() + ": holds no light set"};
  return sets;
}

Status write_light_set(const std::filesystem::path& file, const LightSet& set) {
  return write_file_atomically(file, light_set_to_json(set));
}

}  // namespace lightwell
