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
#include "daemon/capture/capture_session.h"
#include "daemon/capture/v4l2_device.h"
#include "daemon/capture/v4l2_exposure.h"
#include "daemon/capture/v4l2_format.h"

namespace lightwell {

// One streaming connection to a V4L2 device, in the driver's own memory-mapped buffers. Where the driver exports them
// as DMABUF and its lines are ours, frames are handed on without a copy, mapped through the DMABUF, which keeps no hold
// on the device: a lease may outlive the connection, and the device can be opened again meanwhile. Otherwise every
// frame is unpacked once into a pool of our own.
class V4l2Session final : public CaptureSession {
 public:
  V4l2Session(std::string path, V4l2Calls& calls, const CaptureOptions& options);
  ~V4l2Session() override;
  V4l2Session(const V4l2Session&) = delete;
  V4l2Session& operator=(const V4l2Session&) = delete;

  std::optional<CaptureFault> open() override;
  std::optional<CaptureFault> start() override;
  Event next(std::chrono::milliseconds timeout, SessionFrame& frame) noexcept override;  // allocates nothing
  [[nodiscard]] CaptureFault fault() const override;
  std::string refresh() override;
  [[nodiscard]] bool sets_exposure() const override { return exposure_ && exposure_->known(); }
  Status set_exposure_us(double exposure_us) override;
  [[nodiscard]] const SessionSettings& settings() const override { return settings_; }
  void give_back(std::size_t buffer) noexcept override;
  void wake() noexcept override;
  void close() noexcept override;
  [[nodiscard]] bool all_returned() const noexcept override { return out_.load() == 0; }

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
  Event dequeue(SessionFrame& frame) noexcept;
  bool keep(std::uint32_t index, std::span<const std::byte> bytes, SessionFrame& frame) noexcept;
  bool take_events() noexcept;
  void unmap_all() noexcept;
  void remark(const std::string& words);

  const std::string path_;
  V4l2Calls& calls_;
  const CaptureOptions options_;
  V4l2Device device_;
  SessionSettings settings_;
  V4l2Format packing_;
  V4l2FrameLayout layout_;
  std::optional<V4l2Exposure> exposure_;
  bool exposure_polled_ = false;  // no event tells of it
  int wake_fd_ = -1;
  int error_ = 0;
  bool streaming_ = false, direct_ = false;
  bool source_changed_ = false;
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
