// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "lighting/lat_long_image.h"
#include "lighting/result.h"

namespace lightwell {

// What values that are NaN or ±∞ are read as: 0, or what they are, for who tells darkness from what was not seen.
enum class NotFinite { zero, kept };

struct EnvironmentImage {
  LatLongImage image;            // ≥ 0, and finite but for NotFinite::kept
  std::uint64_t not_finite = 0;  // values that were NaN or ±∞, read as 0 but for NotFinite::kept
  std::uint64_t negative = 0;    // values below 0, read as 0
  bool converted = false;        // from other primaries to Rec. 709: a colour outside of it is negative there
  // One line for a person: what was read as 0, that colours were converted, and that the size is not 2:1 as a whole sphere's is (a square or
  // cross-shaped picture is probably not latitude–longitude). Empty where there is nothing to say.
  [[nodiscard]] std::string remark(const std::filesystem::path& file) const;
};

// Latitude–longitude EXR (any storage, tiled or mip-mapped: full resolution) or Radiance HDR (RGBE, rows from the top).
// Colours in the primaries that an EXR's chromaticities attribute says, made Rec. 709, D65; a Radiance HDR's divided by
// its EXPOSURE and COLORCORR. Channels R, G, B, plain or of a layer, those that are absent dark; else Y (or a lone channel) as R = G = B.
// Any size from 1×1. bad_input: missing, a directory, unreadable, truncated, not an image, not latitude–longitude
// (an EXR whose envmap attribute says cube), no colour channels, chromaticities that are no colour space, over 2^28 pixels.
Result<EnvironmentImage> read_environment(const std::filesystem::path& file,
                                          NotFinite not_finite = NotFinite::zero);
// The same from a file's bytes; name_for_errors is the file.
Result<EnvironmentImage> environment_from_bytes(std::string_view bytes, const std::string& name_for_errors,
                                                NotFinite not_finite = NotFinite::zero);

// The bytes of an EXR file, as write_environment writes it.
Result<std::string> environment_to_exr(const LatLongImage& image);

// EXR, 32 bit float, `envmap` attribute latitude–longitude; written whole or not at all.
Status write_environment(const std::filesystem::path& file, const LatLongImage& image);

}  // namespace lightwell
