// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/frame_format.h"

#include <array>

namespace lightwell {
namespace {

struct Row {
  PixelFormat format;
  std::string_view name;
  int significant_bits;
  int storage_bits;
  bool bayer;
};

constexpr std::array<Row, 9> kFormats = {{
    {PixelFormat::mono8, "Mono8", 8, 8, false},
    {PixelFormat::mono10, "Mono10", 10, 16, false},
    {PixelFormat::mono12, "Mono12", 12, 16, false},
    {PixelFormat::mono12p, "Mono12p", 12, 12, false},
    {PixelFormat::mono16, "Mono16", 16, 16, false},
    {PixelFormat::bayer_rg8, "BayerRG8", 8, 8, true},
    {PixelFormat::bayer_rg10, "BayerRG10", 10, 16, true},
    {PixelFormat::bayer_rg12, "BayerRG12", 12, 16, true},
    {PixelFormat::bayer_rg16, "BayerRG16", 16, 16, true},
}};

const Row& row(PixelFormat format) {
  return kFormats[static_cast<std::size_t>(format)];
}

}  // namespace

std::string_view name(PixelFormat format) {
  return row(format).name;
}

std::optional<PixelFormat> pixel_format_from_name(std::string_view name) {
  for (const Row& r : kFormats)
    if (r.name == name) return r.format;
  return std::nullopt;
}

int significant_bits(PixelFormat format) {
  return row(format).significant_bits;
}
int storage_bits(PixelFormat format) {
  return row(format).storage_bits;
}
bool is_bayer(PixelFormat format) {
  return row(format).bayer;
}

}  // namespace lightwell
