// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/luminaire/rig_camera.h"

#include <algorithm>
#include <string>

#include "interface/calibration_io.h"

namespace lightwell::calibration {
namespace {

std::string size_text(const std::array<int, 2>& size) {
  return std::to_string(size[0]) + "x" + std::to_string(size[1]);
}

}  // namespace

Result<RigCamera> RigCamera::create(const Rig& rig, const std::filesystem::path& folder) {
  RigCamera camera;
  camera.unit_ = rig.unit;
  camera.screen_reflectance_ = rig.screen_reflectance;
  camera.saturation_ = rig.saturation;
  if (rig.calibration.empty()) return camera;
  if (rig.unit == Rig::Unit::codes) {
    auto calibration = read_calibration(folder / rig.calibration);
    if (!calibration) return calibration.error();
    camera.lens_ = calibration->lens;
    camera.calibration_ = *std::move(calibration);
  } else {
    const auto lens = read_lens(folder / rig.calibration / "lens.json");
    if (!lens) return lens.error();
    camera.lens_ = *lens;
  }
  return camera;
}

Status RigCamera::expect_size(const LatLongImage& picture, const std::string& file) {
  const std::array<int, 2> size = {picture.width, picture.height};
  const auto other = [&](const std::array<int, 2>& wanted, const char* of) -> Status {
    return Error{ErrorKind::bad_input, file + ": size is " + size_text(size) +
                                           ", allowed: " + size_text(wanted) + ", that of " + of};
  };
  if (lens_ && size != lens_->image_size) return other(lens_->image_size, "lens.json");
  if (size_[0] > 0 && size != size_) return other(size_, "the first picture");
  if (size_[0] > 0) return {};
  size_ = size;
  if (!calibration_) return {};
  for (int y = 0; y < size[1]; ++y)
    for (int x = 0; x < size[0]; ++x)
      vignetting_.push_back(
          calibration_->flat.transmission(std::min(lens_->theta_rad(Vec2d(x, y)), lens_->max_theta_rad)));
  return {};
}

RigCamera::Pixel RigCamera::develop(const LatLongImage& picture, int x, int y, double exposure_us) const {
  const Rgb& value = picture.at(x, y);
  Pixel out = unit_ == Rig::Unit::codes ? develop_codes(value, x, y, exposure_us)
                                        : Pixel{value.cast<double>(), false};
  out.saturated = out.saturated || (saturation_ && static_cast<double>(value.maxCoeff()) >= *saturation_);
  // A Lambertian screen: E = π L / ρ.
  if (unit_ == Rig::Unit::codes || unit_ == Rig::Unit::luminance) out.lux *= kPi / screen_reflectance_;
  return out;
}

RigCamera::Pixel RigCamera::develop_codes(const Rgb& codes, int x, int y, double exposure_us) const {
  const Response& response = calibration_->response;
  const FlatField& flat = calibration_->flat;
  const std::size_t at =
      static_cast<std::size_t>(y) * static_cast<std::size_t>(size_[0]) + static_cast<std::size_t>(x);
  const double offset = flat.offset_codes.empty() ? 0.0 : static_cast<double>(flat.offset_codes[at]);
  const double gain = flat.gain.empty() ? 1.0 : static_cast<double>(flat.gain[at]);
  const double exposures = exposure_us > 0 ? response.reference_exposure_us / exposure_us : 1;
  Pixel out{Rgbd::Zero(), static_cast<double>(codes.maxCoeff()) >= response.clip_code};
  for (int c = 0; c < 3; ++c)
    out.lux[c] = response.luminance_cd_m2(static_cast<double>(codes[c]) - offset) * exposures /
                 (gain * vignetting_[at]);
  out.lux = (calibration_->rec709_from_camera * out.lux.matrix()).array();
  return out;
}

}  // namespace lightwell::calibration
