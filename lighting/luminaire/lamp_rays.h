// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "lighting/luminaire/luminaire.h"

namespace lightwell {

// A ray of a lamp, in its frame: where it starts, where it goes, and its part of the flux.
struct LampRay {
  Vec3d origin_m = Vec3d::Zero();
  Vec3d direction = -Vec3d::UnitZ();  // unit
  double flux_lm = 0;
};

struct RayBinning {
  int positions = 8;  // a side, over where 99.9 % of the flux crosses the sampling plane
  int pixels = 64;    // a side of an image
};

// Shares every ray out among the four nearest positions and pixels: no flux is lost. The sampling plane lies at the
// origins' median height by flux. rays: at least one, flux above 0.
//
// What shines below the sampling plane becomes its near field, point sources whose images are hemispheres; the rest, seldom
// more than a trickle beside and behind it, its far field.
Luminaire bin_rays(std::span<const LampRay> rays, const RayBinning& options);

}  // namespace lightwell
