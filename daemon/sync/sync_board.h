// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "daemon/sync/board_clock_map.h"
#include "daemon/sync/board_view.h"
#include "daemon/sync/strobe_ring.h"
#include "daemon/sync/sync_link.h"
#include "daemon/sync/timecode_stamper.h"
#include "interface/sync_frame.h"
#include "interface/sync_protocol.h"

namespace lightwell {

struct BoardOptions {
  SyncAddress address;
  // Sent when the board connects, with power for the camera that it feeds; the other fields stay as the board has them.
  struct Trigger {
    std::uint32_t rate_numerator = 25, rate_denominator = 1;  // a second
    std::uint32_t pulse_ns = 0;                               // 0: as the board has it
    std::uint32_t exposure_ns = 0;                            // 0: as the board has it
    sync_reference reference = SYNC_REFERENCE_NONE;
    std::uint32_t reference_numerator = 1, reference_denominator = 1;
  };
  std::optional<Trigger> trigger;  // empty: the board's own settings stay as they are
  // A press of the record button; called on the board's thread.
  std::function<void(sync_press)> on_button;
  // Opens the link; empty: as the address says.
  OpenSyncLink open;
};

// The daemon's side of the sync board, on a thread of its own: connects, and again whenever the board comes back; maps its
// clock by 40 exchanges a second; keeps what it says. A board that is not there is no error.
class SyncBoard {
 public:
  // strobes takes exposures as the strobe shows them, timecodes the words of LTC; both outlive this.
  SyncBoard(BoardOptions options, StrobeRing& strobes, TimecodeStamper& timecodes);
  ~SyncBoard();
  SyncBoard(const SyncBoard&) = delete;
  SyncBoard& operator=(const SyncBoard&) = delete;

  // Ends the thread; what was seen last stays to be read.
  void stop() noexcept;
  [[nodiscard]] BoardView view() const;
  // Another rate and exposure from now on, of the trigger that was asked for; nothing where none was.
  void set_trigger(double rate_hz, double exposure_us);
  // What the board's LED shows; while recording it takes no update.
  void set_host_state(sync_host state) noexcept { host_state_ = state; }

 private:
  void run();
  Status meet();
  // Until the board is gone or stops speaking. The link is good for one connection.
  Status converse(SyncLink& link);
  Status send(SyncLink& link, const sync_message& message);
  Status send_due(SyncLink& link);
  void take(const sync_message& message, std::int64_t received_mono_ns);
  void take_strobe(const sync_strobe& strobe);
  void take_timecode(const sync_timecode& timecode);
  void begin_anew();
  [[nodiscard]] sync_configuration wanted() const;
  Status configure(SyncLink& link);
  void forget_configuration();
  void set_state(BoardState state, const std::string& description);
  void see_status(const sync_status& status);

  BoardOptions options_;
  std::unique_ptr<SyncPort> port_;
  StrobeRing& strobes_;
  TimecodeStamper& timecodes_;
  std::atomic<sync_host> host_state_{SYNC_HOST_IDLE};
  std::atomic<bool> stopping_{false};

  // The thread's own.
  BoardClockMap clock_;
  frame_receiver receiver_{};
  std::uint16_t sequence_ = 0;
  std::optional<std::uint16_t> last_sequence_;
  std::int64_t next_ping_ns_ = 0, next_state_ns_ = 0, next_hello_ns_ = 0, next_question_ns_ = 0;
  std::int64_t last_heard_ns_ = 0;
  std::uint64_t last_board_ns_ = 0;
  bool connected_before_ = false;
  bool started_ = false;
  bool agreed_ = false;  // HELLO with our schema
  std::optional<sync_configuration> has_, asked_,
      refused_;                          // the board's; the last CONFIGURE; what a FAULT answered
  std::int64_t acquiring_since_ns_ = 0;  // 0: it is not
  std::string logged_;
  bool safe_ = false;  // it went back to safe defaults by itself

  std::optional<BoardOptions::Trigger> trigger_;  // the latest wanted
  mutable std::mutex mutex_;                      // guards view_ and next_trigger_
  std::optional<BoardOptions::Trigger> next_trigger_;
  BoardView view_;
  std::thread thread_;
};

}  // namespace lightwell
