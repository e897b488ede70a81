// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <mutex>
#include <optional>

#include "daemon/calibration_choice.h"
#include "daemon/pipeline/pipeline.h"
#include "daemon/pipeline/snapshot.h"
#include "daemon/sync/flicker_follower.h"
#include "daemon/sync/photodiode_check.h"
#include "daemon/sync/sync_board.h"

namespace lightwell {

// What the daemon adapts to, about once a second and never on the frame path: gravity turns the world upright, temperature
// picks the fixed pattern, lamps move trigger and exposure, the photodiode vouches for the scale. While a take is written
// nothing of it changes: a take has one calibration.
class Adaptation {
 public:
  struct Options {
    CalibrationChoice calibration;
    // Trigger that the board was told, and the exposure that the camera was (0: what its frames say); empty: the board's own.
    std::optional<TriggerChoice> trigger;
    bool avoid_flicker = false;  // may depart from it where lamps beat with it
  };
  // board: null where there is none; the temperature of the camera's own sensor is then all there is.
  Adaptation(SyncBoard* board, Pipeline& pipeline, SnapshotChannel& snapshots, Options options);

  // After a reload. What is asked for as before stays as it has been adapted; else trigger and exposure go back to what is
  // asked for. The thread that calls turn.
  void use(Options options, bool same_source);
  // What a reload to this calibration develops frames with: as adapted, where it is the same.
  [[nodiscard]] const Calibration& adapted(const Calibration& base) const;
  // The calibration to develop frames with from now on; empty: the one in use stays.
  std::optional<Calibration> turn(bool recording);

  // Adds what is known here. Any thread.
  void describe(BoardView& view) const;

 private:
  void compare_with_photodiode(const BoardView& board, const Snapshot& newest);
  void follow_flicker(const BoardView& board, const Snapshot& newest);
  void change_to(const TriggerChoice& choice, double beat);
  void finish_change(const Snapshot& newest);
  void give_up(const TriggerChoice& choice, const char* why);
  [[nodiscard]] std::optional<Calibration> choose_calibration(const BoardView& board, const Snapshot& newest);
  void publish_view(bool connected);

  SyncBoard* board_;
  Pipeline& pipeline_;
  SnapshotChannel& snapshots_;
  Options options_;
  std::optional<TriggerChoice> asked_trigger_;  // as the configuration has it
  bool asked_avoid_ = false;
  std::optional<FlickerFollower> follower_;
  struct Change {
    TriggerChoice to;
    double beat = 0;  // what is left of it, relative
    std::int64_t asked_mono_ns = 0;
  };
  std::optional<Change>
      change_;  // the camera was asked for its exposure; the board follows when frames have it
  PhotodiodeCheck photodiode_;
  std::uint64_t last_photodiode_board_ns_ = 0;

  mutable std::mutex mutex_;  // guards the three below
  std::optional<PhotodiodeCheck::Verdict> verdict_;
  std::optional<TriggerChoice> avoiding_;
  double tilt_deg_ = 0;
};

}  // namespace lightwell
