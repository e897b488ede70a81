// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "daemon/capture/capture_source.h"
#include "lighting/result.h"

namespace lightwell {

// What was agreed with the camera, read back from it.
struct CameraSettings {
  std::string name;  // "Vendor Model (serial)"
  FrameFormat format;
  double rate_hz = 0;
  double exposure_us = 0;
  double gain_db = 0;
  float temperature_c = 0;   // NaN where the camera has none
  bool free_running = true;  // false: frames come when something triggers them
  int packet_size = 0;
  std::string remark;  // what a person should know: a capped buffer, a rate that was not granted; often empty
};

// A buffer the camera has filled, or failed to.
struct ReceivedFrame {
  enum class Outcome { complete, incomplete, wrong_format };
  void* buffer = nullptr;  // goes back through AravisSession::give_back
  std::span<const std::byte> bytes;
  Outcome outcome = Outcome::incomplete;
  std::uint64_t frame_id = 0;
  std::uint64_t t_device_ns = 0;  // the device's clock, 0 where it has none
  std::int64_t received_mono_ns = 0;
};

// One connection to a GigE Vision camera through Aravis: camera, stream and buffers, made and torn down
// together. Threading: open, start, refresh and close are slow (a dead camera answers nothing for up to 5 s)
// and belong to one control thread. give_back is for any thread, allocates nothing and waits for no device.
// The listener is called on Aravis's threads, between start and the end of close.
class AravisSession {
 public:
  class Listener {
   public:
    virtual ~Listener() = default;
    virtual void frame_done(AravisSession& session, const ReceivedFrame& frame) noexcept = 0;
    virtual void control_lost(AravisSession& session) noexcept = 0;
  };

  AravisSession(const CaptureOptions& options, Listener& listener);
  // Opens by address, requires control, stops a camera that still streams for someone else, configures, reads
  // back. failed: no answer, another program has control, a setting refused (named, with the camera's own
  // words).
  Status open(const std::string& address);
  ~AravisSession();  // after close, and after the last buffer has come back
  AravisSession(const AravisSession&) = delete;
  AravisSession& operator=(const AravisSession&) = delete;

  // Allocates the buffers and lets the camera run.
  Status start();
  // Reads exposure, gain and temperature again; false where the camera does not answer.
  bool refresh();
  [[nodiscard]] const CameraSettings& settings() const { return settings_; }

  // The stream takes the buffer up again with its next frame, or with recycle.
  void give_back(void* buffer) noexcept;
  // Hands returned buffers to the stream; for the control thread, where no frame has come to do it.
  void recycle() noexcept;
  // Ends the connection; buffers that are out may still come back. stop_camera: tell it to stop, where it is
  // alive.
  void close(bool stop_camera) noexcept;
  // No buffer is out.
  [[nodiscard]] bool all_returned() const noexcept;

 private:
  struct Handles;  // everything Aravis
  Status connect(const std::string& address);
  Status configure();
  Status read_back();

  CaptureOptions options_;
  Listener& listener_;
  CameraSettings settings_;
  std::unique_ptr<Handles> handles_;
};

}  // namespace lightwell
