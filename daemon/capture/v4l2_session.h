// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "daemon/capture/buffer_pool.h"
#include "daemon/capture/capture_source.h"
#include "daemon/capture/v4l2_device.h"
#include "daemon/capture/v4l2_exposure.h"
#include "daemon/capture/v4l2_format.h"

namespace lightwell {

// Why there are no frames, as a state and in words.
struct CaptureFault {
  SourceState state = SourceState::opening;
  std::string message;
};

// What was agreed with the device, read back from it.
struct V4l2Settings {
  std::string name;  // "card (bus)"
  FrameFormat format;
  std::string device_format;  // "Y16"
  double rate_hz = 0;
  double exposure_us = 0;  // 0: not known
  std::string remark;      // what a person should know; often empty
};

struct V4l2Frame {
  enum class Outcome { complete, incomplete, no_room };  // no_room: every buffer is leased
  enum class Stamp {
    none,
    start_of_exposure,
    end_of_frame
  };  // of the driver, in CLOCK_MONOTONIC; none: another clock
  Outcome outcome = Outcome::incomplete;
  std::size_t buffer = 0;  // goes back through V4l2Session::give_back where complete
  std::span<const std::byte> bytes;
  std::uint64_t frame_id = 0;  // for FrameSequence: above 16 bit, counts on across the driver's 32 bit
  Stamp stamp = Stamp::none;
  std::int64_t t_driver_mono_ns = 0;
  std::int64_t received_mono_ns = 0;
};

// One streaming connection to a V4L2 device, in the driver's own memory-mapped buffers. Where the driver exports them
// as DMABUF and its lines are ours, frames are handed on without a copy, mapped through the DMABUF, which keeps no hold
// on the device: a lease may outlive the connection, and the device can be opened again meanwhile. Otherwise every
// frame is unpacked once into a pool of our own.
// Threading: one thread does everything but give_back, wake and all_returned, which are for any thread.
class V4l2Session {
 public:
  enum class Event { nothing, frame, source_changed, broken };

  V4l2Session(V4l2Calls& calls, const CaptureOptions& options);
  ~V4l2Session();  // after the last buffer has come back
  V4l2Session(const V4l2Session&) = delete;
  V4l2Session& operator=(const V4l2Session&) = delete;

  // Opens, asks for signal and format, configures, reads back.
  std::optional<CaptureFault> open(const std::string& path);
  // Allocates the buffers and lets frames come.
  std::optional<CaptureFault> start();
  // The next frame or what happened instead; nothing: the time is over, or wake was called. allocates nothing
  Event next(std::chrono::milliseconds timeout, V4l2Frame& frame) noexcept;
  // Why next said broken, as −errno.
  [[nodiscard]] int error() const noexcept { return error_; }
  // Reads exposure and signal again. Empty: there is a signal.
  std::string refresh();
  [[nodiscard]] const V4l2Settings& settings() const { return settings_; }
  // Nothing is copied.
  [[nodiscard]] bool is_direct() const { return direct_; }

  void give_back(std::size_t buffer) noexcept;
  void wake() noexcept;
  // Ends the connection; buffers that are out may still come back.
  void close() noexcept;
  [[nodiscard]] bool all_returned() const noexcept { return out_.load() == 0; }

 private:
  struct Mapping {
    std::byte* at = nullptr;
    std::size_t bytes = 0;
  };

  std::optional<CaptureFault> agree_on_format();
  std::optional<CaptureFault> apply_settings();
  std::optional<CaptureFault> map_buffers(std::uint32_t count);
  bool map_exported();
  bool queue(std::uint32_t index) noexcept;
  bool queue_returned() noexcept;
  Event dequeue(V4l2Frame& frame) noexcept;
  bool keep(std::uint32_t index, std::span<const std::byte> bytes, V4l2Frame& frame) noexcept;
  bool take_events() noexcept;
  void unmap_all() noexcept;
  void remark(const std::string& words);

  V4l2Calls& calls_;
  const CaptureOptions options_;
  V4l2Device device_;
  V4l2Settings settings_;
  V4l2Format packing_;
  V4l2FrameLayout layout_;
  std::optional<V4l2Exposure> exposure_;
  bool exposure_polled_ = false;  // no event tells of it
  int wake_fd_ = -1;
  int error_ = 0;
  bool streaming_ = false, direct_ = false;
  bool given_up_ = false;             // a buffer could not be queued again
  std::vector<Mapping> mappings_;     // the driver's buffers
  std::unique_ptr<BufferPool> pool_;  // ours, where frames are unpacked
  std::uint32_t last_sequence_ = 0;
  std::uint64_t frame_id_ = 0;

  std::mutex mutex_;                   // guards what follows
  std::vector<std::size_t> returned_;  // never more than there are buffers: no allocation
  std::atomic<int> out_{0};            // frames handed on that have not come back
};

}  // namespace lightwell
