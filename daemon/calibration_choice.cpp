// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/calibration_choice.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "lighting/orientation.h"

namespace lightwell {
namespace {

double angle_deg(const Vec3d& a, const Vec3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / kPi;
}

}  // namespace

Result<Eigen::Matrix3d> camera_from_board(const std::string& text) {
  const Error refused{ErrorKind::usage, "board.axes = \"" + text +
                                            "\"; allowed: the board's axes along the camera's x, y and z, as "
                                            "\"x,-z,y\", each once and no mirror image"};
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Zero();
  std::istringstream parts(text);
  std::string part;
  Eigen::Index row = 0;
  for (; std::getline(parts, part, ','); ++row) {
    part.erase(std::remove(part.begin(), part.end(), ' '), part.end());
    const bool negative = !part.empty() && part[0] == '-';
    if (!part.empty() && (part[0] == '-' || part[0] == '+')) part.erase(0, 1);
    if (row == 3 || part.size() != 1 || part[0] < 'x' || part[0] > 'z') return refused;
    rotation(row, part[0] - 'x') = negative ? -1 : 1;
  }
  if (row != 3 || text.back() == ',' || std::abs(rotation.determinant() - 1) > 0.5) return refused;
  return rotation;
}

CalibrationChoice::CalibrationChoice(Calibration base, std::vector<FlatAtTemperature> flats,
                                     std::optional<Eigen::Matrix3d> rotation)
    : current_(std::move(base)),
      flats_(std::move(flats)),
      rotation_(std::move(rotation)),
      base_id_(current_.id) {}

double CalibrationChoice::tilt_deg() const {
  return angle_deg(current_.lens.zenith, Vec3d::UnitZ());
}

// What is wrong stays wrong for a while: it is said when it begins.
Result<bool> CalibrationChoice::once(const Error& error, bool& said) {
  if (std::exchange(said, true)) return false;
  return error;
}

Result<bool> CalibrationChoice::turn(const std::optional<Vec3d>& up_board) {
  if (!rotation_ || !up_board) {
    last_zenith_.reset();
    return false;
  }
  const auto zenith = zenith_from_accelerometer(*rotation_ * *up_board);
  if (!zenith) return once(zenith.error(), said_turn_);
  said_turn_ = false;
  const bool rests = last_zenith_ && angle_deg(*last_zenith_, *zenith) < kRestDeg;
  last_zenith_ = *zenith;
  if (!rests || angle_deg(current_.lens.zenith, *zenith) < kTurnDeg) return false;
  current_.lens.zenith = *zenith;
  return true;
}

Result<bool> CalibrationChoice::pick_flat(const std::optional<double>& temperature_c) {
  if (!temperature_c || flats_.size() < 2) return false;
  const auto away = [&](std::size_t i) { return std::abs(flats_[i].temperature_c - *temperature_c); };
  std::size_t nearest = 0;
  for (std::size_t i = 1; i < flats_.size(); ++i)
    if (away(i) < away(nearest)) nearest = i;
  if (flat_ && (nearest == *flat_ || away(nearest) + kNearerC > away(*flat_))) return false;
  auto flat = read_flat_field(flats_[nearest].file);
  if (!flat) return once(flat.error(), said_flat_);
  if (const Status fits = check(*flat, current_.lens); !fits)
    return once({fits.error().kind, flats_[nearest].file.string() + ": " + fits.error().message}, said_flat_);
  said_flat_ = false;
  current_.flat = std::move(*flat);
  flat_ = nearest;
  return true;
}

Result<std::optional<Calibration>> CalibrationChoice::consider(const Circumstances& now) {
  const auto turned = turn(now.up_board);
  const auto picked = pick_flat(now.temperature_c);
  changed_ = changed_ || (turned && *turned) || (picked && *picked);
  if (!turned) return turned.error();  // a change beside it is told next time
  if (!picked) return picked.error();
  if (!std::exchange(changed_, false)) return std::optional<Calibration>();
  current_.id = calibration_id(current_);
  return std::optional(current_);
}

}  // namespace lightwell
