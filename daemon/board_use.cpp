// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/board_use.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <cmath>
#include <utility>

#include "daemon/clock.h"
#include "lighting/orientation.h"
#include "lighting/plane_illuminance.h"

namespace lightwell {
namespace {

constexpr std::int64_t kFreshNs = 2'000'000'000;  // older light is not what the board speaks of

std::optional<Vec3d> up_at_rest(const BoardView& board) {
  if (!board.imu || (board.imu->flags & SYNC_IMU_STEADY) == 0) return std::nullopt;
  return Vec3d(board.imu->up_um_s2[0], board.imu->up_um_s2[1], board.imu->up_um_s2[2]);
}

}  // namespace

BoardUse::BoardUse(SyncBoard& board, Pipeline& pipeline, SnapshotChannel& snapshots, Options options)
    : board_(board), pipeline_(pipeline), snapshots_(snapshots), options_(std::move(options)) {}

void BoardUse::use(Options options) {
  options_ = std::move(options);
  follower_.reset();
  photodiode_.reset();
}

void BoardUse::describe(BoardView& view) const {
  const std::scoped_lock lock(mutex_);
  view.photodiode_check = verdict_;
  view.avoiding = avoiding_;
  view.tilt_deg = tilt_deg_;
}

void BoardUse::publish_view() {
  const std::scoped_lock lock(mutex_);
  verdict_ = photodiode_.verdict();
  avoiding_ = follower_ && follower_->follows() ? std::optional(follower_->current()) : std::nullopt;
  tilt_deg_ = options_.calibration.tilt_deg();
}

std::optional<Calibration> BoardUse::turn(bool recording) {
  const BoardView board = board_.view();
  const auto newest = snapshots_.wait_newer(0, std::chrono::milliseconds(0));
  if (board.state != BoardState::connected || !newest || mono_now_ns() - newest->capture_mono_ns > kFreshNs)
    return std::nullopt;
  compare_with_photodiode(board, *newest);
  std::optional<Calibration> chosen;
  if (!recording) {
    follow_flicker(board, *newest);
    chosen = choose_calibration(board, *newest);
  }
  publish_view();
  return chosen;
}

// The board looks along the camera's axis; its level is the mean of the last two seconds.
void BoardUse::compare_with_photodiode(const BoardView& board, const Snapshot& newest) {
  if (!board.photodiode || (board.photodiode->flags & SYNC_PHOTODIODE_CLIPPED) != 0) return;
  if (std::exchange(last_photodiode_board_ns_, board.photodiode->t_board_ns) == board.photodiode->t_board_ns)
    return;
  const Vec3d axis = world_from_camera_rotation(options_.calibration.current().lens.zenith) * Vec3d::UnitZ();
  photodiode_.add(board.photodiode->level_mlx * 1e-3, luminance(plane_illuminance(newest.map, axis)));
}

void BoardUse::follow_flicker(const BoardView& board, const Snapshot& newest) {
  auto& wanted = options_.trigger;
  if (!wanted || !board.photodiode) return;
  if (wanted->exposure_us <= 0) {  // the board's advice starts from it
    wanted->exposure_us = newest.exposure_us;
    board_.set_trigger(wanted->rate_hz, wanted->exposure_us);
    return;
  }
  if (!options_.avoid_flicker) return;
  if (!follower_) follower_.emplace(*wanted);
  const auto choice = follower_->consider(*board.photodiode, mono_now_ns());
  if (!choice) return;
  if (const Status set = pipeline_.view().source->set_exposure_us(choice->exposure_us); !set) {
    spdlog::warn("flicker: {:.6g} Hz and {:.6g} us would not beat with the lamps; {}", choice->rate_hz,
                 choice->exposure_us, set.error().message);
    options_.avoid_flicker = false;  // said once; the page goes on to show the advice
    follower_.reset();
    return;
  }
  board_.set_trigger(choice->rate_hz, choice->exposure_us);
  spdlog::info("flicker: triggers of {:.6g} Hz, exposure {:.6g} us{}", choice->rate_hz, choice->exposure_us,
               follower_->follows() ? " do not beat with the lamps" : ", as configured");
}

std::optional<Calibration> BoardUse::choose_calibration(const BoardView& board, const Snapshot& newest) {
  CalibrationChoice::Circumstances now;
  now.up_board = up_at_rest(board);
  if (!std::isnan(newest.temperature_c)) now.temperature_c = newest.temperature_c;
  const auto chosen = options_.calibration.consider(now);
  if (!chosen) {
    spdlog::warn("calibration: {}", chosen.error().message);
    return std::nullopt;
  }
  if (*chosen)
    spdlog::info("calibration {}: camera {:.1f} degrees off the zenith{}", (*chosen)->id,
                 options_.calibration.tilt_deg(),
                 now.temperature_c ? fmt::format(", at {:.0f} degrees C", *now.temperature_c) : "");
  return *chosen;
}

}  // namespace lightwell
