// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "interface/timecode.h"
#include "lighting/lat_long_image.h"
#include "lighting/result.h"

namespace lightwell {

bool is_exr(std::string_view bytes);

// The first part of an EXR file as colours, its display window; dark where the data window does not reach.
// Scan lines or tiles (of a mip map the full resolution), any compression; half, float, or integers as their
// value. Channels: see interface/environment_io.h. bad_input: truncated or damaged, deep, subsampled, no
// colours, an envmap attribute that says cube, more than pixel_limit pixels. Memory grows with what the file
// holds, not with what its header claims. fails by std::bad_alloc where memory is short
// Colours of other chromaticities than Rec. 709's are converted (lighting/chromaticities.h), which may make some
// negative; converted says whether they were. Where R = G = B by its channels, the value stays.
Result<LatLongImage> read_exr(std::string_view bytes, const std::string& name_for_errors,
                              std::int64_t pixel_limit, bool* converted = nullptr);

// What an image is of: written as the envmap attribute.
enum class ExrContent { picture, lat_long_environment };

// A header's text attribute.
struct ExrText {
  std::string name, value;
};

// What a header says of a picture beside its colours.
struct ExrFacts {
  std::vector<ExrText> texts;
  std::optional<double> white_luminance_cd_m2;  // of (1, 1, 1)
  std::optional<Timecode> timecode;
  std::optional<double> exposure_s;
};

// The bytes of an EXR file: 32 bit float, ZIP, linear Rec. 709. Row 0 at the top.
// channels: one letter each, in the order of the samples, e.g. "RGBA"; pixels: [height][width][channel]
// failed: not enough memory, or a size EXR does not have
Result<std::string> exr_from_floats(int width, int height, std::string_view channels,
                                    std::span<const float> pixels, ExrContent content,
                                    const ExrFacts& facts = {});

// A text attribute of the first part; nothing where it has none of the name. bad_input: no EXR, or a damaged header.
Result<std::optional<std::string>> exr_text(std::string_view bytes, const std::string& attribute,
                                            const std::string& name_for_errors);

}  // namespace lightwell
