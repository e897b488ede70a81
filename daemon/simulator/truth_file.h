// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

#include "daemon/simulator/prepared_frames.h"
#include "lighting/result.h"

namespace lightwell::simulator {

// One JSON line for a frame that left the camera, without the line's end:
// frame, frame_id, time_ns, exposure_us, total_illuminance, lights [{direction, illuminance}], and position_m
// where the probe moves.
std::string truth_line(const SentFrame& frame);

// What every frame showed, a line a frame, flushed line by line so that a reader can follow.
class TruthFile {
 public:
  // Replaces a file that is there. failed: cannot be written.
  static Result<TruthFile> create(const std::filesystem::path& file);
  Status write(const SentFrame& frame);

 private:
  struct Close {
    void operator()(std::FILE* f) const { std::fclose(f); }
  };
  TruthFile(std::filesystem::path file, std::FILE* stream) : file_(std::move(file)), stream_(stream) {}
  std::filesystem::path file_;
  std::unique_ptr<std::FILE, Close> stream_;
};

}  // namespace lightwell::simulator
