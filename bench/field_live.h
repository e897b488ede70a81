// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bench/suite.h"

namespace lightwell::bench {

// A field of 16³ from ten probes at once: time of an update (ten maps and the field) and its error, beside the probes'
// own harmonics interpolated by place.
std::vector<Row> live_rows(const Options& options);

}  // namespace lightwell::bench
