// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "bench/chart.h"
#include "bench/suite.h"

namespace lightwell::bench {

// Lamps located by two and by five probes within a metre that err by .2°: error and how often the claim of 95 % is right, of
// 1000 lamps at each distance, beside the middle of where the rays pass each other.
std::vector<Row> lamp_location_rows(const Options& options);
Chart lamp_location_chart(const std::vector<Row>& rows);

}  // namespace lightwell::bench
