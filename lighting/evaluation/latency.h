// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "lighting/vector.h"

namespace lightwell {

// By how many frames one series follows another: the lag, −2 to 12 frames, at which their squared difference is
// least once each has its mean over the compared frames taken out; between frames by the parabola through the
// least and its neighbours. A ramp, a step or a slow swing gives the filter's delay; two equal series give 0.
// NaN where no lag can be told: fewer than 20 frames, a reference that stands still, series that are alike at no lag
// (the least difference is more than half of the reference's own variance), or most alike at either end of the range.
// follower, reference: of one length, a value a frame, finite
double lag_frames(std::span<const Vec3d> follower, std::span<const Vec3d> reference);

}  // namespace lightwell
