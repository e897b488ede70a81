// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <libcamera/libcamera.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "daemon/capture/capture_session.h"
#include "daemon/capture/libcamera_format.h"
#include "daemon/capture/libcamera_wire.h"

namespace lightwell {

// libcamera allows one manager in a process. nullptr where it does not start.
std::shared_ptr<libcamera::CameraManager> start_libcamera();

// A camera of libcamera: its raw stream where it has one, else a processed one. It hands on libcamera's own buffers and
// looks into none.
// Controls are given with the start. A sensor takes them up some frames later, and the camera says in each frame's
// metadata what was in force: that is the frame's exposure. Where it says nothing, the first frames are passed over
// until the asked exposure must be in force.
// Threading: one thread; the two listeners are called on libcamera's.
class LibcameraCamera {
 public:
  using OnFrame = std::function<void(const LibcameraMessage::Frame&)>;
  using OnGone = std::function<void()>;

  LibcameraCamera(std::string id, const CaptureOptions& options, OnFrame on_frame, OnGone on_gone);
  ~LibcameraCamera();
  LibcameraCamera(const LibcameraCamera&) = delete;
  LibcameraCamera& operator=(const LibcameraCamera&) = delete;

  // Finds it, agrees on format and controls, allocates buffers.
  std::optional<CaptureFault> open();
  // What was agreed, with the descriptors of the buffers, which stay ours.
  [[nodiscard]] LibcameraMessage ready(std::vector<int>& descriptors) const;
  std::optional<CaptureFault> start();
  // Lets the camera fill this buffer again.
  void queue(std::uint32_t buffer);
  // Most of libcamera's pipelines do not say that a device is gone: the file system does. Such a camera cannot be
  // stopped: libcamera 0.0.3 then fails an assertion of its own.
  [[nodiscard]] bool has_vanished() const;

 private:
  std::optional<CaptureFault> agree_on_format();
  std::optional<CaptureFault> allocate_buffers();
  void completed(libcamera::Request* request);
  void gone();
  void describe(libcamera::Request& request, LibcameraMessage::Frame& frame);
  void measure_rate(std::int64_t t_ns, std::uint64_t frame_id);

  const std::string id_;
  const CaptureOptions options_;
  const OnFrame on_frame_;
  const OnGone on_gone_;
  std::shared_ptr<libcamera::CameraManager> manager_;
  std::shared_ptr<libcamera::Camera> camera_;
  std::unique_ptr<libcamera::CameraConfiguration> configuration_;
  std::unique_ptr<libcamera::FrameBufferAllocator> allocator_;
  std::vector<std::unique_ptr<libcamera::Request>> requests_;
  libcamera::ControlList controls_;
  bool acquired_ = false, streaming_ = false;
  SessionSettings settings_;
  LibcameraFormat packing_;
  int width_ = 0, height_ = 0;
  std::size_t stride_ = 0, picture_bytes_ = 0;
  int vanished_before_ = 0;

  // Of libcamera's thread, once frames come.
  std::uint32_t last_sequence_ = 0;
  std::uint64_t frame_id_ = 0, frames_ = 0, first_id_ = 0;
  std::int64_t first_ns_ = 0;
  double rate_hz_ = 0;
};

}  // namespace lightwell
