// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// What the messages of interface/lightwell.idl have in common on the wire. Internal to interface/dds_*.
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>

#include "interface/lightwell.h"  // generated from lightwell.idl
#include "interface/probe_messages.h"

namespace lightwell::wire {

// Cuts at the end of a UTF-8 character.
template <std::size_t N>
void set_text(char (&to)[N], std::string_view from) {
  std::size_t size = std::min(from.size(), N - 1);
  if (size < from.size())
    while (size > 0 && (static_cast<unsigned char>(from[size]) & 0xC0) == 0x80) --size;
  std::memcpy(to, from.data(), size);
  std::memset(to + size, 0, N - size);
}

template <std::size_t N>
std::string get_text(const char (&from)[N]) {
  return {from, ::strnlen(from, N)};
}

// Control characters in a name from the network would end up in terminals and logs.
template <std::size_t N>
bool is_printable(const char (&text)[N]) {
  const auto* const end = text + ::strnlen(text, N);
  return std::none_of(text, end, [](char c) { return (static_cast<unsigned char>(c) < 0x20) || c == 0x7f; });
}

inline void set_rgb(float (&to)[3], const Rgb& from) {
  for (int c = 0; c < 3; ++c) to[c] = from[c];
}

inline Rgb get_rgb(const float (&from)[3]) {
  return {from[0], from[1], from[2]};
}

inline bool is_power(const float (&rgb)[3]) {
  return std::all_of(rgb, rgb + 3, [](float v) { return std::isfinite(v) && v >= 0; });
}

inline void header_to_wire(const FrameHeader& header, lightwell_FrameHeader& wire) {
  wire.number = header.number;
  wire.camera_sequence = header.sequence;
  wire.capture_mono_ns = header.capture_mono_ns;
  wire.capture_utc_ns = header.capture_utc_ns;
  wire.publish_mono_ns = header.publish_mono_ns;
  set_text(wire.timecode, header.timecode);
  set_text(wire.calibration_id, header.calibration_id);
  wire.coverage =
      header.coverage == Coverage::sphere ? lightwell_COVERAGE_SPHERE : lightwell_COVERAGE_HEMISPHERE;
  wire.measured_part = header.measured_part;
  set_rgb(wire.total_illuminance, header.total_illuminance);
  wire.delay_frames = header.delay_frames;
}

inline const char* check_header(const lightwell_FrameHeader& wire) {
  if (wire.coverage != lightwell_COVERAGE_SPHERE && wire.coverage != lightwell_COVERAGE_HEMISPHERE)
    return "coverage is neither hemisphere nor sphere";
  if (!(wire.measured_part >= 0 && wire.measured_part <= 1)) return "measured_part is not within 0 to 1";
  if (!is_power(wire.total_illuminance)) return "total_illuminance is not finite and >= 0";
  if (!(std::isfinite(wire.delay_frames) && wire.delay_frames >= 0))
    return "delay_frames is not finite and >= 0";
  if (!is_printable(wire.timecode) || !is_printable(wire.calibration_id))
    return "a name has control characters";
  return nullptr;
}

inline void header_from_wire(const lightwell_FrameHeader& wire, const char (&probe)[64],
                             FrameHeader& header) {
  header.probe = get_text(probe);
  header.number = wire.number;
  header.sequence = wire.camera_sequence;
  header.capture_mono_ns = wire.capture_mono_ns;
  header.capture_utc_ns = wire.capture_utc_ns;
  header.publish_mono_ns = wire.publish_mono_ns;
  header.timecode = get_text(wire.timecode);
  header.calibration_id = get_text(wire.calibration_id);
  header.coverage = wire.coverage == lightwell_COVERAGE_SPHERE ? Coverage::sphere : Coverage::hemisphere;
  header.measured_part = wire.measured_part;
  header.total_illuminance = get_rgb(wire.total_illuminance);
  header.delay_frames = wire.delay_frames;
}

// Power of two that puts the largest magnitude into [2^14, 2^15), well inside the half range (65504).
inline float scale_for(std::span<const float> radiance) {
  float largest = 0;
  for (const float value : radiance) largest = std::max(largest, std::abs(value));
  if (!(largest > 0)) return 1;
  // Not below the smallest normal float, whose inverse must stay finite.
  return std::ldexp(1.0f, std::max(std::ilogb(largest) - 14, -126));
}
// 2^112 × 65504 is still a float.
inline bool is_scale(float scale) {
  return scale > 0 && scale <= std::ldexp(1.0f, 112);
}

// IEEE 754 binary16.
inline std::uint16_t half_of(float value) {
  return Eigen::numext::bit_cast<std::uint16_t>(Eigen::half(value));
}
inline float float_of(std::uint16_t half) {
  return static_cast<float>(Eigen::numext::bit_cast<Eigen::half>(half));
}

}  // namespace lightwell::wire
