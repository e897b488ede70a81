// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

namespace lightwell {

// 1 − cos θ without cancellation near the zenith; the solid angle of the cap down to θ is 2π times it.
inline double cap_measure(double theta_rad) {
  const double s = std::sin(theta_rad / 2);
  return 2 * s * s;
}

}  // namespace lightwell
