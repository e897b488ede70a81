// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "firmware/port/simulator/link.h"
#include "firmware/port/simulator/simulator.h"

namespace lightwell::sync_simulator {

struct Pace {
  double seconds = 0;  // virtual, to run; 0: until stopped
  bool fast = false;   // as fast as the host reads; else as fast as the clock
};

// The board's loop, a millisecond of its world after the other, until SIGINT, SIGTERM, the end of its seconds or of its link.
// Throws what the link throws.
void run(Simulator& simulator, Link& link, const Pace& pace);

}  // namespace lightwell::sync_simulator
