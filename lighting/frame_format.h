// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

namespace lightwell {

// GenICam (PFNC 2.1) names. 10 and 12 bit unpacked formats are little-endian 16 bit words, value in the low bits;
// the p formats are packed least significant bit first.
enum class PixelFormat {
  mono8,
  mono10,
  mono12,
  mono12p,
  mono16,
  bayer_rg8,
  bayer_rg10,
  bayer_rg12,
  bayer_rg16
};

std::string_view name(PixelFormat format);  // "Mono12p"
std::optional<PixelFormat> pixel_format_from_name(std::string_view name);
int significant_bits(PixelFormat format);  // 8, 10, 12, 16
int storage_bits(PixelFormat format);      // bits a pixel occupies: 8, 12 or 16
bool is_bayer(PixelFormat format);

// Rows follow each other without padding, as GigE Vision sends them.
struct FrameFormat {
  int width = 0;
  int height = 0;
  PixelFormat pixel_format = PixelFormat::mono12;

  [[nodiscard]] std::size_t bytes() const {
    return (static_cast<std::size_t>(width) * static_cast<std::size_t>(height) *
                static_cast<std::size_t>(storage_bits(pixel_format)) +
            7) /
           8;
  }
  friend bool operator==(const FrameFormat&, const FrameFormat&) = default;
};

}  // namespace lightwell
