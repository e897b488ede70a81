// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/lens/correspondences.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>
#include <tuple>

#include "interface/atomic_file.h"
#include "interface/json_fields.h"

namespace lightwell::calibration {
namespace {

using nlohmann::json;

constexpr double kFarthestMm = 1e9;  // a thousand kilometres; squares of squares stay finite
// Far more than anybody photographs: above, a file is taken for a mistake, not solved for hours.
constexpr std::size_t kMostViews = 2000, kMostPoints = 100000;

// "= value: allowed from to to"
std::string outside(double value, double from, double to, const char* unit) {
  char text[160];
  std::snprintf(text, sizeof text, "= %g: allowed %g to %g %s", value, from, to, unit);
  return text;
}

const json& array_in(const JsonFields& fields, const json& object, const char* key, std::size_t most) {
  if (!object.contains(key)) fields.fail(key, "is missing");
  const json& value = object.at(key);
  if (!value.is_array()) fields.fail(key, "is not an array");
  if (value.size() > most)
    fields.fail(key, "has " + std::to_string(value.size()) + ": allowed at most " + std::to_string(most));
  return value;
}

Correspondence point_from(const JsonFields& view, const json& point, const std::string& key,
                          const std::array<int, 2>& image_size) {
  std::array<double, 5> v{};
  if (!point.is_array() || point.size() != v.size())
    view.fail(key, "is " + (point.is_array() ? "an array of " + std::to_string(point.size()) : point.dump()) +
                       ", expected [X, Y, Z, u, v]");
  for (std::size_t i = 0; i < v.size(); ++i) {
    if (!point[i].is_number() || !std::isfinite(point[i].get<double>()))
      view.fail(key + "[" + std::to_string(i) + "]", "= " + point[i].dump() + ": allowed a finite number");
    v[i] = point[i].get<double>();
  }
  for (std::size_t i = 0; i < 3; ++i)
    if (std::abs(v[i]) > kFarthestMm)
      view.fail(key + "[" + std::to_string(i) + "]", outside(v[i], -kFarthestMm, kFarthestMm, "mm"));
  for (std::size_t i = 0; i < 2; ++i)
    if (v[3 + i] < -image_size[i] || v[3 + i] > 2 * image_size[i])
      view.fail(key + "[" + std::to_string(3 + i) + "]", outside(v[3 + i], -image_size[i], 2 * image_size[i],
                                                                 "px, one image outside the image at most"));
  return {{v[0], v[1], v[2]}, {v[3], v[4]}};
}

TargetView view_from(const JsonFields& fields, const json& object, std::size_t index,
                     const std::array<int, 2>& image_size) {
  TargetView view;
  view.name = fields.has("name") ? fields.text("name") : "view " + std::to_string(index);
  std::set<std::tuple<double, double, double>> places;
  const json& points = array_in(fields, object, "points", kMostPoints);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::string key = "points[" + std::to_string(i) + "]";
    view.points.push_back(point_from(fields, points[i], key, image_size));
    const Vec3d& p = view.points.back().target_mm;
    if (!places.insert({p.x(), p.y(), p.z()}).second)
      fields.fail(key, "is at the same place of the target as a point before it");
  }
  return view;
}

bool same_points(const TargetView& a, const TargetView& b) {
  return !a.points.empty() &&
         std::ranges::equal(a.points, b.points, [](const Correspondence& p, const Correspondence& q) {
           return p.pixel == q.pixel && p.target_mm == q.target_mm;
         });
}

TargetViews views_from(const json& root, const std::string& file) {
  const JsonFields fields(root, file);
  TargetViews out;
  std::array<double, 2> size{};
  fields.numbers("image_size", size);
  for (std::size_t i = 0; i < 2; ++i) {
    if (size[i] != std::floor(size[i]) || size[i] < 1 || size[i] > 16384)
      fields.fail("image_size[" + std::to_string(i) + "]", outside(size[i], 1, 16384, "px, a whole number"));
    out.image_size[i] = static_cast<int>(size[i]);
  }
  const json& views = array_in(fields, root, "views", kMostViews);
  std::set<std::string> names;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const std::string key = "views[" + std::to_string(i) + "]";
    out.views.push_back(view_from(JsonFields(views[i], file, key), views[i], i, out.image_size));
    if (!names.insert(out.views.back().name).second)
      fields.fail(key + ".name", "= \"" + out.views.back().name + "\" is also the name of a view before it");
    // Counted twice, a view would make the lens look surer than it is.
    for (std::size_t k = 0; k < i; ++k)
      if (same_points(out.views[k], out.views[i]))
        fields.fail(key + ".points",
                    "are those of views[" + std::to_string(k) + "], \"" + out.views[k].name + "\", too");
  }
  return out;
}

}  // namespace

Result<TargetViews> read_target_views(const std::filesystem::path& file) {
  const auto text = read_text_file(file);
  if (!text) return text.error();
  const auto root = parse_json(*text, file.string());
  if (!root) return root.error();
  try {
    return views_from(*root, file.string());
  } catch (const FieldFailure& failure) {
    return failure.error;
  }
}

std::string to_json(const TargetViews& target_views) {
  json views = json::array();
  for (const TargetView& view : target_views.views) {
    json points = json::array();
    for (const Correspondence& p : view.points)
      points.push_back({p.target_mm.x(), p.target_mm.y(), p.target_mm.z(), p.pixel.x(), p.pixel.y()});
    views.push_back({{"name", view.name}, {"points", std::move(points)}});
  }
  return json{{"image_size", target_views.image_size}, {"views", std::move(views)}}.dump(
             -1, ' ', false, json::error_handler_t::replace) +
         "\n";
}

}  // namespace lightwell::calibration
