// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/decomposition/best/map_in_parts.h"

namespace lightwell {

void MapInParts::potentials(const PlacedLights& at, int first, int last, ChannelRows& to) const noexcept {
  at.potentials(atoms, atom_moments, first, last, to);
  if (bright.all().empty()) return;
  for (int i = first; i < last; ++i) {
    const Rgbd of_bright = bright.potential(at.direction(i));
    for (std::size_t c = 0; c < 3; ++c)
      to[c][static_cast<std::size_t>(i)] += of_bright[static_cast<Eigen::Index>(c)];
  }
}

MomentMatrix MapInParts::moments() const noexcept {
  MomentMatrix all = atom_moments;
  bright.add_moments(all);
  return all;
}

MomentVector MapInParts::luminance_moments() const noexcept {
  return moments() * Eigen::Vector3d(0.2126, 0.7152, 0.0722);
}

void to_luminance(const ChannelRows& rgb, std::vector<double>& out, int n) noexcept {
  for (std::size_t k = 0; k < static_cast<std::size_t>(n); ++k)
    out[k] = 0.2126 * rgb[0][k] + 0.7152 * rgb[1][k] + 0.0722 * rgb[2][k];
}

}  // namespace lightwell
