// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "daemon/pipeline/fit_worker.h"
#include "daemon/pipeline/snapshot.h"
#include "daemon/pipeline/status.h"
#include "interface/dds_topics.h"

namespace lightwell {

struct PublisherOptions {
  std::string probe = "probe";
  DdsOptions dds;
  double environment_hz = 5;  // at most so many radiance maps a second; 0: none
};

struct PublisherCounters {
  std::uint64_t lights = 0;        // light frames sent, repeats not counted
  std::uint64_t fits = 0;          // ambient and few lights, sent
  std::uint64_t environments = 0;  // radiance maps sent
  std::uint64_t dropped = 0;       // messages of any topic that could not be sent
};

// Sends what the snapshot channel brings over DDS, on two threads of its own: lights on one, maps and status
// on the other, so that a large map never delays lights. The frame path knows nothing of it. Holds at most
// two leases. The last lights are repeated once a second while no new ones come, for readers that join late.
class Publisher {
 public:
  // snapshots and control outlive the publisher.
  static Result<std::unique_ptr<Publisher>> start(const PublisherOptions& options, SnapshotChannel& snapshots,
                                                  const DaemonControl& control);
  ~Publisher();  // within 0.2 s
  Publisher(const Publisher&) = delete;
  Publisher& operator=(const Publisher&) = delete;

  // A fit, at once, on the caller's thread; one thread at a time.
  void send(const FitSnapshot& fit);
  [[nodiscard]] PublisherCounters counters() const;
  // DDS readers of the lights now.
  [[nodiscard]] int readers() const { return lights_->readers(); }

 private:
  Publisher(const PublisherOptions& options, SnapshotChannel& snapshots, const DaemonControl& control)
      : options_(options), snapshots_(snapshots), control_(control) {}
  void run_lights();
  void run_maps_and_status();
  void count(const Status& sent, std::atomic<std::uint64_t>* counter);
  // Sleeps; true when it is time to stop.
  bool pause(std::chrono::nanoseconds time);

  PublisherOptions options_;
  SnapshotChannel& snapshots_;
  const DaemonControl& control_;
  std::unique_ptr<LightWriter> lights_;
  std::unique_ptr<FitWriter> fits_;
  FitFrame fit_message_;
  std::unique_ptr<EnvironmentWriter> environments_;
  std::unique_ptr<StatusWriter> status_;
  std::atomic<std::uint64_t> lights_sent_{0}, fits_sent_{0}, environments_sent_{0}, dropped_{0};
  std::mutex mutex_;
  std::condition_variable stop_wanted_;
  bool stopping_ = false;
  std::thread lights_thread_, maps_thread_;
};

}  // namespace lightwell
