// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/flat_field_json.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>

#include "interface/base64.h"

namespace lightwell {
namespace {

using nlohmann::json;

// The number is that of the oldest reader that uses the file rightly: /2 has gains, which readers of /1 would pass by.
constexpr const char* kFlatSchema = "lightwell.flat";
constexpr int kNewestSchema = 2;

// A value a pixel is stored as a 16 bit integer times a power of two: exact for what has been read back once, within
// 1/65536 of the largest value for what has not.
struct PackedValues {
  double scale = 1;
  std::vector<std::int16_t> values;
};

PackedValues pack(const std::vector<float>& pixels) {
  float largest = 0;
  for (const float o : pixels) largest = std::max(largest, std::abs(o));
  PackedValues packed;
  if (largest > 0) packed.scale = std::ldexp(1.0, std::ilogb(largest) - 14);  // largest / scale in [2¹⁴, 2¹⁵)
  // Rounding may reach 2¹⁵ itself, which does not fit.
  if (std::round(static_cast<double>(largest) / packed.scale) > 32767) packed.scale *= 2;
  packed.values.reserve(pixels.size());
  for (const float o : pixels)
    packed.values.push_back(static_cast<std::int16_t>(std::round(static_cast<double>(o) / packed.scale)));
  return packed;
}

float unpack(std::int16_t value, double scale) {
  return static_cast<float>(value * scale);
}

std::vector<float> values_from(const JsonFields& fields, std::size_t pixels) {
  if (fields.text("encoding") != "int16le-base64")
    fields.fail("encoding", "is unknown: allowed \"int16le-base64\"");
  const double scale = fields.number("scale");
  if (!(scale > 0 && scale <= 4))
    fields.fail("scale", "= " + std::to_string(scale) + ": allowed above 0, at most 4");
  const auto bytes = base64_decode(fields.text("data"));
  if (!bytes) fields.fail("data", "is not base64");
  if (bytes->size() != 2 * pixels)
    fields.fail("data", "holds " + std::to_string(bytes->size()) +
                            " bytes: allowed 2 a pixel of image_size, " + std::to_string(2 * pixels));
  std::vector<float> values(pixels);
  for (std::size_t i = 0; i < pixels; ++i) {
    const auto u = std::to_integer<std::uint16_t>((*bytes)[2 * i]) |
                   std::to_integer<std::uint16_t>((*bytes)[2 * i + 1]) << 8;
    values[i] = unpack(static_cast<std::int16_t>(u), scale);
  }
  return values;
}

json packed_json(const std::vector<float>& values) {
  const PackedValues packed = pack(values);
  std::vector<std::byte> bytes;
  bytes.reserve(packed.values.size() * 2);
  for (const std::int16_t v : packed.values) {
    const auto u = static_cast<std::uint16_t>(v);
    bytes.push_back(static_cast<std::byte>(u & 255));
    bytes.push_back(static_cast<std::byte>(u >> 8));
  }
  return {{"encoding", "int16le-base64"}, {"scale", packed.scale}, {"data", base64_encode(bytes)}};
}

}  // namespace

std::vector<float> as_stored(const std::vector<float>& values) {
  const PackedValues packed = pack(values);
  std::vector<float> out;
  out.reserve(packed.values.size());
  for (const std::int16_t v : packed.values) out.push_back(unpack(v, packed.scale));
  return out;
}

json flat_field_to_json(const FlatField& flat) {
  json out = {{"schema", std::string(kFlatSchema) + (flat.gain.empty() ? "/1" : "/2")},
              {"image_size", flat.image_size},
              {"vignetting", flat.vignetting}};
  if (!flat.offset_codes.empty()) out["offset_codes"] = packed_json(flat.offset_codes);
  if (!flat.gain.empty()) out["gain"] = packed_json(flat.gain);
  return out;
}

FlatField flat_field_from_json(const JsonFields& fields) {
  fields.require_schema(kFlatSchema, kNewestSchema);
  FlatField flat;
  std::array<double, 2> size{};
  fields.numbers("image_size", size);
  for (std::size_t i = 0; i < 2; ++i) {
    if (size[i] != std::floor(size[i]) || size[i] < 0 || size[i] > 16384)
      fields.fail("image_size[" + std::to_string(i) + "]",
                  "= " + std::to_string(size[i]) + ": allowed a whole number from 0 to 16384");
    flat.image_size[i] = static_cast<int>(size[i]);
  }
  fields.numbers("vignetting", flat.vignetting);
  const std::size_t pixels =
      static_cast<std::size_t>(flat.image_size[0]) * static_cast<std::size_t>(flat.image_size[1]);
  if (fields.has("offset_codes")) flat.offset_codes = values_from(fields.object("offset_codes"), pixels);
  if (fields.has("gain"))  // for a while files of /1 had it too
    flat.gain = values_from(fields.object("gain"), pixels);
  return flat;
}

}  // namespace lightwell
