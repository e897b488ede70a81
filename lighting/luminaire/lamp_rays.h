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
  int positions =
      8;  // a side, over where 99.9 % of the flux crosses the sampling plane; of a long lamp as many in all
  int pixels = 0;  // a side of an image; 0: pixels_for()
};

// So many pixels a side that in each, over all positions, 150 rays are looked for: their noise, 8 % of a pixel, drowns in
// neighbouring pixels' light. 16 to 128.
int pixels_for(std::size_t rays);

// Shares every ray out among the four nearest positions and pixels: no flux is lost. The sampling plane lies at the
// origins' median height by flux. rays: at least one, flux above 0.
//
// Positions stand on the finest square grid of no more than positions² that spans the lamp's longer side: 8 x 8 of a square,
// 64 x 1 of a tube. What is no wider than about a spacing is one row at the mean of its light.
//
// What shines below the sampling plane becomes its near field, point sources whose images are hemispheres; the rest, seldom
// more than a trickle beside and behind it, its far field.
Luminaire bin_rays(std::span<const LampRay> rays, const RayBinning& options);

// From here on planes in the light of an evenly bright lamp err by no more than 3 %, relative RMS: two spacings. Nearer,
// the lamp's edges, or a row's width, are too coarse.
double nearest_m(const LampPlanes& planes);

}  // namespace lightwell
