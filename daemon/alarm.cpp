// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/alarm.h"

#include <fmt/format.h>

namespace lightwell {
namespace {

// Light this old is no longer the light on set: longer than the slowest camera's frame, shorter than patience.
constexpr double kStaleMs = 1000;
constexpr double kOpeningS = 5;  // what takes longer does not open
constexpr double kAcquiringS = 5, kHoldoverS = 2;

}  // namespace

std::string alarm_for(const DaemonStatus& status) {
  switch (status.source_state) {
    case SourceState::no_device:
    case SourceState::no_signal:
    case SourceState::stalled:
    case SourceState::wrong_format:
      return fmt::format("Camera: {} ({})", name(status.source_state), status.source_description);
    case SourceState::opening:
      if ((status.published > 0 ? status.frame_age_ms * 1e-3 : status.uptime_s) > kOpeningS)
        return fmt::format("Camera: {} ({})", name(status.source_state), status.source_description);
      break;
    case SourceState::streaming:
    case SourceState::ended:
      break;
  }
  if (!status.calibration_verdict.empty()) return "Calibration: " + status.calibration_verdict;
  if (status.source_state == SourceState::streaming && status.published > 0 && status.frame_age_ms > kStaleMs)
    return fmt::format("Light is {:.1f} s old", status.frame_age_ms / 1000);
  if (status.board.state == BoardState::no_device || status.board.state == BoardState::wrong_firmware)
    return fmt::format("Sync board: {} ({})", name(status.board.state), status.board.description);
  if (!status.board.refused.empty())
    return "Sync board: it refuses what it was told: " + status.board.refused;
  if (status.board.status && status.board.status->safe != 0)
    return "Sync board: it went back to safe defaults, as the daemon was silent";
  if (status.board.acquiring_s > kAcquiringS)
    return fmt::format(
        "Sync board: no lock on its reference for {:.0f} s; is it plugged in, is reference_rate its rate?",
        status.board.acquiring_s);
  if (const auto& board = status.board.status;
      board && board->lock == SYNC_LOCK_HOLDOVER && board->holdover_s > kHoldoverS)
    return fmt::format("Sync board: its reference is lost since {} s; its last rate goes on",
                       board->holdover_s);
  if (const auto& scale = status.board.photodiode_check; scale && scale->differs)
    return fmt::format(
        "Scale: camera and photodiode differ by a factor of {:.2f} ({:.0f} and {:.0f} lx); is the dome "
        "clean, the aperture "
        "as calibrated?",
        scale->ratio, scale->camera_lx, scale->photodiode_lx);
  if (!status.recording.error.empty()) return "Recording stopped: " + status.recording.error;
  if (status.recording.active && status.recording.dropped > 0)
    return fmt::format("Recording has lost {} frames: the disk is too slow", status.recording.dropped);
  return {};
}

std::string calibration_change(const std::string& before, const std::string& now) {
  if (before == now) return {};
  if (now.empty()) return "calibration: fits the frames again, light is published";
  return "calibration: does not fit the frames, no light is published: " + now;
}

}  // namespace lightwell
