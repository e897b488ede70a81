// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "interface/timecode.h"
#include "lighting/frame_format.h"
#include "lighting/result.h"

namespace lightwell {

// A take: raw frames, losslessly, in Matroska, with what is known of each frame and the calibration attached.
// Layout of the file: docs/conventions.md.

// raw costs time in proportion to memcpy; FFV1 makes a third of it, at up to a core for 12 bit, 640×480 and 60 Hz.
enum class RecordingCodec { raw, ffv1 };
std::string_view name(RecordingCodec codec);  // "raw", "ffv1"
std::optional<RecordingCodec> recording_codec_from_name(std::string_view name);

struct RecordingHeader {
  FrameFormat format;
  RecordingCodec codec = RecordingCodec::raw;
  double rate_hz = 0;            // 0: unknown
  std::string source;            // "aravis:127.0.0.1", for people
  std::string calibration_json;  // calibration_to_json; empty: none attached
  std::int64_t start_utc_ns = 0;
};

// What is stored beside a frame's codes; read back bit for bit.
struct RecordedFrame {
  std::uint64_t sequence = 0;
  std::int64_t capture_mono_ns = 0;
  std::int64_t received_mono_ns = 0;
  std::int64_t capture_utc_ns = 0;
  double exposure_us = 0;
  double gain_db = 0;
  float temperature_c = 0;  // NaN: none
  std::optional<Timecode> timecode{};
};

// One thread at a time.
class RecordingWriter {
 public:
  // Refuses to overwrite; failed: folder missing, no space, no permission; usage: a size beyond 1…16384.
  static Result<std::unique_ptr<RecordingWriter>> create(const std::filesystem::path& file,
                                                         const RecordingHeader& header);
  virtual ~RecordingWriter() =
      default;  // closes; a take without a proper end stays readable to its last whole cluster
  // codes: format.bytes() of them. Written to disk at least twice a second while frames come. After a failure
  // (disk full) the file is closed, readable to its last whole cluster, and every further call fails the same
  // way.
  virtual Status write(const RecordedFrame& frame, std::span<const std::byte> codes) = 0;
  // Writes what is still in memory: for a caller who knows that frames pause.
  virtual Status flush() = 0;
  // Removes a take without frames, which nothing could read, and fails saying so.
  virtual Status close() = 0;
  [[nodiscard]] virtual std::uint64_t frames() const = 0;
  [[nodiscard]] virtual std::uint64_t bytes() const = 0;
};

// One thread at a time.
class RecordingReader {
 public:
  // bad_input: missing, a directory, not Matroska, not one of our takes, no frames, header damaged.
  static Result<std::unique_ptr<RecordingReader>> open(const std::filesystem::path& file);
  virtual ~RecordingReader() = default;
  [[nodiscard]] virtual const RecordingHeader& header() const = 0;
  // The next frame's codes into `codes` (format.bytes()); nullopt at the end; bad_input where the file is cut
  // or damaged (frames before it have been delivered). A further call goes on behind the damage. Every
  // frame's codes are checked against their checksum.
  virtual Result<std::optional<RecordedFrame>> read(std::span<std::byte> codes) = 0;
  // As read, without decoding and checking the codes.
  virtual Result<std::optional<RecordedFrame>> skip() = 0;
  virtual Status rewind() = 0;
  // Number of frames by the file's index, or by counting where it has none.
  virtual Result<std::uint64_t> frame_count() = 0;
  // False: the file has no proper end (it was cut); `lightwell repair` mends it.
  [[nodiscard]] virtual bool complete() const = 0;
};

struct RepairReport {
  std::uint64_t recovered = 0;    // whole frames, bit for bit
  std::uint64_t damaged = 0;      // frames known to have been there that are not whole
  bool calibration_lost = false;  // the attachment was there and is damaged; it is left out
};
// Copies every whole frame of a cut or damaged take into a new, complete one; the input is only read.
// bad_input: not one of our takes, or no whole frame in it; failed: as RecordingWriter::create.
// progress, where given, is told the share of the input that is done.
Result<RepairReport> repair_recording(const std::filesystem::path& broken, const std::filesystem::path& out,
                                      const std::function<void(double)>& progress = {});

}  // namespace lightwell
