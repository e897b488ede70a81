// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <span>
#include <string>
#include <thread>

#include "daemon/sync/board_view.h"
#include "daemon/sync/gpio_trigger.h"
#include "daemon/sync/strobe_pairing.h"
#include "daemon/sync/strobe_ring.h"

namespace lightwell {

struct GpioOptions {
  std::string chip;                       // "/dev/gpiochip0"
  std::string trigger_line, strobe_line;  // GpioPlace::line; empty: none, but not both
  TriggerPulses pulses;                   // where there is a trigger line
};

// Trigger and strobe on lines of this machine, for a probe without a sync board: the exposures it sees bind frames as a
// board's do. On threads of its own; a chip or line that is not to be had is tried again. Without a trigger line the camera
// runs by itself, and each of its strobes counts as a trigger.
class GpioSync {
 public:
  // strobes: takes the exposures, and outlives this.
  GpioSync(GpioOptions options, StrobeRing& strobes);
  ~GpioSync();
  GpioSync(const GpioSync&) = delete;
  GpioSync& operator=(const GpioSync&) = delete;

  // In a board's words: what no line can say is empty. phase_error_ns and phase_rms_ns are how late the trigger's thread woke.
  [[nodiscard]] BoardView view() const;

 private:
  void run();
  // Until the chip is gone.
  Status work();
  void take_edges(std::span<const GpioEdge> edges, GpioTrigger* trigger, StrobePairing& pairing);
  void publish(const GpioTrigger* trigger, const StrobePairing& pairing);
  [[nodiscard]] std::string description(bool real_time) const;

  GpioOptions options_;
  StrobeRing& strobes_;
  std::uint32_t free_strobes_ = 0;  // of a camera that runs by itself
  bool worked_before_ = false;
  std::atomic<bool> stopping_{false};
  mutable std::mutex mutex_;  // guards view_
  BoardView view_;
  std::thread thread_;
};

}  // namespace lightwell
