// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>

#include "daemon/capture/capture_source.h"

namespace lightwell {

// Why there are no frames, as a state and in words that follow the device's name.
struct CaptureFault {
  SourceState state = SourceState::opening;
  std::string message;
  std::chrono::milliseconds retry{200};  // until the next try: longer where a try costs much
};

// What was agreed with the device, read back from it.
struct SessionSettings {
  std::string name;  // "card (bus)"
  FrameFormat format;
  std::string device_format;  // "Y16"; empty: as format has it
  double rate_hz = 0;         // 0: not known
  double exposure_us = 0;     // 0: not known
  bool free_running = true;   // false: frames come when something triggers them, and silence is no fault
  std::string trigger;        // in words, where frames are triggered
  std::string clock;          // what keeps the device's clock, where it says: "PTP slave"
  std::string remark;         // what a person should know; often empty
};

struct SessionFrame {
  // passed_over: whole, but every buffer is leased, or what was asked for is not in force yet
  enum class Outcome { complete, incomplete, passed_over };
  // What t_stamp_mono_ns is, in CLOCK_MONOTONIC; none: nothing, the device counts by another clock or by none.
  // mapped: the end of the frame, by the device's own clock and what was learnt of it
  enum class Stamp { none, start_of_exposure, end_of_frame, mapped };
  Outcome outcome = Outcome::incomplete;
  std::size_t buffer = 0;  // goes back through CaptureSession::give_back where complete
  std::span<const std::byte> bytes;
  std::uint64_t frame_id = 0;  // for FrameSequence: plain counts are above 16 bit
  Stamp stamp = Stamp::none;
  std::int64_t t_stamp_mono_ns = 0;
  std::int64_t received_mono_ns = 0;
  double exposure_us = 0;                                         // of this frame
  double gain_db = 0;                                             // 0 also where it is not known
  float temperature_c = std::numeric_limits<float>::quiet_NaN();  // NaN where the camera has none
};

// One connection to a device that hands over frames one after another, from opening to its end; WatchedSource makes
// one after another of them. Threading: one thread does everything but give_back, wake and all_returned, which are for
// any thread, and close, which comes last and may be called by another.
class CaptureSession {
 public:
  enum class Event { nothing, frame, source_changed, broken };

  virtual ~CaptureSession() = default;  // after close, and after the last buffer has come back

  // Asks whether the device is there at all, where that costs less than to open it.
  virtual std::optional<CaptureFault> find() { return std::nullopt; }
  // Opens, asks for signal and format, configures, reads back.
  virtual std::optional<CaptureFault> open() = 0;
  // Allocates the buffers and lets frames come.
  virtual std::optional<CaptureFault> start() = 0;
  // The next frame or what happened instead; nothing: the time is over, or wake was called. broken: fault() says why;
  // the session is over.
  virtual Event next(std::chrono::milliseconds timeout, SessionFrame& frame) noexcept = 0;
  [[nodiscard]] virtual CaptureFault fault() const = 0;
  // Asks what no frame tells, without waiting for the device where that may take long. In words why there is no
  // signal; empty: there is one.
  virtual std::string refresh() = 0;
  [[nodiscard]] virtual const SessionSettings& settings() const = 0;

  // Whether set_exposure_us can succeed; from open on, for any thread.
  [[nodiscard]] virtual bool sets_exposure() const { return false; }
  // Another exposure while frames come; settings have what was granted. Frames that were under way may still have the
  // old one. failed: refused by the device, which names its range.
  virtual Status set_exposure_us(double exposure_us);

  virtual void give_back(std::size_t buffer) noexcept = 0;
  virtual void wake() noexcept = 0;
  // Ends the connection; buffers that are out may still come back. A camera that has died answers nothing, and takes
  // seconds.
  virtual void close() noexcept = 0;
  // No buffer is out.
  [[nodiscard]] virtual bool all_returned() const noexcept = 0;
};

// For devices whose triggers their drivers have no standard way to set: a fault where one input was asked for, a remark
// where any would do.
std::optional<CaptureFault> refuse_trigger(const CaptureOptions& options, SessionSettings& settings);

}  // namespace lightwell
