// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/luminaire_file.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "interface/atomic_file.h"
#include "interface/exr_file.h"
#include "interface/json_fields.h"

namespace lightwell {
namespace {

using Json = nlohmann::ordered_json;
constexpr const char* kAttribute = "lightwell_luminaire";
constexpr const char* kSchema = "lightwell.luminaire/1";
constexpr std::int64_t kMostPixels = std::int64_t{1} << 28;
constexpr int kMostSide = 1 << 14;  // positions, or pixels of an image

const char* name_of(PhotometricSystem system) {
  return system == PhotometricSystem::c ? "C" : system == PhotometricSystem::b ? "B" : "A";
}

Json json_of(const LampPlanes& p) {
  return {{"map", p.map == LampMap::plane ? "plane" : "hemisphere"},
          {"positions", p.positions},
          {"spacing_m", p.spacing_m},
          {"first_m", {p.first_m.x(), p.first_m.y()}},
          {"z_m", p.z_m},
          {"distance_m", p.distance_m},
          {"pixels", p.pixels},
          {"low_m", {p.low_m.x(), p.low_m.y()}},
          {"high_m", {p.high_m.x(), p.high_m.y()}}};
}

Json json_of(const FarField& far) {
  return {{"system", name_of(far.system)},
          {"horizontal_deg", far.horizontal_deg},
          {"vertical_deg", far.vertical_deg},
          {"candela", far.candela}};
}

// Row by row of the whole picture: images side by side.
LatLongImage sheet_of(const LampImages& images) {
  const LampPlanes& p = images.planes;
  LatLongImage sheet{p.positions[0] * p.pixels[0], p.positions[1] * p.pixels[1], {}};
  sheet.pixels.resize(images.values.size());
  for (int v = 0; v < p.positions[1]; ++v)
    for (int u = 0; u < p.positions[0]; ++u) {
      const Rgb* pixel = images.image(u, v);
      for (int t = 0; t < p.pixels[1]; ++t)
        for (int s = 0; s < p.pixels[0]; ++s) sheet.at(u * p.pixels[0] + s, v * p.pixels[1] + t) = *pixel++;
    }
  return sheet;
}
void images_from(const LatLongImage& sheet, LampImages& images) {
  const LampPlanes& p = images.planes;
  images.values.resize(sheet.pixels.size());
  for (int v = 0; v < p.positions[1]; ++v)
    for (int u = 0; u < p.positions[0]; ++u) {
      Rgb* pixel = images.image(u, v);
      for (int t = 0; t < p.pixels[1]; ++t)
        for (int s = 0; s < p.pixels[0]; ++s) *pixel++ = sheet.at(u * p.pixels[0] + s, v * p.pixels[1] + t);
    }
}
LatLongImage sheet_of(const FarField& far) {
  LatLongImage sheet{
      static_cast<int>(far.vertical_deg.size()), static_cast<int>(far.horizontal_deg.size()), {}};
  for (const double candela : far.candela)
    sheet.pixels.emplace_back(Rgb::Constant(static_cast<float>(candela)));
  return sheet;
}

Vec2d pair_of(const JsonFields& fields, const char* key) {
  Vec2d pair;
  fields.numbers(key, {pair.data(), 2});
  return pair;
}
std::array<int, 2> whole_pair_of(const JsonFields& fields, const char* key) {
  std::array<double, 2> pair{};
  fields.numbers(key, pair, 1, kMostSide);
  for (const double v : pair)
    if (v != std::floor(v)) fields.fail(key, "is not whole");
  return {static_cast<int>(pair[0]), static_cast<int>(pair[1])};
}

LampPlanes planes_from(const JsonFields& fields) {
  LampPlanes p;
  const std::string map = fields.text("map");
  if (map != "plane" && map != "hemisphere") fields.fail("map", "is " + map + ", allowed: plane, hemisphere");
  p.map = map == "plane" ? LampMap::plane : LampMap::hemisphere;
  p.positions = whole_pair_of(fields, "positions");
  p.spacing_m = fields.number("spacing_m");
  p.first_m = pair_of(fields, "first_m");
  p.z_m = fields.number("z_m");
  p.distance_m = fields.number("distance_m");
  p.pixels = whole_pair_of(fields, "pixels");
  p.low_m = pair_of(fields, "low_m");
  p.high_m = pair_of(fields, "high_m");
  if (!(p.spacing_m > 0)) fields.fail("spacing_m", "is not above 0");
  if (!(p.distance_m > 0)) fields.fail("distance_m", "is not above 0");
  if (!(p.high_m.array() > p.low_m.array()).all()) fields.fail("high_m", "is not above low_m");
  return p;
}

// What a far field's angles must be: lighting/luminaire/far_field.h.
struct AngleRange {
  std::size_t least_count;
  double lowest_deg, highest_deg;
  bool with_highest = true;
};
AngleRange horizontal_range(PhotometricSystem system) {
  switch (system) {
    case PhotometricSystem::b:
      return {1, -90, 90};
    case PhotometricSystem::a:
      return {1, -180, 180};
    case PhotometricSystem::c:
      break;
  }
  return {1, 0, 360, false};
}
AngleRange vertical_range(PhotometricSystem system) {
  switch (system) {
    case PhotometricSystem::b:
      return {2, -180, 180};
    case PhotometricSystem::a:
      return {2, -90, 90};
    case PhotometricSystem::c:
      break;
  }
  return {2, 0, 180};
}

std::vector<double> angles_of(const JsonFields& fields, const char* key, const AngleRange& range) {
  std::vector<double> angles = fields.number_list(key);
  if (angles.size() < range.least_count)
    fields.fail(key, "= an array of " + std::to_string(angles.size()) + ": allowed at least " +
                         std::to_string(range.least_count) + " angles");
  for (std::size_t i = 0; i < angles.size(); ++i) {
    const double angle = angles[i];
    const auto fail = [&](const std::string& what) {
      char number[40];
      std::snprintf(number, sizeof number, "= %.9g", angle);
      fields.fail(std::string(key) + "[" + std::to_string(i) + "]", number + what);
    };
    if (angle < range.lowest_deg || angle > range.highest_deg ||
        (angle == range.highest_deg && !range.with_highest)) {
      char allowed[60];
      std::snprintf(allowed, sizeof allowed, ": allowed %g to %s%g", range.lowest_deg,
                    range.with_highest ? "" : "below ", range.highest_deg);
      fail(allowed);
    }
    if (i > 0 && !(angle > angles[i - 1])) fail(" does not increase: allowed increasing angles");
  }
  return angles;
}

FarField far_from(const JsonFields& fields) {
  FarField far;
  const std::string system = fields.text("system");
  if (system != "A" && system != "B" && system != "C")
    fields.fail("system", "is " + system + ", allowed: A, B, C");
  far.system = system == "C"   ? PhotometricSystem::c
               : system == "B" ? PhotometricSystem::b
                               : PhotometricSystem::a;
  far.horizontal_deg = angles_of(fields, "horizontal_deg", horizontal_range(far.system));
  far.vertical_deg = angles_of(fields, "vertical_deg", vertical_range(far.system));
  far.candela.resize(far.horizontal_deg.size() * far.vertical_deg.size());
  constexpr double kMostCandela = 1e30;
  fields.numbers("candela", far.candela, 0, kMostCandela);
  return far;
}

NearField near_from(const JsonFields& fields, std::string_view bytes) {
  NearField near;
  LampPlanes& planes = near.intensity.planes;
  planes = planes_from(fields);
  const auto sheet = read_exr(bytes, fields.file(), kMostPixels);
  if (!sheet) throw FieldFailure{sheet.error()};
  const std::int64_t width = std::int64_t{planes.positions[0]} * planes.pixels[0];
  const std::int64_t height = std::int64_t{planes.positions[1]} * planes.pixels[1];
  if (sheet->width != width || sheet->height != height)
    fields.fail("pixels", "ask for a picture of " + std::to_string(width) + "x" + std::to_string(height) +
                              ", it is " + std::to_string(sheet->width) + "x" +
                              std::to_string(sheet->height));
  if (!std::all_of(sheet->pixels.begin(), sheet->pixels.end(),
                   [](const Rgb& p) { return p.isFinite().all(); }))
    fields.fail("pixels", "hold one that is no number");
  images_from(*sheet, near.intensity);
  return near;
}

Luminaire luminaire_from(const nlohmann::json& json, const std::string& name, std::string_view bytes) {
  const JsonFields fields(json, name);
  fields.require_schema(kSchema);
  Luminaire lamp;
  lamp.name = fields.text("name");
  if (fields.has("far")) lamp.far = far_from(fields.object("far"));
  if (fields.has("near")) lamp.near = near_from(fields.object("near"), bytes);
  if (!lamp.near && !lamp.far) fields.fail("far", "is missing, and near too");
  return lamp;
}

}  // namespace

Status write_luminaire(const std::filesystem::path& file, const Luminaire& lamp) {
  verify_bug(lamp.near.has_value() || lamp.far.has_value(), "a lamp without light");
  Json json = {{"schema", kSchema}, {"name", lamp.name}};
  if (lamp.near) json["near"] = json_of(lamp.near->intensity.planes);
  if (lamp.far) json["far"] = json_of(*lamp.far);
  const LatLongImage sheet = lamp.near ? sheet_of(lamp.near->intensity) : sheet_of(*lamp.far);
  ExrFacts facts;
  facts.texts = {{kAttribute, json.dump(-1, ' ', false, Json::error_handler_t::replace)}};
  const auto bytes =
      exr_from_floats(sheet.width, sheet.height, "RGB",
                      {reinterpret_cast<const float*>(sheet.pixels.data()), sheet.pixels.size() * 3},
                      ExrContent::picture, facts);
  if (!bytes) return Error{bytes.error().kind, file.string() + ": " + bytes.error().message};
  return write_file_atomically(file, *bytes);
}

Result<Luminaire> read_luminaire(const std::filesystem::path& file) {
  const std::string name = file.string();
  const auto bytes = read_text_file(file, std::size_t{4} << 30);
  if (!bytes) return bytes.error();
  const auto text = exr_text(*bytes, kAttribute, name);
  if (!text) return text.error();
  if (!*text)
    return Error{ErrorKind::bad_input,
                 name + ": has no attribute " + kAttribute + ": not a lamp of lightwell luminaire"};
  const auto json = nlohmann::json::parse(**text, nullptr, false);
  if (json.is_discarded() || !json.is_object())
    return Error{ErrorKind::bad_input, name + ": attribute " + kAttribute + " is no JSON object"};
  try {
    return luminaire_from(json, name, *bytes);
  } catch (const FieldFailure& failure) {
    return failure.error;
  }
}

}  // namespace lightwell
