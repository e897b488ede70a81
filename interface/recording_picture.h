// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

#include "lighting/frame_format.h"

namespace lightwell {

// The grey picture that a take shows to players and coders: 8 bit samples, or little-endian 16 bit words with
// the value in the low significant_bits. Bayer mosaics are stored as the mosaic.
constexpr std::size_t picture_sample_bytes(PixelFormat format) {
  return format == PixelFormat::mono8 || format == PixelFormat::bayer_rg8 ? 1 : 2;
}
std::size_t picture_bytes(const FrameFormat& format);

// codes: format.bytes(); picture: picture_bytes(). Values beyond significant_bits are cut off.
// Returns whether codes_from_picture gives the same codes back: false where a camera sets bits it should not.
bool picture_from_codes(const FrameFormat& format, std::span<const std::byte> codes,
                        std::span<std::byte> picture);
void codes_from_picture(const FrameFormat& format, std::span<const std::byte> picture,
                        std::span<std::byte> codes);

}  // namespace lightwell
