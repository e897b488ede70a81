// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <set>
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
    std::uint64_t clock_steps = 0;                 // how often the tracker's clock was set back
    std::optional<int> camera{};                   // the one that is followed, where they have numbers
    std::set<int> other_cameras{};                 // heard at the same port and left out
    double longest_silence_s = 0;                  // without a pose, from the start to the end
    double silence_at_end_s = 0;
  };
  // A line a call, on the recorder's thread, as it happens: poses stop and come again, the tracker's clock was set back,
  // other cameras are heard.
  using Remark = std::function<void(const std::string&)>;
  // failed: as TrackingReceiver::open and PoseFileWriter::create.
  static Result<std::unique_ptr<PoseRecorder>> start(const TrackingOptions& options,
                                                     const std::filesystem::path& file, Remark remark = {});
  ~PoseRecorder();
  PoseRecorder(const PoseRecorder&) = delete;
  PoseRecorder& operator=(const PoseRecorder&) = delete;

  [[nodiscard]] std::uint16_t port() const { return receiver_.port(); }
  [[nodiscard]] std::uint64_t poses() const { return count_; }
  // Ends it. A disk that was full: failed; what was written before is whole.
  Status stop();
  // After stop: PoseFileWriter::keep. Poses that are not kept go away with this.
  Status keep() { return writer_.keep(); }
  [[nodiscard]] const Stats& stats() const { return stats_; }  // after stop

 private:
  PoseRecorder(TrackingReceiver receiver, PoseFileWriter writer, Remark remark);
  void run();
  Status take(const TrackingArrival& arrival);
  [[nodiscard]] bool comes_in_order(const TrackingArrival& arrival, const TrackedCamera& tracked);
  void listen_for_silence(bool pose_came);

  TrackingReceiver receiver_;
  PoseFileWriter writer_;
  Remark remark_;
  Stats stats_;
  std::optional<std::int64_t> last_arrived_ns_, last_sampled_ns_;
  std::optional<std::int64_t> earlier_sampled_ns_;  // the last one, where it was too early by far
  std::chrono::steady_clock::time_point heard_;
  bool silent_ = false;
  Status written_;
  std::atomic<std::uint64_t> count_ = 0;
  std::atomic<bool> running_ = true;
  std::thread thread_;  // last: starts when all else is there
};

}  // namespace lightwell
