// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "interface/timecode.h"
#include "lighting/frame_format.h"
#include "lighting/result.h"
#include "lighting/vector.h"

namespace lightwell {

// What is known of a frame beside its codes.
struct FrameInfo {
  FrameFormat format;
  std::uint64_t sequence = 0;  // counts the camera's frames, gaps are lost frames; never repeats in a session
  std::int64_t capture_mono_ns = 0;   // mid-exposure, CLOCK_MONOTONIC
  std::int64_t received_mono_ns = 0;  // the whole frame was in memory
  std::int64_t capture_utc_ns = 0;    // label: UTC of capture_mono_ns
  double exposure_us = 0;
  double gain_db = 0;
  float temperature_c = 0;  // NaN where the camera has none
  std::optional<Timecode>
      timecode{};  // of the production's frame in which its middle lies; empty: none is known
  std::optional<Vec3d>
      probe_position_m{};  // world, at capture_mono_ns; from simulated sources whose probe moves
  bool complete = true;    // false: packets missing, bytes undefined; never given to the radiometer
};

// A frame in the source's own buffer; the buffer goes back when the lease ends. Movable, not copyable.
// Hold at most one lease beside the one in work: the pool is small, a held buffer is one the camera cannot fill.
class FrameLease {
 public:
  FrameLease() = default;
  // give_back(context, token) is called once, on the thread that ends the lease; must not allocate or block.
  using GiveBack = void (*)(void* context, void* token) noexcept;
  FrameLease(FrameInfo info, std::span<const std::byte> bytes, GiveBack give_back, void* context, void* token)
      : info_(info), bytes_(bytes), give_back_(give_back), context_(context), token_(token) {}
  FrameLease(FrameLease&& other) noexcept { swap(other); }
  FrameLease& operator=(FrameLease&& other) noexcept {
    FrameLease taken(std::move(other));
    swap(taken);
    return *this;
  }
  FrameLease(const FrameLease&) = delete;
  FrameLease& operator=(const FrameLease&) = delete;
  ~FrameLease() {
    if (give_back_ != nullptr) give_back_(context_, token_);
  }

  explicit operator bool() const noexcept { return give_back_ != nullptr; }
  [[nodiscard]] const FrameInfo& info() const noexcept { return info_; }
  [[nodiscard]] std::span<const std::byte> bytes() const noexcept { return bytes_; }

 private:
  void swap(FrameLease& other) noexcept {
    std::swap(info_, other.info_);
    std::swap(bytes_, other.bytes_);
    std::swap(give_back_, other.give_back_);
    std::swap(context_, other.context_);
    std::swap(token_, other.token_);
  }
  FrameInfo info_;
  std::span<const std::byte> bytes_;
  GiveBack give_back_ = nullptr;
  void* context_ = nullptr;
  void* token_ = nullptr;
};

enum class SourceState {
  no_device,     // nothing answers at the address; tried again by itself
  opening,       // talking to the device
  no_signal,     // the device is there, what should be connected to it sends nothing it can lock on
  streaming,     // frames arrive
  stalled,       // the device answers, frames do not arrive
  wrong_format,  // frames of another size or format arrive than were agreed; re-opens by itself
  ended,         // a recording is over
};
const char* name(SourceState state);

// Counts since start; read from any thread.
struct CaptureCounters {
  std::uint64_t received = 0;    // complete frames
  std::uint64_t skipped = 0;     // complete, but a fresher one was taken instead
  std::uint64_t lost = 0;        // gaps in the camera's sequence
  std::uint64_t incomplete = 0;  // packets missing
  std::uint64_t reconnects = 0;
};

enum class ExposureChange {
  asked,    // the device is being told
  not_now,  // there is no device now
  never,    // this source cannot change it while it runs
};

// A camera, a recording or a simulation. One implementation a file; made by make_capture_source from a source string.
//
// Threading: start, wait and stop are called one after the other, by whichever thread; wait only by the frame path's. The
// source's own threads do all device work; wait never touches the device, allocates nothing after the first frame, and returns within its timeout.
// A device that disappears is not an error: state() says so, the source reconnects by itself, wait returns empty.
class CaptureSource {
 public:
  virtual ~CaptureSource() = default;

  // Starts to connect; returns at once. Fails only where trying again cannot help (malformed address, missing file).
  virtual Status start() = 0;
  // The freshest complete frame not yet taken; older ones are given back and counted as skipped, unless the source is
  // lossless (a recording played for exactness), where frames come in order. Empty: none within the timeout.
  virtual FrameLease wait(std::chrono::milliseconds timeout) noexcept = 0;
  // Stops within 5 s, device included. Leases may outlive stop but not the source.
  virtual void stop() noexcept = 0;

  // Asks for another exposure; frames say in exposure_us from when it holds, and whether it came. Any thread, between
  // start and stop.
  virtual ExposureChange set_exposure_us(double /*exposure_us*/) { return ExposureChange::never; }

  [[nodiscard]] virtual SourceState state() const noexcept = 0;
  // One line for a person: what is connected, or what is wrong and what to do.
  [[nodiscard]] virtual std::string describe() const = 0;
  [[nodiscard]] virtual CaptureCounters counters() const noexcept = 0;
  // Nominal frame rate agreed with the device, 0 while unknown.
  [[nodiscard]] virtual double rate_hz() const noexcept = 0;
};

struct CaptureOptions {
  int width = 0;  // 0: as the camera has it
  int height = 0;
  std::string pixel_format;  // empty: as the camera has it
  double rate_hz = 0;        // 0: as the camera has it
  double exposure_us = 0;    // 0: as the camera has it
  std::string controls;  // V4L2, libcamera: "name=value, …" in the device's own names, before the exposure
  // Aravis: the input that starts each exposure ("Line0"); "any": the first there is, where there is one; "off": none;
  // empty: as the camera has it.
  std::string trigger;
  double trigger_rate_hz = 0;  // of whoever makes the triggers, 0: not known
  bool ptp = false;            // Aravis: let IEEE 1588 keep the camera's clock; false: as the camera has it
  int buffers = 8;
  int packet_size = 9000;  // GigE Vision, bytes; 1400 beyond loopback without jumbo frames
  int socket_buffer_bytes = 8 << 20;
  double speed = 1;   // recording: 1 = as recorded, 0 = as fast as frames are taken (lossless)
  bool loop = false;  // recording
};

// source: aravis:ADDRESS | v4l2:/dev/videoN | libcamera:ID | recording:FILE | simulated:NAME (contract). Fails with usage
// for an unknown kind, naming what is allowed.
Result<std::unique_ptr<CaptureSource>> make_capture_source(const std::string& source,
                                                           const CaptureOptions& options);

}  // namespace lightwell
