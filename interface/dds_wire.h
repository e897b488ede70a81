// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// Between the messages of probe_messages.h and the C types that idlc makes of lightwell.idl. Internal to
// interface/dds_*.
#include <string>
#include <vector>

#include "interface/lightwell.h"  // generated from lightwell.idl
#include "interface/probe_messages.h"

namespace lightwell {

// What a topic is on the wire: its C type, description, name, where its sequences stand while it is sent, and whether
// lost messages are repaired and the newest is kept for late joiners.
template <class Message>
struct Wire;
template <>
struct Wire<LightFrame> {
  using Type = lightwell_LightFrame;
  struct Buffer {
    std::vector<lightwell_Light> lights;
    std::vector<float> harmonics;
  };
  static const dds_topic_descriptor_t& descriptor() { return lightwell_LightFrame_desc; }
  static constexpr const char* kTopic = "lightwell/LightFrame";
  static constexpr bool kReliable = false;
};
template <>
struct Wire<FitFrame> {
  using Type = lightwell_FitFrame;
  using Buffer = std::vector<lightwell_FittedLight>;
  static const dds_topic_descriptor_t& descriptor() { return lightwell_FitFrame_desc; }
  static constexpr const char* kTopic = "lightwell/FitFrame";
  static constexpr bool kReliable = true;
};
template <>
struct Wire<EnvironmentFrame> {
  using Type = lightwell_EnvironmentFrame;
  using Buffer = std::vector<std::uint16_t>;
  static const dds_topic_descriptor_t& descriptor() { return lightwell_EnvironmentFrame_desc; }
  static constexpr const char* kTopic = "lightwell/EnvironmentFrame";
  static constexpr bool kReliable = true;
};
template <>
struct Wire<FieldFrame> {
  using Type = lightwell_FieldFrame;
  struct Buffer {
    std::vector<std::uint16_t> radiance;
    std::vector<std::uint8_t> confidence;
    std::vector<lightwell_FieldProbe> probes;
    std::vector<lightwell_FieldLamp> lamps;
  };
  static const dds_topic_descriptor_t& descriptor() { return lightwell_FieldFrame_desc; }
  static constexpr const char* kTopic = "lightwell/FieldFrame";
  static constexpr bool kReliable = true;
};
template <>
struct Wire<ProbeStatus> {
  using Type = lightwell_ProbeStatus;
  struct Buffer {};
  static const dds_topic_descriptor_t& descriptor() { return lightwell_ProbeStatus_desc; }
  static constexpr const char* kTopic = "lightwell/ProbeStatus";
  static constexpr bool kReliable = true;
};

inline constexpr std::size_t kMaxWireLights = 131072;
inline constexpr std::size_t kMaxWireFittedLights = 16;
inline constexpr std::size_t kWireHarmonics = 25;
inline constexpr std::size_t kMaxWireHalves = 12582912;
inline constexpr std::uint32_t kMaxRings = 4096;
inline constexpr std::uint32_t kMaxSectors = 8192;
inline constexpr std::size_t kMaxWireFieldHalves = 25165824;
inline constexpr std::size_t kMaxWireFieldPoints = 262144;
inline constexpr std::size_t kMaxWireFieldParts = 64;  // probes, and lamps

// Fills `wire` from a message; the sequences point into `buffer`, which must live as long. The probe's name
// is the writer's business. Empty string: good; else what does not fit.
std::string to_wire(const LightFrame& message, lightwell_LightFrame& wire, Wire<LightFrame>::Buffer& buffer);
std::string to_wire(const FitFrame& message, lightwell_FitFrame& wire, Wire<FitFrame>::Buffer& buffer);
std::string to_wire(const EnvironmentFrame& message, lightwell_EnvironmentFrame& wire,
                    Wire<EnvironmentFrame>::Buffer& buffer);
std::string to_wire(const FieldFrame& message, lightwell_FieldFrame& wire, Wire<FieldFrame>::Buffer& buffer);
std::string to_wire(const ProbeStatus& message, lightwell_ProbeStatus& wire,
                    Wire<ProbeStatus>::Buffer& buffer);

// Checks first, then fills. Empty string: good; else what is wrong, and the message is unchanged.
std::string from_wire(const lightwell_LightFrame& wire, LightFrame& message);
std::string from_wire(const lightwell_FitFrame& wire, FitFrame& message);
std::string from_wire(const lightwell_EnvironmentFrame& wire, EnvironmentFrame& message);
std::string from_wire(const lightwell_FieldFrame& wire, FieldFrame& message);
std::string from_wire(const lightwell_ProbeStatus& wire, ProbeStatus& message);

}  // namespace lightwell
