// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "interface/photometric_file.h"

// What readers of photometric files share.
namespace lightwell {

// A whole text as a number; blanks around it do not count, and a comma may stand for the point. Nothing else: nothing.
std::optional<double> photometric_number(std::string_view text);

// As many angles or planes as a file may have.
inline constexpr int kMostPhotometricAngles = 7200;

// Every plane of the full circle that symmetry makes of a file's planes. mirrors: what other planes show what plane C
// does. Planes that come to the same angle keep the first one's values.
FarField unfold_planes(const FarField& file, const std::function<std::vector<double>(double)>& mirrors);

// Negative intensities count as 0, which is remarked on.
void clear_negative(FarField& lamp, std::vector<std::string>& remarks);

}  // namespace lightwell
