// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/adaptation.h"

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
constexpr std::int64_t kExposureWaitNs = 5'000'000'000;
constexpr double kSameExposure = 0.02;  // cameras expose in lines

std::optional<Vec3d> up_at_rest(const BoardView& board) {
  if (!board.imu || (board.imu->flags & SYNC_IMU_STEADY) == 0) return std::nullopt;
  return Vec3d(board.imu->up_um_s2[0], board.imu->up_um_s2[1], board.imu->up_um_s2[2]);
}

}  // namespace

Adaptation::Adaptation(SyncBoard* board, Pipeline& pipeline, SnapshotChannel& snapshots, Options options)
    : board_(board), pipeline_(pipeline), snapshots_(snapshots), options_(std::move(options)) {
  asked_trigger_ = options_.trigger;
  asked_avoid_ = options_.avoid_flicker;
}

const Calibration& Adaptation::adapted(const Calibration& base) const {
  return base.id == options_.calibration.base_id() ? options_.calibration.current() : base;
}

void Adaptation::use(Options options, bool same_source) {
  if (options.calibration.base_id() == options_.calibration.base_id())
    options.calibration = std::move(options_.calibration);
  if (same_source && options.trigger == asked_trigger_ && options.avoid_flicker == asked_avoid_) {
    options_.calibration = std::move(options.calibration);
    return;
  }
  asked_trigger_ = options.trigger;
  asked_avoid_ = options.avoid_flicker;
  const bool moved = change_ || (follower_ && follower_->follows());
  // What the frames once said was the camera's own; what they say now may be ours.
  if (same_source && options.trigger && options_.trigger && options.trigger->exposure_us <= 0)
    options.trigger->exposure_us = options_.trigger->exposure_us;
  options_ = std::move(options);
  follower_.reset();
  change_.reset();
  photodiode_.reset();
  const auto& wanted = options_.trigger;
  if (!wanted || wanted->exposure_us <= 0 || board_ == nullptr) return;
  if (moved && same_source) static_cast<void>(pipeline_.view().source->set_exposure_us(wanted->exposure_us));
  board_->set_trigger(wanted->rate_hz, wanted->exposure_us);
}

void Adaptation::describe(BoardView& view) const {
  const std::scoped_lock lock(mutex_);
  view.photodiode_check = verdict_;
  view.avoiding = avoiding_;
  view.tilt_deg = tilt_deg_;
}

void Adaptation::publish_view(bool connected) {
  const std::scoped_lock lock(mutex_);
  verdict_ = connected ? photodiode_.verdict() : std::nullopt;
  avoiding_ = connected && !change_ && follower_ && follower_->follows() ? std::optional(follower_->current())
                                                                         : std::nullopt;
  tilt_deg_ = options_.calibration.tilt_deg();
}

std::optional<Calibration> Adaptation::turn(bool recording) {
  const BoardView board = board_ != nullptr ? board_->view() : BoardView();
  const bool connected = board.state == BoardState::connected;
  if (!connected) photodiode_.reset();
  std::optional<Calibration> chosen;
  const auto newest = snapshots_.wait_newer(0, std::chrono::milliseconds(0));
  if (newest && mono_now_ns() - newest->capture_mono_ns <= kFreshNs) {
    if (connected) compare_with_photodiode(board, *newest);
    if (connected && !recording) follow_flicker(board, *newest);
    if (!recording) chosen = choose_calibration(board, *newest);
  }
  publish_view(connected);
  return chosen;
}

// The board looks along the camera's axis; its level is the mean of the last two seconds.
void Adaptation::compare_with_photodiode(const BoardView& board, const Snapshot& newest) {
  if (!board.photodiode || (board.photodiode->flags & SYNC_PHOTODIODE_CLIPPED) != 0) return;
  if (std::exchange(last_photodiode_board_ns_, board.photodiode->t_board_ns) == board.photodiode->t_board_ns)
    return;
  const Vec3d axis = world_from_camera_rotation(options_.calibration.current().lens.zenith) * Vec3d::UnitZ();
  photodiode_.add(board.photodiode->level_mlx * 1e-3, luminance(plane_illuminance(newest.map, axis)));
}

void Adaptation::follow_flicker(const BoardView& board, const Snapshot& newest) {
  auto& wanted = options_.trigger;
  if (!wanted || !board.photodiode) return;
  if (wanted->exposure_us <= 0) {  // the board's advice starts from it
    wanted->exposure_us = newest.exposure_us;
    board_->set_trigger(wanted->rate_hz, wanted->exposure_us);
    return;
  }
  if (!options_.avoid_flicker) return;
  if (change_) return finish_change(newest);
  if (!follower_) follower_.emplace(*wanted);
  if (const auto choice = follower_->consider(*board.photodiode, mono_now_ns()))
    change_to(*choice, board.photodiode->beat_ppm * 1e-6);
}

void Adaptation::change_to(const TriggerChoice& choice, double beat) {
  switch (pipeline_.view().source->set_exposure_us(choice.exposure_us)) {
    case ExposureChange::asked:
      change_ = Change{choice, beat, mono_now_ns()};
      break;
    case ExposureChange::not_now:
      follower_.reset();  // it is considered again when there is a camera
      break;
    case ExposureChange::never:
      give_up(choice, "this source cannot change its exposure while it runs");
      break;
  }
}

// A trigger without its exposure beats as much as before: the board is told once frames have it.
void Adaptation::finish_change(const Snapshot& newest) {
  const TriggerChoice to = change_->to;
  const double beat = change_->beat;
  if (std::abs(newest.exposure_us - to.exposure_us) <= kSameExposure * to.exposure_us) {
    change_.reset();
    board_->set_trigger(to.rate_hz, to.exposure_us);
    spdlog::info("flicker: triggers of {:.6g} Hz, exposure {:.6g} us{}", to.rate_hz, newest.exposure_us,
                 follower_->follows()
                     ? fmt::format(": {:.2g} % is left of the beat with the lamps", 100 * beat)
                     : ", as configured");
  } else if (mono_now_ns() - change_->asked_mono_ns > kExposureWaitNs) {
    change_.reset();
    give_up(to, "the camera does not take that exposure");
  }
}

// Said once; the page goes on to show the advice.
void Adaptation::give_up(const TriggerChoice& choice, const char* why) {
  spdlog::warn("flicker: {:.6g} Hz and {:.6g} us would not beat with the lamps; {}", choice.rate_hz,
               choice.exposure_us, why);
  options_.avoid_flicker = false;
  follower_.reset();
  const auto& wanted = *options_.trigger;
  static_cast<void>(pipeline_.view().source->set_exposure_us(wanted.exposure_us));
  board_->set_trigger(wanted.rate_hz, wanted.exposure_us);
}

std::optional<Calibration> Adaptation::choose_calibration(const BoardView& board, const Snapshot& newest) {
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
