// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "calibration/lens/correspondences.h"

namespace lightwell::calibration {

// For each view an earlier one that shows the same points of the target at the same pixels within the noise: root mean
// square distance below 3 noise_px, where two pictures of one pose have 2. Adjusting counts them as two, though they say
// what one says; one that was read twice even claims noise that is not there.
// views: at least 9 in 10 of the points of the one with fewer are in both
std::vector<std::optional<std::size_t>> repeated_views(const std::vector<TargetView>& views, double noise_px);

}  // namespace lightwell::calibration
