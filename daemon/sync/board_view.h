// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "daemon/sync/flicker_follower.h"
#include "daemon/sync/photodiode_check.h"
#include "interface/sync_protocol.h"
#include "interface/timecode.h"

namespace lightwell {

enum class BoardState {
  off,             // none is configured
  no_device,       // nothing answers at the address; tried again by itself
  wrong_firmware,  // it speaks another version of the protocol
  connected,
};
const char* name(BoardState state);

// What the board said last; a plain copy.
struct BoardView {
  BoardState state = BoardState::off;
  std::string description;  // one line for a person: what is connected, or what is wrong and what to do
  std::uint64_t reconnects = 0;
  std::uint64_t lost_frames = 0;  // gaps in the board's sequence
  double clock_bound_us = 0;      // its clock is mapped to the host's at least so well
  double drift_ppm = 0;
  double acquiring_s = 0;  // for so long a reference is set and not yet followed
  std::optional<sync_hello> hello;
  std::optional<sync_configuration> configuration;
  std::optional<sync_status> status;
  std::optional<sync_photodiode> photodiode;
  std::optional<sync_imu> imu;
  std::array<std::optional<sync_temperature>, 2> temperature;  // by SYNC_SENSOR_…
  std::optional<sync_timecode> timecode;
  // Frames whose exposure the strobe told, and those it did not.
  std::uint64_t stamped = 0, left = 0;
  // What the daemon makes of it (daemon/adaptation.h).
  std::optional<PhotodiodeCheck::Verdict> photodiode_check;
  std::optional<TriggerChoice> avoiding;  // trigger and exposure, where lamps moved them from those asked for
  double tilt_deg = 0;                    // of the camera off the zenith, by the calibration in use
  std::string refused;                    // the last FAULT, in words; empty: none since the connection
};

// What TIMECODE names.
Timecode timecode_of(const sync_timecode& message);

// A FAULT in words: message, field, allowed range.
std::string fault_text(const sync_fault& fault);

}  // namespace lightwell
