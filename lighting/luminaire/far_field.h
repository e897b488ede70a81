// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "lighting/vector.h"

namespace lightwell {

// How the angles of a goniophotometer are counted (CIE 121, LM-75). The lamp's frame: it is aimed along −Z, C0 lies along
// +X, C90 along +Y.
enum class PhotometricSystem {
  c,  // planes about the aim: plane C, 0 to 360°, and γ from the aim, 0 to 180°
  b,  // planes about the X axis: lateral angle in the plane, −90 to 90°, and the plane's tilt from the aim toward +Y
  a,  // planes about the Y axis: the plane's turn from the aim toward +X, and elevation in the plane, −90 to 90°
};

struct PhotometricAngles {
  double horizontal_deg = 0;  // C; lateral; the plane's turn
  double vertical_deg = 0;    // γ; the plane's tilt; elevation
};
PhotometricAngles photometric_angles(PhotometricSystem system,
                                     const Vec3d& direction);  // unit, from the lamp
Vec3d photometric_direction(PhotometricSystem system, const PhotometricAngles& angles);

// A lamp seen from far away: luminous intensity over direction, as files of photometric data have it.
struct FarField {
  PhotometricSystem system = PhotometricSystem::c;
  // Increasing. System C: from 0 to below 360, which closes the circle; a single one stands for all.
  std::vector<double> horizontal_deg = {0};
  std::vector<double> vertical_deg;  // increasing, at least two; beyond them the lamp is dark
  std::vector<double> candela;       // [horizontal][vertical], 0 or more

  [[nodiscard]] double& at(std::size_t horizontal, std::size_t vertical) {
    return candela[horizontal * vertical_deg.size() + vertical];
  }
  [[nodiscard]] double at(std::size_t horizontal, std::size_t vertical) const {
    return candela[horizontal * vertical_deg.size() + vertical];
  }
};

// By linear interpolation in both angles; exact at those of the table.
double intensity(const FarField& lamp, const PhotometricAngles& angles);
double intensity(const FarField& lamp, const Vec3d& direction);  // unit, from the lamp; cd

// ∫ I dω of intensity(), exactly, lm.
double luminous_flux(const FarField& lamp);

// Of a surface at a point of the lamp's frame, metres from its photometric centre; normal: unit. Lux; 0 behind the surface.
double illuminance(const FarField& lamp, const Vec3d& point, const Vec3d& normal);

}  // namespace lightwell
