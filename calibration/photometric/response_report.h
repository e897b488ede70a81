// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "calibration/photometric/recorded_patches.h"
#include "calibration/photometric/response_fit.h"

namespace lightwell::calibration {

// Another colour of a Bayer sensor, seen through the response of the first.
struct ChannelGain {
  std::string channel;
  double gain = 1;     // code = response(gain · luminance)
  double scatter = 0;  // relative standard deviation of the patches about it
};

struct ResponseReport {
  std::string source;                       // the file of the patches
  std::optional<RecordedPatches> recorded;  // where they were measured in a take
  std::string channel;                      // that was fitted; empty: there is one only
  ResponseFit fit;
  std::vector<ChannelGain> channels;
};

// Reads no more than the patches: fits the chosen channel (empty: green, else the first) and the gains of the others.
// bad_input as fit_response; usage where no patch has that channel.
Result<ResponseReport> calibrate_response(const PatchSet& patches, const std::string& channel,
                                          const ResponseFitOptions& options);

// Model, parameters with covariance, residuals, usable range, scores: for --json and as "fit" inside response.json.
nlohmann::ordered_json report_to_json(const ResponseReport& report);
// The text of response.json: the model, its table with the relative standard deviation of every code, the report. Where
// red, green and blue were measured on grey, the matrix that makes grey grey stands in it too.
std::string response_file(const ResponseReport& report);
// "bits = 12 is assumed, the fewest that hold every code: --bits states it", a line each.
std::vector<std::string> assumption_lines(const ResponseReport& report);
// A few lines for a person.
std::string summary(const ResponseReport& report);

}  // namespace lightwell::calibration
