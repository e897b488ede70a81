// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <optional>

#include "interface/rig_file.h"
#include "lighting/calibration.h"
#include "lighting/lat_long_image.h"

namespace lightwell::calibration {

// The camera that looks at a rig's screen: from what its pictures hold to the screen's illuminance.
class RigCamera {
 public:
  // Reads the rig's calibration folder: all of it where pictures are codes, its lens.json alone where they are light.
  static Result<RigCamera> create(const Rig& rig, const std::filesystem::path& folder);

  [[nodiscard]] const std::optional<Lens>& lens() const { return lens_; }
  // bad_input: of another size than the calibration or than pictures before it.
  Status expect_size(const LatLongImage& picture, const std::string& file);

  struct Pixel {
    Rgbd lux;  // of the screen; relative pictures as they are
    bool saturated = false;
  };
  // picture: of the size expected; its values as they are in the file. exposure_us: 0: the response's reference.
  [[nodiscard]] Pixel develop(const LatLongImage& picture, int x, int y, double exposure_us) const;

 private:
  [[nodiscard]] Pixel develop_codes(const Rgb& codes, int x, int y, double exposure_us) const;

  Rig::Unit unit_ = Rig::Unit::lux;
  double screen_reflectance_ = 1;
  std::optional<double> saturation_;
  std::optional<Calibration> calibration_;  // of codes
  std::optional<Lens> lens_;
  std::array<int, 2> size_ = {0, 0};
  std::vector<double> vignetting_;  // of codes, [height][width]
};

}  // namespace lightwell::calibration
