// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bench/suite.h"

namespace lightwell::bench {

// Fields of the simulated walk at 8³ to 64³: their ground against exact integrals, and how wide a spot's edge becomes.
std::vector<Row> stage_rows();

}  // namespace lightwell::bench
