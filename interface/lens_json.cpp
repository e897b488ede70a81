// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/lens_json.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace lightwell {
namespace {

// The number is that of the oldest reader that uses the file rightly: /2 has a zenith, which readers of /1 would pass by
// and turn all light wrong.
constexpr const char* kLensSchema = "lightwell.lens";
constexpr int kNewestSchema = 2;
constexpr double kDegreesPerRadian = 180 / kPi;

}  // namespace

nlohmann::json lens_to_json(const Lens& lens) {
  const bool tilted = lens.zenith != Vec3d::UnitZ();
  nlohmann::json out = {{"schema", std::string(kLensSchema) + (tilted ? "/2" : "/1")},
                        {"model", "kannala-brandt"},
                        {"image_size", lens.image_size},
                        {"focal", {lens.focal.x(), lens.focal.y()}},
                        {"center", {lens.center.x(), lens.center.y()}},
                        {"k", lens.k},
                        {"max_theta_deg", lens.max_theta_rad * kDegreesPerRadian}};
  // Files of cameras whose gravity is unknown stay as they were.
  if (tilted) out["zenith"] = {lens.zenith.x(), lens.zenith.y(), lens.zenith.z()};
  return out;
}

Lens lens_from_json(const JsonFields& fields) {
  fields.require_schema(kLensSchema, kNewestSchema);
  Lens lens;
  std::array<double, 2> size{};
  fields.numbers("image_size", size);
  for (std::size_t i = 0; i < 2; ++i) {
    if (size[i] != std::floor(size[i]) || size[i] < 1 || size[i] > 16384)
      fields.fail("image_size[" + std::to_string(i) + "]",
                  "= " + std::to_string(size[i]) + ": allowed a whole number from 1 to 16384");
    lens.image_size[i] = static_cast<int>(size[i]);
  }
  fields.numbers("focal", {lens.focal.data(), 2});
  fields.numbers("center", {lens.center.data(), 2});
  fields.numbers("k", lens.k);
  const double degrees = fields.number("max_theta_deg");
  if (!(degrees > 0 && degrees <= 180))
    fields.fail("max_theta_deg", "= " + std::to_string(degrees) + ": allowed above 0, at most 180");
  lens.max_theta_rad = std::min(degrees / kDegreesPerRadian, kPi);
  if (fields.has("zenith"))  // for a while files of /1 had it too
    fields.numbers("zenith", {lens.zenith.data(), 3}, -1, 1);
  return lens;
}

}  // namespace lightwell
