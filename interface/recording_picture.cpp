// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/recording_picture.h"

#include <algorithm>
#include <cstdint>

namespace lightwell {
namespace {

// PFNC Mono12p: two pixels in three bytes, least significant bit first. An odd last pixel leaves four bits
// over.
bool unpack12(std::span<const std::byte> codes, std::span<std::byte> picture) {
  const std::size_t pixels = picture.size() / 2;
  const std::byte* in = codes.data();
  std::byte* out = picture.data();
  for (std::size_t i = 0; i + 2 <= pixels; i += 2, in += 3, out += 4) {
    out[0] = in[0];
    out[1] = in[1] & std::byte{0x0f};
    out[2] = (in[1] >> 4) | (in[2] << 4);
    out[3] = in[2] >> 4;
  }
  if (pixels % 2 == 0) return true;
  out[0] = in[0];
  out[1] = in[1] & std::byte{0x0f};
  return (in[1] & std::byte{0xf0}) == std::byte{0};
}

void pack12(std::span<const std::byte> picture, std::span<std::byte> codes) {
  const std::size_t pixels = picture.size() / 2;
  const std::byte* in = picture.data();
  std::byte* out = codes.data();
  for (std::size_t i = 0; i + 2 <= pixels; i += 2, in += 4, out += 3) {
    out[0] = in[0];
    out[1] = (in[1] & std::byte{0x0f}) | (in[2] << 4);
    out[2] = (in[2] >> 4) | (in[3] << 4);
  }
  if (pixels % 2 == 0) return;
  out[0] = in[0];
  out[1] = in[1] & std::byte{0x0f};
}

}  // namespace

std::size_t picture_bytes(const FrameFormat& format) {
  return static_cast<std::size_t>(format.width) * static_cast<std::size_t>(format.height) *
         picture_sample_bytes(format.pixel_format);
}

bool picture_from_codes(const FrameFormat& format, std::span<const std::byte> codes,
                        std::span<std::byte> picture) {
  if (format.pixel_format == PixelFormat::mono12p) return unpack12(codes, picture);
  const int bits = significant_bits(format.pixel_format);
  if (bits == 8 || bits == 16) {
    std::copy(codes.begin(), codes.end(), picture.begin());
    return true;
  }
  const auto high = static_cast<std::byte>(0xff << (bits - 8));
  std::byte excess{0};
  for (std::size_t i = 0; i + 2 <= codes.size(); i += 2) {
    excess |= codes[i + 1] & high;
    picture[i] = codes[i];
    picture[i + 1] = codes[i + 1] & ~high;
  }
  return excess == std::byte{0};
}

void codes_from_picture(const FrameFormat& format, std::span<const std::byte> picture,
                        std::span<std::byte> codes) {
  if (format.pixel_format == PixelFormat::mono12p) return pack12(picture, codes);
  std::copy(picture.begin(), picture.end(), codes.begin());
}

}  // namespace lightwell
