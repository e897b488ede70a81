// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "daemon/capture/capture_source.h"
#include "daemon/pipeline/frame_path.h"
#include "daemon/pipeline/retired_sources.h"

namespace lightwell {

// Sees every developed frame after its lights are out. Must not block or allocate: it runs on the frame path.
class FrameSink {
 public:
  virtual ~FrameSink() = default;
  virtual void offer(const FrameInfo& info, std::span<const std::byte> codes) noexcept = 0;
};

// Knows more of a frame's time than its camera. Must not block or allocate.
class FrameStamper {
 public:
  virtual ~FrameStamper() = default;
  // Sets what it knows; false where it knows nothing.
  virtual bool stamp(FrameInfo& info) noexcept = 0;
};

// The frame path's thread: takes the source's freshest frame, makes its lights, offers it to the sink.
// Everything else in the daemon reads what it publishes; nothing else can make it wait.
class Pipeline {
 public:
  // sink may be null; stampers are asked in their order. All outlive the pipeline.
  explicit Pipeline(FrameSink* sink, std::vector<FrameStamper*> stampers = {});
  ~Pipeline();
  Pipeline(const Pipeline&) = delete;
  Pipeline& operator=(const Pipeline&) = delete;

  // Fails where the source cannot even begin (missing file); afterwards frames flow until stop.
  Status start(std::shared_ptr<CaptureSource> source, std::shared_ptr<FramePath> path);
  // Takes effect between two frames; the last call before that counts. source null: keep the one that runs
  // (or that an earlier call has begun), without losing a frame: the new path's tables are made here, for the
  // frames that come now. A source that is replaced ends on a thread of its own, however long that takes.
  // A new source that cannot begin is refused here and the old one goes on.
  Status replace(std::shared_ptr<CaptureSource> source, std::shared_ptr<FramePath> path);
  // Stops the thread and all sources; up to 5 s where a camera died.
  void stop() noexcept;

  struct View {  // for status; both stay valid while held
    std::shared_ptr<CaptureSource> source;
    std::shared_ptr<FramePath> path;
    std::string mismatch;  // why frames arrive but are not developed; empty: all well
    double measured_rate_hz = 0;
    std::uint64_t dropped = 0;  // frames that came and were not developed, since start
  };
  [[nodiscard]] View view() const;
  // Advances with every turn of the loop, frames or not: a stuck frame path stops it (watchdog).
  [[nodiscard]] std::uint64_t heartbeat() const noexcept {
    return heartbeat_.load(std::memory_order_relaxed);
  }

 private:
  void run() noexcept;
  void make_tables(FramePath& path) const;
  void take_replacement();
  void handle(const FrameLease& frame);
  void measure_rate(std::int64_t now_ns) noexcept;

  FrameSink* sink_;
  std::vector<FrameStamper*> stampers_;
  RetiredSources retired_;
  std::thread thread_;
  std::atomic<bool> stopping_{false};
  std::atomic<std::uint64_t> heartbeat_{0};
  std::atomic<double> measured_rate_hz_{0};
  std::atomic<std::uint64_t> dropped_{0};

  mutable std::mutex mutex_;  // guards the five below; the frame path holds it for pointer copies only
  std::shared_ptr<CaptureSource> source_, next_source_;
  std::shared_ptr<FramePath> path_, next_path_;
  std::optional<FrameFormat> format_;  // of the frames that come now
  std::string mismatch_;
  std::atomic<bool> replacement_waits_{false};

  // Frame path's own.
  bool mismatched_ = false;
  std::optional<FrameFormat> handled_format_;
  std::int64_t rate_window_start_ns_ = 0;
  std::uint64_t rate_window_published_ = 0;
};

}  // namespace lightwell
