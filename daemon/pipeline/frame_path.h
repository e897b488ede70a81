// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "daemon/capture/capture_source.h"
#include "daemon/pipeline/latency.h"
#include "daemon/pipeline/snapshot.h"
#include "lighting/calibration.h"
#include "lighting/light_pipeline.h"
#include "lighting/map_harmonics.h"
#include "lighting/radiometer.h"
#include "lighting/result.h"
#include "lighting/temporal/flicker_filter.h"

namespace lightwell {

struct FramePathOptions {
  RadiometerOptions radiometer;
  std::string method = "live";  // what the lights are called: the sampler's name
  // rate_hz is the camera's and set by the frame path; pass_hz = stop_hz = 0 asks for the paper's 7/21 and
  // 9/21 of it.
  LightPipelineOptions lights{.pass_hz = 0, .stop_hz = 0};
  // Of lamps: their swing is taken out of every bin of the map, where the camera's rate is known. 0: left in.
  double flicker_hz = 0;
};

// A raw frame on its way to published lights, in steps that read top to bottom in process():
// codes → radiance map → (without the mains' flicker) → lights → snapshot for everybody else. One thread.
class FramePath {
 public:
  FramePath(Calibration calibration, const FramePathOptions& options, SnapshotChannel& snapshots);

  // An empty snapshot to build the channel from.
  static Snapshot prototype(const FramePathOptions& options);

  // Makes ready for frames of this format and rate (0: unknown). Cheap and free of allocation while nothing
  // changes. Fails (bad_input) where the calibration is not for such frames; the message says what differs.
  [[nodiscard]] bool prepared_for(const FrameFormat& format, double rate_hz) const;
  Status prepare(const FrameFormat& format, double rate_hz);

  // After a good prepare for the frame's format; info.exposure_us > 0. Allocates nothing once every snapshot
  // has the current shape.
  void process(const FrameInfo& info, std::span<const std::byte> codes) noexcept;

  [[nodiscard]] std::uint64_t published() const noexcept {
    return published_.load(std::memory_order_relaxed);
  }
  [[nodiscard]] const LatencyWindow& develop_ms() const noexcept { return develop_ms_; }
  [[nodiscard]] const LatencyWindow& lights_ms() const noexcept { return lights_ms_; }
  [[nodiscard]] const LatencyWindow& latency_ms() const noexcept { return latency_ms_; }
  [[nodiscard]] const Calibration& calibration() const noexcept { return calibration_; }
  // Numbering goes on where another frame path stopped (reload).
  void continue_from(std::uint64_t published) noexcept { published_ = published; }

 private:
  [[nodiscard]] LightPipelineOptions filter_for(double rate_hz) const;
  void forget_after_gap(std::int64_t capture_mono_ns) noexcept;

  Calibration calibration_;
  FramePathOptions options_;
  SnapshotChannel& snapshots_;

  std::optional<Radiometer> radiometer_;
  std::optional<FlickerFilter> flicker_;
  std::optional<LightPipeline> lights_;
  std::optional<MapHarmonics> harmonics_;
  FrameFormat format_;
  double rate_hz_ = 0;
  PolarMap shape_;  // an empty map of the current shape
  std::uint64_t shape_number_ = 0;
  std::int64_t last_capture_mono_ns_ = 0;

  std::atomic<std::uint64_t> published_{0};
  LatencyWindow develop_ms_, lights_ms_, latency_ms_;
};

}  // namespace lightwell
