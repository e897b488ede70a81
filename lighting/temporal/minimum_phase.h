// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "lighting/result.h"

namespace lightwell {

// The filter of the same length and the same gain at every frequency that delays least: every zero outside the
// unit circle is mirrored into it (spectral factorisation; Oppenheim and Schafer, "Discrete-Time Signal
// Processing", section 5.6). Its phase is no longer linear: a step comes earlier and rings behind.
// taps: at least one, finite, not all 0; newest frame first in and out. The sign at DC is kept.
// fails (failed): where the zeros are not found well enough for the gains to agree to 1e-6 of the largest
Result<std::vector<double>> minimum_phase(std::span<const double> taps);

// Σ n · tap[n] / Σ tap[n]: by how many frames slow changes are late. taps: sum not 0
double delay_of_slow_changes(std::span<const double> taps);

}  // namespace lightwell
