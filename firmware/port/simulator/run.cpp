// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "firmware/port/simulator/run.h"

#include <signal.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "firmware/app/app.h"

namespace lightwell::sync_simulator {
namespace {

std::atomic<bool> stop{false};

}  // namespace

void run(Simulator& simulator, Link& link, const Pace& pace) {
  struct sigaction action {};
  action.sa_handler = [](int) { stop = true; };
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  signal(SIGPIPE, SIG_IGN);
  app_start();
  const auto begin = std::chrono::steady_clock::now();
  constexpr int kBatch = World::kSampleHz / 1000;  // a millisecond
  while (!stop && (pace.seconds == 0 || simulator.world.seconds() < pace.seconds)) {
    if (!link.move(simulator.from_host, simulator.to_host)) return;
    if (pace.fast && !simulator.to_host.empty()) {  // a host that is slower than virtual time holds it back
      std::this_thread::sleep_for(std::chrono::microseconds(100));
      continue;
    }
    for (int i = 0; i < kBatch; ++i) {
      simulator.world.step();
      app_poll();
    }
    if (!pace.fast)
      std::this_thread::sleep_until(begin + std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                                                std::chrono::duration<double>(simulator.world.seconds())));
  }
  link.move(simulator.from_host, simulator.to_host);
}

}  // namespace lightwell::sync_simulator
