// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "interface/pose_file.h"
#include "interface/tracking_receiver.h"

namespace lightwell {

// Writes what a tracker sends to a pose file as it comes, on a thread of its own.
class PoseRecorder {
 public:
  struct Stats {
    std::uint64_t poses = 0;
    std::uint64_t malformed = 0;                   // datagrams
    std::uint64_t out_of_order = 0;                // poses not later than one before them, left out
    std::optional<std::string> first_malformed{};  // what was wrong with it
  };
  // failed: as TrackingReceiver::open and PoseFileWriter::create.
  static Result<std::unique_ptr<PoseRecorder>> start(const TrackingOptions& options,
                                                     const std::filesystem::path& file);
  ~PoseRecorder();
  PoseRecorder(const PoseRecorder&) = delete;
  PoseRecorder& operator=(const PoseRecorder&) = delete;

  [[nodiscard]] std::uint16_t port() const { return receiver_.port(); }
  [[nodiscard]] std::uint64_t poses() const { return count_; }
  // Ends it. A disk that was full: failed; what was written before is whole.
  Status stop();
  [[nodiscard]] const Stats& stats() const { return stats_; }  // after stop

 private:
  PoseRecorder(TrackingReceiver receiver, PoseFileWriter writer);
  void run();
  Status take(const TrackingArrival& arrival);

  TrackingReceiver receiver_;
  PoseFileWriter writer_;
  Stats stats_;
  std::optional<std::int64_t> last_arrived_ns_, last_sampled_ns_;
  Status written_;
  std::atomic<std::uint64_t> count_ = 0;
  std::atomic<bool> running_ = true;
  std::thread thread_;  // last: starts when all else is there
};

}  // namespace lightwell
