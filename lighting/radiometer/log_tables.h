// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "lighting/radiometer/aligned.h"
#include "lighting/radiometer/kernel.h"
#include "lighting/radiometer/sample_weights.h"
#include "lighting/response.h"

namespace lightwell::radiometer {

// A logarithmic response folded into the kernels' integers (kernel.h).
struct LogTables {
  LogCurve curve;
  AlignedVector<std::uint16_t> attenuation;  // layout of SampleWeights
  // [groups]: decoded value × unit = exp((code − offset − a) / b) · weight, energy with the toe still in it
  std::vector<double> unit;
};

// Nothing where response and weights together reach beyond the 32 octaves of a 16 bit t, or the response is
// not logarithmic. Error of one pixel, relative, at most: half a step for the product's truncation, half for
// the attenuation's rounding, a quarter for the slope's (ln 2 / 2048 a step), and 1.6e-5 of the
// polynomial: 4.4e-4.
std::optional<LogTables> fold_log_response(const Response& response, const SampleWeights& weights);

}  // namespace lightwell::radiometer
