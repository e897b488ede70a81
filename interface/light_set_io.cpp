// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/light_set_io.h"

#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <vector>

#include "interface/atomic_file.h"

namespace lightwell {
namespace {

constexpr const char* kSchema = "lightwell.lights/1";

// Floats all the way: the shortest decimals that read back as the same float.
using Json = nlohmann::basic_json<nlohmann::ordered_map, std::vector, std::string, bool, std::int64_t,
                                  std::uint64_t, float>;

template <class Vector>
Json triple(const Vector& v) {
  return Json::array({v[0], v[1], v[2]});
}

// What is wrong with a field, for one line of error.
struct Fault {
  std::string what;
};

[[noreturn]] void fault(const std::string& field, const std::string& what) {
  throw Fault{field + ": " + what};
}

const Json& member(const Json& object, const char* key, const std::string& path) {
  const auto at = object.find(key);
  if (at == object.end()) fault(path + key, "is missing");
  return *at;
}

float number(const Json& value, const std::string& field, float least) {
  if (!value.is_number()) fault(field, "is " + value.dump().substr(0, 40) + ", expected a number");
  const auto x = value.get<float>();
  if (!std::isfinite(x) || x < least)
    fault(field, "is " + value.dump() + ", allowed finite" + (least == 0 ? " and at least 0" : ""));
  return x;
}

Eigen::Array3f numbers(const Json& value, const std::string& field, float least) {
  if (!value.is_array() || value.size() != 3) fault(field, "expected an array of three numbers");
  Eigen::Array3f out;
  for (std::size_t i = 0; i < 3; ++i)
    out[static_cast<Eigen::Index>(i)] = number(value[i], field + "[" + std::to_string(i) + "]", least);
  return out;
}

std::int64_t integer(const Json& value, const std::string& field, std::int64_t least, std::int64_t most) {
  const bool huge =
      value.is_number_unsigned() && value.get<std::uint64_t>() > std::numeric_limits<std::int64_t>::max();
  if (!value.is_number_integer() || huge || value.get<std::int64_t>() < least ||
      value.get<std::int64_t>() > most)
    fault(field, "is " + value.dump().substr(0, 40) + ", allowed whole numbers " + std::to_string(least) +
                     " to " + std::to_string(most));
  return value.get<std::int64_t>();
}

DirectionalLight light_from_json(const Json& value, std::size_t index) {
  const std::string path = "lights[" + std::to_string(index) + "].";
  if (!value.is_object()) fault("lights[" + std::to_string(index) + "]", "expected an object");
  DirectionalLight light;
  const Vec3d direction =
      numbers(member(value, "direction", path), path + "direction", std::numeric_limits<float>::lowest())
          .matrix()
          .cast<double>();
  const double length = direction.norm();
  if (!(std::abs(length - 1) <= 1e-3))
    fault(path + "direction", "has length " + std::to_string(length) + ", allowed 1 within 0.001");
  light.direction = direction.cast<float>();
  // What we wrote is unit to rounding and must come back as it was.
  if (std::abs(length - 1) > 4e-7) light.direction = (direction / length).cast<float>();
  light.illuminance = numbers(member(value, "illuminance", path), path + "illuminance", 0);
  if (const auto parent = value.find("parent"); parent != value.end()) {
    const std::int64_t most = static_cast<std::int64_t>(index) - 1;
    light.parent = static_cast<std::int32_t>(integer(*parent, path + "parent", index == 0 ? -1 : 0, most));
  }
  if (const auto id = value.find("id"); id != value.end())
    light.id =
        static_cast<std::uint32_t>(integer(*id, path + "id", 0, std::numeric_limits<std::uint32_t>::max()));
  return light;
}

LightSet set_from_json(const Json& root) {
  if (!root.is_object()) fault("file", "expected a JSON object");
  const Json& schema = member(root, "schema", "");
  if (!schema.is_string() || schema.get<std::string>() != kSchema)
    fault("schema", "is " + schema.dump().substr(0, 60) + ", expected \"" + kSchema + "\"");
  LightSet set;
  if (const auto method = root.find("method"); method != root.end()) {
    if (!method->is_string()) fault("method", "expected text");
    set.method = method->get<std::string>();
  }
  const Json& coverage = member(root, "coverage", "");
  if (coverage != "hemisphere" && coverage != "sphere")
    fault("coverage", "is " + coverage.dump().substr(0, 60) + ", allowed \"hemisphere\", \"sphere\"");
  set.coverage = coverage == "sphere" ? Coverage::sphere : Coverage::hemisphere;
  const Json& lights = member(root, "lights", "");
  if (!lights.is_array()) fault("lights", "expected an array");
  std::size_t with_parent = 0;
  for (std::size_t i = 0; i < lights.size(); ++i) {
    set.lights.push_back(light_from_json(lights[i], i));
    with_parent += lights[i].contains("parent") ? 1 : 0;
  }
  set.has_parents = !lights.empty() && with_parent == lights.size();
  if (!set.has_parents)
    for (DirectionalLight& light : set.lights) light.parent = -1;
  set.total_illuminance = numbers(member(root, "total_illuminance", ""), "total_illuminance", 0);
  if (const auto ambient = root.find("ambient"); ambient != root.end())
    set.ambient = numbers(*ambient, "ambient", 0);
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
    text += separator + line + value.dump();
    separator = ",";
  }
  return text + line + "]}\n";
}

Result<LightSet> light_set_from_json(const std::string& text, const std::string& name_for_errors) {
  const auto bad = [&](const std::string& what) {
    return Error{ErrorKind::bad_input, name_for_errors + ": " + what};
  };
  try {
    return set_from_json(Json::parse(text));
  } catch (const Fault& error) {
    return bad(error.what);
  } catch (const Json::exception& error) {
    const std::string what = error.what();
    return bad("not valid JSON: " + what.substr(0, what.find('\n')).substr(0, 300));
  }
}

Result<LightSet> read_light_set(const std::filesystem::path& file) {
  const auto text = read_text_file(file);
  if (!text) return text.error();
  return light_set_from_json(*text, file.string());
}

Status write_light_set(const std::filesystem::path& file, const LightSet& set) {
  return write_file_atomically(file, light_set_to_json(set));
}

}  // namespace lightwell
