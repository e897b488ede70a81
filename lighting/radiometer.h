// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "lighting/calibration.h"
#include "lighting/frame_format.h"
#include "lighting/polar_map.h"
#include "lighting/radiometer/isa.h"
#include "lighting/result.h"

namespace lightwell {

std::string_view name(Isa isa);
std::vector<Isa> available_isas();  // fastest first; scalar is always there

struct RadiometerOptions {
  PolarGrid grid;
  std::optional<Isa> isa;  // none: the fastest available
};

// Raw codes to a polar radiance map, at the speed of memory.
// Everything that depends on the camera is folded into tables once (create); develop reads a frame and writes a map.
// A pixel belongs to the bin its centre looks into, with its exact solid angle: nothing is lost between pixels. Bins
// agree with double within 5e-4 of their radiance before the toe is subtracted. A Bayer quad is one sample: red and
// blue stand for its whole solid angle, the greens for half each; a light smaller than a quad is measured in the
// colours it falls on, which is right on average over its positions and all that the sensor knows.
// source: Havran et al. 2005, section 5.1; docs/decisions/012-frame-kernel.md
class Radiometer {
 public:
  // Fails with bad_input where calibration and format disagree, naming the field. response.bits is the format's; in 16
  // bit formats also 10 to 15, the sensor's codes in the low bits. Codes above the clip code count as it.
  static Result<Radiometer> create(const Calibration& calibration, const FrameFormat& format,
                                   const RadiometerOptions& options);
  Radiometer(Radiometer&&) noexcept;
  Radiometer& operator=(Radiometer&&) noexcept;
  ~Radiometer();

  // A map of the right shape, with the camera's solid angles and coverage; develop overwrites radiance, peak,
  // clipped.
  [[nodiscard]] PolarMap make_map() const;

  // frame: format.bytes() of raw codes; exposure_us: of this frame; map: from make_map.
  // Clipped pixels count at the clip code's radiance. Allocates nothing, never fails, not reentrant (own
  // scratch).
  void develop(std::span<const std::byte> frame, double exposure_us, PolarMap& map) noexcept;

  [[nodiscard]] Isa isa() const;

 private:
  struct Plan;
  explicit Radiometer(std::unique_ptr<Plan> plan);
  std::unique_ptr<Plan> plan_;
};

}  // namespace lightwell
