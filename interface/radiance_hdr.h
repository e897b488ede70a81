// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "lighting/lat_long_image.h"
#include "lighting/result.h"

namespace lightwell {

// Radiance HDR pictures (RGBE: three 8 bit mantissas over one exponent), flat or run-length encoded, old and
// new. Our own reader because it meets files from anywhere and must read them from memory: every
// byte is checked. source: Ward, "Real Pixels", Graphics Gems II, 1991; Radiance file formats, section
// "Picture File Format"
bool is_radiance_hdr(std::string_view bytes);

// Radiance before exposure: divided by the product of all EXPOSURE lines and, a channel, of all COLORCORR lines.
// bad_input: truncated, damaged, not RGBE, another orientation than -Y +X, more than pixel_limit pixels, an EXPOSURE
// or COLORCORR that is not above 0, PRIMARIES that are no colour space. Colours of other PRIMARIES than Rec. 709's are
// converted, as in read_exr; a file that names none is taken for Rec. 709, which today's files without the line are.
Result<LatLongImage> read_radiance_hdr(std::string_view bytes, const std::string& name_for_errors,
                                       std::int64_t pixel_limit, bool* converted = nullptr);

}  // namespace lightwell
