// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lighting/calibration.h"
#include "lighting/frame_format.h"
#include "lighting/result.h"

namespace lightwell::cli {

struct PictureSize {
  int width = 0, height = 0;
};

// A developed frame. Row 0 at the top (of polar: the zenith), RGBA, cd/m², premultiplied; alpha 0: not seen.
struct DevelopedPicture {
  int width = 0, height = 0;
  std::vector<float> rgba;
  std::string projection;
  double coverage = 0;  // measured part of the sphere
  std::uint32_t clipped_pixels = 0;
};

// Raw frames to pictures in one projection: latlong (the world, upright as the calibration's gravity has it), polar (rings
// equal in zenith angle, sectors in azimuth), fisheye (the lens's own picture, from bins as fine as its pixels).
class PictureDeveloper {
 public:
  // usage: the projection, or a size that it does not have; bad_input: calibration and format disagree.
  static Result<PictureDeveloper> create(const Calibration& calibration, const FrameFormat& format,
                                         const std::string& projection, std::optional<PictureSize> size);
  PictureDeveloper(PictureDeveloper&&) noexcept;
  PictureDeveloper& operator=(PictureDeveloper&&) noexcept;
  ~PictureDeveloper();

  // codes: format.bytes(); exposure_us: above 0. Valid until the next call.
  const DevelopedPicture& develop(std::span<const std::byte> codes, double exposure_us);

  struct Painter;

 private:
  explicit PictureDeveloper(std::unique_ptr<Painter> painter);
  std::unique_ptr<Painter> painter_;
};

}  // namespace lightwell::cli
