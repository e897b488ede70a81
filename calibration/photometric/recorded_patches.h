// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "calibration/photometric/grey_chart.h"
#include "calibration/photometric/response_fit.h"

namespace lightwell::calibration {

// Patches of known luminance, measured in the frames of a take.
struct RecordedPatches {
  PatchSet set;                       // one of each patch, exposure and colour (R, G, B of a mosaic)
  std::vector<std::string> left_out;  // "patch 3 at 10000 us: clipped", where another exposure shows it
  std::string recording;
  std::uint64_t frames = 0;
  std::vector<double> exposures_us;
  std::vector<PatchRegion> regions;
};

struct RecordedPatchesOptions {
  std::filesystem::path recording;
  std::filesystem::path positions;  // or
  std::optional<GreyChart> chart;
  std::optional<Lens> lens;  // to find the chart
};

// luminances: CSV luminance_cd_m2, patch [, use]: a patch of the positions or the chart's number.
// A patch's code is the mean of its pixels' means over the frames, pixels far from the others (dust, dead ones) left out.
// Its standard deviation: of the mean over the frames (light that flickers), of the pixels' spread over as many as there
// are columns or rows, for fixed patterns go by columns, and of the rounding where noise is too small to hide it.
// fit: clipped is what it says, or else what fit_response will assume of this take.
// bad_input: files that cannot be read, a patch that is in none of them, outside the picture, of fewer than 16 pixels, or
// clipped in all exposures; see find_chart.
Result<RecordedPatches> measure_patches(const std::filesystem::path& luminances,
                                        const RecordedPatchesOptions& options, const ResponseFitOptions& fit);

nlohmann::ordered_json to_json(const RecordedPatches& patches);

}  // namespace lightwell::calibration
