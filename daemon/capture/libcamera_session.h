// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "daemon/capture/buffer_pool.h"
#include "daemon/capture/capture_session.h"
#include "daemon/capture/libcamera_format.h"
#include "daemon/capture/libcamera_process.h"
#include "daemon/capture/libcamera_wire.h"

namespace lightwell {

// What a source remembers of its search for a camera, from session to session. To start libcamera costs a tenth of a
// second of computing: where no device has come or gone it is asked again only now and then, since a camera may also be
// missing as long as another program has it.
struct LibcameraSearch {
  std::string missing;  // what the last look found instead; empty: there was none, or it found the camera
  std::int64_t looked_ns = 0;  // then
  std::int64_t began_to_change_ns = 0;
  std::int64_t changed_ns = 0;   // device nodes came or went last, as far as seen
  std::int64_t nodes_stamp = 0;  // by which that is seen
};

// One streaming connection to a camera of libcamera, which lives in a process of its own (daemon/libcamera, and
// docs/decisions for why): it is started for the connection and ends with it. Buffers are libcamera's, mapped here through
// DMABUF: frames are handed on without a copy where their lines are ours, otherwise unpacked once into a pool of our own.
class LibcameraSession final : public CaptureSession {
 public:
  LibcameraSession(std::shared_ptr<LibcameraSearch> search, std::string id, const CaptureOptions& options);
  ~LibcameraSession() override;
  LibcameraSession(const LibcameraSession&) = delete;
  LibcameraSession& operator=(const LibcameraSession&) = delete;

  std::optional<CaptureFault> find() override;
  std::optional<CaptureFault> open() override;
  std::optional<CaptureFault> start() override;
  Event next(std::chrono::milliseconds timeout, SessionFrame& frame) noexcept override;  // allocates nothing
  [[nodiscard]] CaptureFault fault() const override { return fault_; }
  std::string refresh() override { return {}; }
  [[nodiscard]] const SessionSettings& settings() const override { return settings_; }
  void give_back(std::size_t buffer) noexcept override;
  void wake() noexcept override;
  void close() noexcept override;
  [[nodiscard]] bool all_returned() const noexcept override { return out_.load() == 0; }

 private:
  struct Mapping {
    std::byte* at = nullptr;
    std::size_t bytes = 0, begin = 0;  // begin: of the picture in it
  };

  std::optional<CaptureFault> map_buffers(const LibcameraMessage::Ready& ready,
                                          const std::vector<int>& descriptors);
  Event take(const LibcameraMessage& message, SessionFrame& frame) noexcept;
  void keep(const LibcameraMessage::Frame& said, SessionFrame& frame) noexcept;
  void hand_back(std::uint32_t buffer) noexcept;

  const std::shared_ptr<LibcameraSearch> search_;
  const std::string id_;
  const CaptureOptions options_;
  LibcameraProcess process_;
  int wake_fd_ = -1;
  SessionSettings settings_;
  CaptureFault fault_;
  LibcameraFormat packing_;
  int width_ = 0, height_ = 0;
  std::size_t stride_ = 0, picture_bytes_ = 0;
  bool direct_ = false;
  std::vector<Mapping> mappings_;
  std::unique_ptr<BufferPool> pool_;

  std::mutex mutex_;               // guards what follows
  std::vector<std::size_t> free_;  // buffers of the pool; never outgrows it
  bool closed_ = false;
  std::atomic<int> out_{0};  // frames handed on that have not come back
};

}  // namespace lightwell
