// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "interface/recording.h"

namespace lightwell::test {

using Codes = std::vector<std::byte>;

struct TakeFrame {
  RecordedFrame info;
  Codes codes;
};

// Noise within the format's range, as a camera sends it.
inline Codes noise_codes(const FrameFormat& format, std::uint32_t seed) {
  std::mt19937 random(seed);
  Codes codes(format.bytes());
  for (std::byte& byte : codes) byte = static_cast<std::byte>(random() & 0xff);
  const int bits = significant_bits(format.pixel_format);
  if (storage_bits(format.pixel_format) == 16 && bits < 16)
    for (std::size_t i = 1; i < codes.size(); i += 2)
      codes[i] &= static_cast<std::byte>((1 << (bits - 8)) - 1);
  const bool odd = (format.width * format.height) % 2 != 0;
  if (format.pixel_format == PixelFormat::mono12p && odd) codes.back() &= std::byte{0x0f};
  return codes;
}

// Frame i of a take at 60 Hz: noise, and values that tell the frames apart.
inline TakeFrame take_frame(const FrameFormat& format, std::uint32_t i) {
  TakeFrame frame;
  frame.info.sequence = 1000 + i;
  frame.info.capture_mono_ns = 5'000'000'000 + std::int64_t{i} * 16'666'667;
  frame.info.received_mono_ns = frame.info.capture_mono_ns + 2'000'000 + i;
  frame.info.capture_utc_ns = 1'700'000'000'000'000'000 + frame.info.capture_mono_ns;
  frame.info.exposure_us = 1000.0 + i / 3.0;
  frame.info.gain_db = 0.1 * i;
  frame.info.temperature_c = 40.0f + static_cast<float>(i) / 7.0f;
  frame.codes = noise_codes(format, i + 1);
  return frame;
}

inline std::vector<TakeFrame> take_frames(const FrameFormat& format, std::uint32_t count) {
  std::vector<TakeFrame> frames;
  for (std::uint32_t i = 0; i < count; ++i) frames.push_back(take_frame(format, i));
  return frames;
}

inline RecordingHeader take_header(const FrameFormat& format, RecordingCodec codec) {
  return {.format = format,
          .codec = codec,
          .rate_hz = 60,
          .source = "simulated:test",
          .calibration_json = R"({"schema": "test"})",
          .start_utc_ns = 1'700'000'000'123'456'789};
}

// flush_every: a cluster's length in frames, 0: as the writer likes.
inline void write_take(const std::filesystem::path& file, const RecordingHeader& header,
                       const std::vector<TakeFrame>& frames, std::size_t flush_every = 0) {
  auto writer = RecordingWriter::create(file, header);
  ASSERT_TRUE(writer) << writer.error().message;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const Status status = (*writer)->write(frames[i].info, frames[i].codes);
    ASSERT_TRUE(status) << status.error().message;
    if (flush_every != 0 && (i + 1) % flush_every == 0) {
      ASSERT_TRUE((*writer)->flush());
    }
  }
  const Status closed = (*writer)->close();
  ASSERT_TRUE(closed) << closed.error().message;
}

inline bool same_bits(const RecordedFrame& a, const RecordedFrame& b) {
  return a.sequence == b.sequence && a.capture_mono_ns == b.capture_mono_ns &&
         a.received_mono_ns == b.received_mono_ns && a.capture_utc_ns == b.capture_utc_ns &&
         std::bit_cast<std::uint64_t>(a.exposure_us) == std::bit_cast<std::uint64_t>(b.exposure_us) &&
         std::bit_cast<std::uint64_t>(a.gain_db) == std::bit_cast<std::uint64_t>(b.gain_db) &&
         std::bit_cast<std::uint32_t>(a.temperature_c) == std::bit_cast<std::uint32_t>(b.temperature_c) &&
         a.timecode == b.timecode;
}

inline bool same(const TakeFrame& a, const TakeFrame& b) {
  return same_bits(a.info, b.info) && a.codes == b.codes;
}

// Reads up to the end, going on behind damage; `complaints` are what the reader said on the way.
struct ReadTake {
  std::vector<TakeFrame> frames;
  std::size_t before_damage = 0;  // frames before the first complaint
  std::vector<Error> complaints;
};
inline ReadTake read_all(RecordingReader& reader) {
  ReadTake take;
  TakeFrame frame;
  frame.codes.resize(reader.header().format.bytes());
  for (;;) {
    auto next = reader.read(frame.codes);
    if (!next) {
      if (take.complaints.empty()) take.before_damage = take.frames.size();
      take.complaints.push_back(next.error());
      continue;
    }
    if (!*next) break;
    frame.info = **next;
    take.frames.push_back(frame);
  }
  if (take.complaints.empty()) take.before_damage = take.frames.size();
  return take;
}

inline std::string file_bytes(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

inline void write_bytes(const std::filesystem::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

}  // namespace lightwell::test
