// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>

#include "interface/recording.h"

namespace lightwell::calibration {

// The frames of a take, one after the other, for everything here that measures from them. Every error is bad_input and
// names the file.
class TakeFrames {
 public:
  // Not there, not a take, without frames.
  static Result<TakeFrames> open(const std::filesystem::path& file);

  [[nodiscard]] const RecordingHeader& header() const { return reader_->header(); }
  [[nodiscard]] const FrameFormat& format() const { return header().format; }
  [[nodiscard]] std::size_t pixels() const;
  // Each frame from the first on, as often as asked; stops with visit's error, which gets the file's name. A damaged
  // frame is an error: what it held is not known.
  using Visit = std::function<Status(const RecordedFrame& frame, std::span<const std::byte> codes)>;
  Status for_each(const Visit& visit);
  // Code of a pixel, row by row from the top left.
  [[nodiscard]] std::uint32_t code(std::span<const std::byte> codes, std::size_t pixel) const;

 private:
  TakeFrames(std::filesystem::path file, std::unique_ptr<RecordingReader> reader);
  std::filesystem::path file_;
  std::unique_ptr<RecordingReader> reader_;
  bool at_start_ = true;
};

}  // namespace lightwell::calibration
