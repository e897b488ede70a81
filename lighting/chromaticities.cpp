// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/chromaticities.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

namespace lightwell {
namespace {

// X, Y, Z up to scale, X + Y + Z = 1.
Eigen::Vector3d xyz_of(const Eigen::Vector2d& xy) {
  return {xy.x(), xy.y(), 1 - xy.x() - xy.y()};
}

// XYZ of a white of Y = 1.
Eigen::Vector3d white_of(const Chromaticities& space) {
  return xyz_of(space.white) / space.white.y();
}

// The columns are the primaries, scaled so that they add up to the white.
Eigen::Matrix3d xyz_from(const Chromaticities& space) {
  Eigen::Matrix3d primaries;
  primaries << xyz_of(space.red), xyz_of(space.green), xyz_of(space.blue);
  const Eigen::Vector3d amounts = primaries.partialPivLu().solve(white_of(space));
  return primaries * amounts.asDiagonal();
}

Eigen::Matrix3d bradford_adaptation(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  Eigen::Matrix3d cones;
  cones << 0.8951, 0.2664, -0.1614, -0.7502, 1.7135, 0.0367, 0.0389, -0.0685, 1.0296;
  const Eigen::Vector3d gain = (cones * to).cwiseQuotient(cones * from);
  return cones.inverse() * gain.asDiagonal() * cones;
}

}  // namespace

bool is_rec709(const Chromaticities& space) {
  const Chromaticities rec709;
  constexpr double kRounding = 5e-4;  // files write D65 as (0.3127, 0.3290) and as (0.313, 0.329)
  const auto near = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return (a - b).cwiseAbs().maxCoeff() <= kRounding;
  };
  return near(space.red, rec709.red) && near(space.green, rec709.green) && near(space.blue, rec709.blue) &&
         near(space.white, rec709.white);
}

std::optional<Eigen::Matrix3d> rec709_from(const Chromaticities& space) {
  const Chromaticities rec709;
  const Eigen::Matrix3d matrix =
      xyz_from(rec709).inverse() * bradford_adaptation(white_of(space), white_of(rec709)) * xyz_from(space);
  constexpr double kSmallest = 1e-6;  // of gamuts in use the determinant is near 1
  constexpr double kLargest = 1e6;
  if (!matrix.allFinite() || matrix.cwiseAbs().maxCoeff() > kLargest ||
      !(std::abs(matrix.determinant()) > kSmallest))
    return std::nullopt;
  return matrix;
}

void convert_colours(std::span<Rgb> pixels, const Eigen::Matrix3d& matrix) {
  constexpr double kLargest = std::numeric_limits<float>::max();
  for (Rgb& pixel : pixels) {
    const Rgb known = pixel.isFinite().select(pixel, Rgb::Zero());
    const Eigen::Vector3d colour = matrix * known.matrix().cast<double>();
    for (int c = 0; c < 3; ++c)
      if (std::isfinite(pixel[c])) pixel[c] = static_cast<float>(std::clamp(colour[c], -kLargest, kLargest));
  }
}

}  // namespace lightwell
