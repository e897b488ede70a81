// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>

namespace lightwell {

// The board's photodiode against the camera: two instruments that see the same light and share no calibration. A dirty
// dome, an aperture that was moved, a filter that was left on show as a ratio that stays.
class PhotodiodeCheck {
 public:
  // Of the same plane and about the same time, lux. Darkness says nothing and is passed by.
  void add(double photodiode_lx, double camera_lx) noexcept;
  void reset() noexcept { count_ = 0; }

  struct Verdict {
    double photodiode_lx = 0, camera_lx = 0;  // the last ones
    double ratio = 1;                         // camera over photodiode, median of the last readings
    bool differs = false;  // and by more than light that changes, or another field of view, explains
  };
  // Empty before enough readings have come.
  [[nodiscard]] std::optional<Verdict> verdict() const noexcept;

  static constexpr std::size_t kReadings = 15, kEnough = 5;
  static constexpr double kDarkLx = 1;
  static constexpr double kMostRatio =
      1.3;  // a photodiode has 10 % of error in colour and cosine, and no fisheye's edge

 private:
  std::array<double, kReadings> ratios_{};
  std::size_t count_ = 0;
  double photodiode_lx_ = 0, camera_lx_ = 0;
};

}  // namespace lightwell
