// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "interface/calibration_io.h"
#include "lighting/calibration.h"
#include "lighting/result.h"
#include "lighting/vector.h"

namespace lightwell {

// Which axis of the board lies along each of the camera's (x right and y down in the image, z along the lens), as a
// rotation from the board's frame to the camera's. text: three of x, y, z with a sign, as "x,-z,y". usage: not three, one
// twice, or a mirror image.
Result<Eigen::Matrix3d> camera_from_board(const std::string& text);

// The calibration as circumstances want it: turned upright by gravity, with the fixed pattern that was measured nearest
// to the camera's temperature.
class CalibrationChoice {
 public:
  // flats: of a folder, may be empty. rotation: camera_from_board; empty: gravity is not used.
  CalibrationChoice(Calibration base, std::vector<FlatAtTemperature> flats,
                    std::optional<Eigen::Matrix3d> rotation);

  struct Circumstances {
    std::optional<Vec3d>
        up_board;  // of an accelerometer at rest, any unit; empty: it moves, or there is none
    std::optional<double> temperature_c;
  };
  // The calibration to use from now on; empty: what is in use stays. bad_input: a fixed pattern that cannot be read, or
  // gravity that stands the camera on its head; said once, and what is in use stays.
  Result<std::optional<Calibration>> consider(const Circumstances& now);
  [[nodiscard]] const Calibration& current() const { return current_; }
  // Of the calibration before any change.
  [[nodiscard]] const std::string& base_id() const { return base_id_; }
  // Angle between the lens and the zenith.
  [[nodiscard]] double tilt_deg() const;

  static constexpr double kTurnDeg = 0.5;  // less is an accelerometer's own error
  static constexpr double kRestDeg = 0.2;  // two readings in a row agree so well
  static constexpr double kNearerC = 1.0;  // another pattern must be nearer by so much

 private:
  [[nodiscard]] Result<bool> turn(const std::optional<Vec3d>& up_board);
  [[nodiscard]] Result<bool> pick_flat(const std::optional<double>& temperature_c);
  static Result<bool> once(const Error& error, bool& said);

  Calibration current_;
  std::vector<FlatAtTemperature> flats_;
  std::optional<std::size_t> flat_;  // in use; empty: the folder's own
  std::optional<Eigen::Matrix3d> rotation_;
  std::optional<Vec3d> last_zenith_;
  std::string base_id_;
  bool changed_ = false;  // since the last answer
  bool said_turn_ = false, said_flat_ = false;
};

}  // namespace lightwell
