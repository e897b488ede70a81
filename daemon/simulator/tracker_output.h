// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "daemon/simulator/prepared_frames.h"
#include "daemon/simulator/scene.h"
#include "interface/tracking_receiver.h"

namespace lightwell::simulator {

struct TrackerOptions {
  TrackingOptions to;  // protocol and address; FreeD's lens is not told
  double rate_hz = 100;
  double lag_s = 0;  // by how much each pose is sent late
};

// A tracker that follows the simulated probe: sends its exact pose over UDP, at its own rate, late by a known lag.
// OpenTrackIO's samples carry the time of sending by CLOCK_TAI's epoch, as a tracker's that knows nothing of its own lag.
class TrackerOutput {
 public:
  // usage: the scene's probe does not move; failed: the address cannot be sent to.
  static Result<std::unique_ptr<TrackerOutput>> start(const TrackerOptions& options,
                                                      std::shared_ptr<const Scene> scene);
  ~TrackerOutput();
  TrackerOutput(const TrackerOutput&) = delete;
  TrackerOutput& operator=(const TrackerOutput&) = delete;

  // A frame left: ties the scene's time to the clock's. Nothing is sent before the first, nor once frames stop: then the
  // scene stands. Any thread.
  void frame(const SentFrame& frame);

 private:
  TrackerOutput(const TrackerOptions& options, std::shared_ptr<const Scene> scene, int socket);
  void run();
  void send(std::int64_t now_ns, std::uint16_t sequence) const;

  struct Anchor {
    std::int64_t mono_ns;
    double scene_s;
  };
  const TrackerOptions options_;
  const std::shared_ptr<const Scene> scene_;
  const int socket_;
  std::mutex mutex_;
  std::condition_variable stop_;
  bool running_ = true;
  std::optional<Anchor> anchor_;
  std::thread thread_;  // last: starts when all else is there
};

}  // namespace lightwell::simulator
