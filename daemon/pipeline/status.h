// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "daemon/capture/capture_source.h"
#include "daemon/pipeline/fit_worker.h"
#include "daemon/sync/board_view.h"

namespace lightwell {

// What the daemon does now, for people and monitors. A plain copy; made on request, never on the frame path.
struct DaemonStatus {
  std::string version;
  double uptime_s = 0;
  std::string source;  // "aravis:127.0.0.1"
  SourceState source_state = SourceState::no_device;
  std::string source_description;  // one line
  CaptureCounters capture;
  double nominal_rate_hz = 0;
  double measured_rate_hz = 0;  // published frames over the last seconds
  std::uint64_t published = 0;  // frames
  std::uint64_t dropped_by_pipeline = 0;
  // Over the last 1000 frames, milliseconds; NaN before the first.
  double develop_ms_p50 = 0, develop_ms_p99 = 0;  // raw frame to map
  double lights_ms_p50 = 0, lights_ms_p99 = 0;    // map to lights
  double latency_ms_p50 = 0, latency_ms_p99 = 0;  // frame complete in memory to lights published
  double frame_age_ms = 0;                        // since the last published frame's capture
  std::string calibration_id;
  std::string calibration_verdict;  // one line, empty when all is well
  struct Recording {
    bool active = false;
    std::string file;
    std::uint64_t frames = 0;
    std::uint64_t dropped = 0;  // frames the disk was too slow for
    std::uint64_t bytes = 0;
    std::string error;        // why the last recording stopped by itself, else empty
    std::string directory{};  // absolute, where takes are written
  } recording;
  BoardView board;    // the sync board
  std::string alarm;  // the worst thing that is wrong, in words; empty when nothing is
};

// How the web and DDS rooms ask for it, and what they may ask the daemon to do. Callable from any thread.
class DaemonControl {
 public:
  virtual ~DaemonControl() = default;
  [[nodiscard]] virtual DaemonStatus status() const = 0;
  // file: a plain name ("take.mkv"), inside the daemon's record directory; usage for anything else.
  virtual Status start_recording(const std::string& file) = 0;
  virtual Status stop_recording() = 0;
  // The newest frame's ambient and few lights; empty where there is none.
  [[nodiscard]] virtual std::optional<FitSnapshot> newest_fit() const { return std::nullopt; }
};

}  // namespace lightwell
