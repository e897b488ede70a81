// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "daemon/simulator/scene.h"

namespace lightwell::simulator {

// The stage that the walk goes over, as light at any place in its room: lamps near by, a window, and three projectors
// whose pictures lie sharp on the ground y = 0 (four coloured squares, a white circle, a red spot of which one half is
// blocked), as in the two scenes of Löw et al. 2009, figure 8. Metres; the ground is y = 0, the ceiling above it. Light
// is not interreflected: walls show what lamps and window throw on them, plus an even ambience.

// The part of the ground that the walk covers: |x|, |z| up to this.
inline constexpr double kWalkHalf_m = 0.8;

// Lamps and the lenses of projectors, as seen from a place inside the room. A lens is even over its disc, with the mean
// of what its parts throw on the place.
std::vector<DiscLight> stage_lights(const Vec3d& at);
// Walls, ceiling and window; direction: not downward.
Rgbd stage_wall_radiance(const Vec3d& at, const Vec3d& direction);
// No radiance of the stage lies above, cd/m².
inline constexpr double kStageBrightest_cd_m2 = 8e4;

}  // namespace lightwell::simulator
