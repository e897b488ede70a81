// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <filesystem>
#include <optional>
#include <string>

#include "interface/recording.h"
#include "lighting/result.h"

namespace lightwell::cli {

struct RecordOptions {
  double seconds = 0;
  std::filesystem::path out;
  std::string source;       // empty: through a daemon
  std::string calibration;  // folder; empty: what the source brings along
  std::string daemon = "127.0.0.1:8650";
  std::string tracking;  // opentrackio:ADDRESS:PORT or freed:ADDRESS:PORT; empty: no tracker
  std::optional<int> tracking_camera;
  RecordingCodec codec = RecordingCodec::raw;
  bool json = false;
};

// What became of it; frames == 0 only with an error.
struct Recorded {
  std::filesystem::path file;
  std::uint64_t frames = 0;
  std::uint64_t dropped = 0;  // frames that came and were not written
  std::uint64_t bytes = 0;
  std::uint64_t known_poses = 0;  // of a simulated source's frames, in the pose file beside the take
};

// Both end early, keeping what was recorded, where `interrupted` becomes true. began: the daemon has a take of that name,
// also where this fails later.
Result<Recorded> record_from_source(const RecordOptions& options, const std::atomic<bool>& interrupted);
Result<Recorded> record_through_daemon(const RecordOptions& options, const std::atomic<bool>& interrupted,
                                       bool& began);

}  // namespace lightwell::cli
