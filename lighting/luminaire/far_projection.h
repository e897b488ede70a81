// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lighting/luminaire/luminaire.h"

namespace lightwell {

struct FarGrid {
  int planes = 180;  // C planes around the aim, at least 1
  int angles = 361;  // γ from 0 to 180°, at least 2
};

// What a lamp is from far away: of a near field all sources' intensity in each direction, 0 or more, at the grid's angles in
// system C, ending at γ = 90° where nothing shines backward; of a lamp without one its own table. Luminance (Rec. 709) of
// what is coloured.
FarField far_field_of(const Luminaire& lamp, const FarGrid& grid = {});

}  // namespace lightwell
