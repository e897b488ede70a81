// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

#include "lighting/field/world_picture.h"
#include "lighting/radiometer.h"
#include "lighting/result.h"

namespace lightwell {

// Raw frames of a probe as pictures of radiance in the world, latitude–longitude: response, flat
// field, lens and gravity as calibrated, by the same kernel as the daemon's frames. For one thread.
class FrameDeveloper {
 public:
  // height: of the pictures, 2 to 4096; they are twice as wide. bad_input where calibration and format disagree.
  static Result<FrameDeveloper> create(const Calibration& calibration, const FrameFormat& format,
                                       int height = 180);

  // The angle from its zenith to which the probe sees, in its own frame, radians.
  [[nodiscard]] double theta_max_rad() const { return theta_max_rad_; }

  // codes: format.bytes(); exposure_us: above 0. Pixels that are clipped count at the clip code's radiance.
  struct Developed {
    LatLongImage picture;  // NaN where nothing was seen
    std::uint32_t clipped_pixels = 0;
  };
  Developed develop(std::span<const std::byte> codes, double exposure_us,
                    const Eigen::Quaterniond& world_from_probe);

 private:
  FrameDeveloper(Radiometer radiometer, WorldPicture picture, double theta_max_rad)
      : radiometer_(std::move(radiometer)),
        map_(radiometer_.make_map()),
        picture_(std::move(picture)),
        theta_max_rad_(theta_max_rad) {}
  Radiometer radiometer_;
  PolarMap map_;
  WorldPicture picture_;
  double theta_max_rad_;
};

}  // namespace lightwell
