// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <libcamera/libcamera.h>

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "daemon/capture/buffer_pool.h"
#include "daemon/capture/capture_session.h"
#include "daemon/capture/libcamera_format.h"

namespace lightwell {

// libcamera allows one manager in a process; everybody shares it. nullptr where it does not start.
std::shared_ptr<libcamera::CameraManager> libcamera_manager();

// Where a source keeps it between its sessions; empty until the first looks.
struct LibcameraManagerHold {
  std::mutex mutex;  // guards what follows: a session is closed while the next one opens
  std::shared_ptr<libcamera::CameraManager> manager;
  std::int64_t since_mono_ns = 0;
};
using LibcameraManagerSlot = std::shared_ptr<LibcameraManagerHold>;

// One streaming connection to a camera of libcamera: its raw stream where it has one, else a processed one. Buffers are
// libcamera's own, mapped through DMABUF: frames are handed on without a copy where their lines are ours, otherwise
// unpacked once into a pool of our own.
// Controls are given with the start. A sensor takes them up some frames later, and the camera says in each frame's
// metadata what was in force: that is the frame's exposure. Where it says nothing, the first frames are passed over
// until the asked exposure must be in force.
// A camera whose device has vanished cannot be stopped: libcamera 0.0.3 then fails an assertion of its own and takes the
// process with it. It is left behind as it is, with its manager stopped, some megabytes each time, and a new manager
// looks for it. Most of libcamera's pipelines do not say that a device is gone: the file system does.
// Threading: as CaptureSession; libcamera's own thread calls completed and gone.
class LibcameraSession final : public CaptureSession {
 public:
  LibcameraSession(LibcameraManagerSlot manager, std::string id, const CaptureOptions& options);
  ~LibcameraSession() override;
  LibcameraSession(const LibcameraSession&) = delete;
  LibcameraSession& operator=(const LibcameraSession&) = delete;

  std::optional<CaptureFault> open() override;
  std::optional<CaptureFault> start() override;
  Event next(std::chrono::milliseconds timeout, SessionFrame& frame) noexcept override;
  [[nodiscard]] CaptureFault fault() const override;
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

  std::optional<CaptureFault> agree_on_format();
  std::optional<CaptureFault> choose_controls();
  std::optional<CaptureFault> map_buffers();
  void completed(libcamera::Request* request);
  void gone();
  bool queue_idle() noexcept;
  void describe(libcamera::Request& request, std::size_t index, SessionFrame& frame) noexcept;
  bool keep(std::size_t index, SessionFrame& frame) noexcept;
  void measure_rate(std::int64_t t_ns, std::uint64_t frame_id) noexcept;
  void abandon() noexcept;
  bool has_vanished() noexcept;
  void remark(const std::string& words);

  const LibcameraManagerSlot manager_;
  const std::string id_;
  const CaptureOptions options_;
  std::shared_ptr<libcamera::Camera> camera_;
  std::unique_ptr<libcamera::CameraConfiguration> configuration_;
  std::unique_ptr<libcamera::FrameBufferAllocator> allocator_;
  std::vector<std::unique_ptr<libcamera::Request>> requests_;
  libcamera::ControlList controls_;
  bool acquired_ = false, streaming_ = false;
  SessionSettings settings_;
  LibcameraFormat packing_;
  int width_ = 0, height_ = 0;
  std::size_t stride_ = 0;
  bool direct_ = false;
  std::vector<Mapping> mappings_;
  std::unique_ptr<BufferPool> pool_;
  std::uint32_t last_sequence_ = 0;
  std::uint64_t frame_id_ = 0, frames_ = 0;
  std::int64_t first_ns_ = 0;
  std::uint64_t first_id_ = 0;
  int error_ = 0;
  bool lost_ = false;
  int vanished_before_ = 0;
  std::int64_t heard_ns_ = 0, looked_ns_ = 0;

  std::mutex mutex_;  // guards what follows; its lists never outgrow what start reserved
  std::condition_variable news_;
  std::vector<std::size_t> done_;  // requests, oldest first
  std::vector<std::size_t> idle_;  // requests to queue again
  std::vector<std::size_t> free_;  // buffers of the pool
  bool gone_ = false, woken_ = false;
  std::atomic<int> out_{0};  // frames handed on that have not come back
};

}  // namespace lightwell
