// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>

#include "daemon/pipeline/snapshot.h"
#include "lighting/fit/few_lights.h"

namespace lightwell {

// A frame's map as ambient and few lights: the daemon's second output.
struct FitSnapshot {
  std::uint64_t number = 0;  // of the frame, as are the next four
  std::uint64_t sequence = 0;
  std::int64_t capture_mono_ns = 0;
  std::int64_t capture_utc_ns = 0;
  std::array<char, 17> calibration_id{};
  float measured_part = 0;
  std::int64_t publish_mono_ns = 0;  // the fit was ready
  FewLightsFit fit;
};

// Fits the newest frame, again and again, on a thread of its own: a fit takes half a millisecond as a rule and several
// where the scene is cut, too much for the frame path. It leaves frames out where it cannot keep up. Holds one lease.
class FitWorker {
 public:
  using Listener = std::function<void(const FitSnapshot&)>;

  // snapshots outlives it. options empty: nothing is fitted. listener is called on the worker's thread after every fit.
  FitWorker(SnapshotChannel& snapshots, std::optional<FewLightsOptions> options, Listener listener);
  ~FitWorker();  // within 0.2 s
  FitWorker(const FitWorker&) = delete;
  FitWorker& operator=(const FitWorker&) = delete;

  // The newest frame is fitted again; options valid for FewLights::create.
  void set_options(std::optional<FewLightsOptions> options);
  // Empty before the first fit, and while nothing is fitted.
  [[nodiscard]] std::optional<FitSnapshot> newest() const;

 private:
  void run();
  void fit(const Snapshot& snapshot, const FewLightsOptions& options);

  SnapshotChannel& snapshots_;
  Listener listener_;
  mutable std::mutex mutex_;  // guards the three below
  std::optional<FewLightsOptions> options_;
  bool options_changed_ = false;
  std::optional<FitSnapshot> newest_;
  std::atomic<bool> stopping_{false};

  // The thread's own.
  std::optional<FewLights> fitter_;
  PolarGrid grid_;
  FitSnapshot made_;

  std::thread thread_;  // last: starts when all else is there
};

}  // namespace lightwell
