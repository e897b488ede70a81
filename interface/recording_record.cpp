// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/recording_record.h"

extern "C" {
#include <libavutil/crc.h>
}

#include <bit>
#include <concepts>

namespace lightwell {
namespace {

// Names the layout; another layout gets another name.
constexpr std::uint32_t kMagic = 0x3146574c;  // "LWF1"
constexpr std::uint32_t kVerbatim = 1;
constexpr std::uint32_t kHasTimecode = 2;  // in the flags' upper bytes, which takes of before left 0

template <std::unsigned_integral T>
void put(std::byte*& at, T value) {
  for (std::size_t i = 0; i < sizeof(T); ++i) *at++ = static_cast<std::byte>((value >> (8 * i)) & 0xff);
}

template <std::unsigned_integral T>
T get(const std::byte*& at) {
  T value = 0;
  for (std::size_t i = 0; i < sizeof(T); ++i)
    value = static_cast<T>(value | (static_cast<T>(std::to_integer<std::uint8_t>(*at++)) << (8 * i)));
  return value;
}

std::uint32_t timecode_bits(const std::optional<Timecode>& t) {
  if (!t) return 0;
  return kHasTimecode | static_cast<std::uint32_t>(t->hours & 31U) << 8 |
         static_cast<std::uint32_t>(t->minutes & 63U) << 13 |
         static_cast<std::uint32_t>(t->seconds & 63U) << 19 |
         static_cast<std::uint32_t>(t->frames & 63U) << 25 | (t->drop_frame ? 1U << 31 : 0);
}

std::optional<Timecode> timecode_of(std::uint32_t flags) {
  if ((flags & kHasTimecode) == 0) return std::nullopt;
  const auto field = [&](int at, std::uint32_t mask) {
    return static_cast<std::uint8_t>(flags >> at & mask);
  };
  return Timecode{field(8, 31), field(13, 63), field(19, 63), field(25, 63), flags >> 31 != 0};
}

}  // namespace

std::uint32_t crc32(std::span<const std::byte> bytes) {
  const AVCRC* table = av_crc_get_table(AV_CRC_32_IEEE_LE);
  std::uint32_t crc = 0xffffffff;
  const auto* at = reinterpret_cast<const std::uint8_t*>(bytes.data());
  return ~av_crc(table, crc, at, bytes.size());
}

std::array<std::byte, kFrameRecordBytes> pack_record(const FrameRecord& record) {
  std::array<std::byte, kFrameRecordBytes> bytes{};
  std::byte* at = bytes.data();
  const RecordedFrame& frame = record.frame;
  put(at, kMagic);
  put(at, (record.verbatim ? kVerbatim : 0U) | timecode_bits(frame.timecode));
  put(at, record.index);
  put(at, frame.sequence);
  put(at, static_cast<std::uint64_t>(frame.capture_mono_ns));
  put(at, static_cast<std::uint64_t>(frame.received_mono_ns));
  put(at, static_cast<std::uint64_t>(frame.capture_utc_ns));
  put(at, std::bit_cast<std::uint64_t>(frame.exposure_us));
  put(at, std::bit_cast<std::uint64_t>(frame.gain_db));
  put(at, std::bit_cast<std::uint32_t>(frame.temperature_c));
  put(at, record.codes_crc32);
  put(at, crc32({bytes.data(), kFrameRecordBytes - 4}));
  return bytes;
}

std::optional<FrameRecord> unpack_record(std::span<const std::byte> bytes) {
  if (bytes.size() < kFrameRecordBytes) return std::nullopt;
  const std::byte* at = bytes.data();
  if (get<std::uint32_t>(at) != kMagic) return std::nullopt;
  FrameRecord record;
  const auto flags = get<std::uint32_t>(at);
  record.verbatim = (flags & kVerbatim) != 0;
  record.frame.timecode = timecode_of(flags);
  record.index = get<std::uint64_t>(at);
  RecordedFrame& frame = record.frame;
  frame.sequence = get<std::uint64_t>(at);
  frame.capture_mono_ns = static_cast<std::int64_t>(get<std::uint64_t>(at));
  frame.received_mono_ns = static_cast<std::int64_t>(get<std::uint64_t>(at));
  frame.capture_utc_ns = static_cast<std::int64_t>(get<std::uint64_t>(at));
  frame.exposure_us = std::bit_cast<double>(get<std::uint64_t>(at));
  frame.gain_db = std::bit_cast<double>(get<std::uint64_t>(at));
  frame.temperature_c = std::bit_cast<float>(get<std::uint32_t>(at));
  record.codes_crc32 = get<std::uint32_t>(at);
  if (get<std::uint32_t>(at) != crc32(bytes.first(kFrameRecordBytes - 4))) return std::nullopt;
  return record;
}

}  // namespace lightwell
