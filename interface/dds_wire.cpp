// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/dds_wire.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <span>

#include "interface/dds_wire_parts.h"

namespace lightwell {

using namespace wire;

namespace {

float squared_norm(const float (&v)[3]) {
  return v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
}

std::string check_light(const lightwell_Light& light, std::size_t index, bool has_parents) {
  const auto wrong = [&](const char* what) { return "light " + std::to_string(index) + ": " + what; };
  // 1e-3 of the length is 2e-3 of its square; NaN fails too.
  if (!(std::abs(squared_norm(light.direction) - 1) <= 2e-3f)) return wrong("direction is not unit");
  if (!is_power(light.illuminance)) return wrong("illuminance is not finite and >= 0");
  const auto earlier = static_cast<std::int64_t>(index);
  const bool rooted = index == 0 ? light.parent == -1 : light.parent >= 0 && light.parent < earlier;
  if (has_parents && !rooted) return wrong("parent is not an earlier light");
  if (!(std::isfinite(light.predicted_error) && light.predicted_error >= 0))
    return wrong("predicted_error is not finite and >= 0");
  if (!(light.angular_radius_rad >= 0 && light.angular_radius_rad <= static_cast<float>(kPi)))
    return wrong("angular_radius_rad is outside 0 to pi");
  return {};
}

}  // namespace

LightSet LightFrame::light_set() const {
  LightSet set;
  set.method = "live";
  set.coverage = header.coverage;
  set.total_illuminance = header.total_illuminance;
  set.lights = lights;
  set.has_parents = has_parents;
  set.ambient = ambient;
  return set;
}

std::string to_wire(const LightFrame& message, lightwell_LightFrame& wire, Wire<LightFrame>::Buffer& whole) {
  if (message.lights.size() > kMaxWireLights)
    return std::to_string(message.lights.size()) + " lights, at most " + std::to_string(kMaxWireLights);
  header_to_wire(message.header, wire.header);
  wire.has_parents = message.has_parents;
  set_rgb(wire.ambient, message.ambient);
  if (!message.harmonics.empty() && message.harmonics.size() != kWireHarmonics)
    return std::to_string(message.harmonics.size()) + " harmonics, must be 25 or none";
  whole.harmonics.resize(3 * message.harmonics.size());
  for (std::size_t i = 0; i < whole.harmonics.size(); ++i)
    whole.harmonics[i] = message.harmonics[i / 3][static_cast<Eigen::Index>(i % 3)];
  const auto numbers = static_cast<std::uint32_t>(whole.harmonics.size());
  wire.harmonics = {numbers, numbers, whole.harmonics.data(), false};
  std::vector<lightwell_Light>& buffer = whole.lights;
  buffer.resize(message.lights.size());
  for (std::size_t i = 0; i < buffer.size(); ++i) {
    const DirectionalLight& light = message.lights[i];
    for (int c = 0; c < 3; ++c) buffer[i].direction[c] = light.direction[c];
    set_rgb(buffer[i].illuminance, light.illuminance);
    buffer[i].id = light.id;
    buffer[i].parent = light.parent;
    buffer[i].predicted_error = light.predicted_error;
    buffer[i].angular_radius_rad = light.angular_radius_rad;
  }
  const auto count = static_cast<std::uint32_t>(buffer.size());
  wire.lights = {count, count, buffer.data(), false};
  return {};
}

std::string from_wire(const lightwell_LightFrame& wire, LightFrame& message) {
  if (const char* wrong = check_header(wire.header)) return wrong;
  if (!is_power(wire.ambient)) return "ambient is not finite and >= 0";
  if (wire.lights._length > kMaxWireLights) return "too many lights";
  const std::span lights(wire.lights._buffer, wire.lights._length);
  for (std::size_t i = 0; i < lights.size(); ++i)
    if (auto wrong = check_light(lights[i], i, wire.has_parents); !wrong.empty()) return wrong;
  const std::span harmonics(wire.harmonics._buffer, wire.harmonics._length);
  if (!harmonics.empty() && harmonics.size() != 3 * kWireHarmonics)
    return "harmonics are neither 75 nor none";
  if (!std::all_of(harmonics.begin(), harmonics.end(), [](float v) { return std::isfinite(v); }))
    return "harmonics are not finite";

  header_from_wire(wire.header, wire.probe, message.header);
  message.has_parents = wire.has_parents;
  message.ambient = get_rgb(wire.ambient);
  message.lights.resize(lights.size());
  for (std::size_t i = 0; i < lights.size(); ++i) {
    DirectionalLight& light = message.lights[i];
    light.direction = {lights[i].direction[0], lights[i].direction[1], lights[i].direction[2]};
    // Beyond float rounding of a unit vector; within it the numbers stay as they were sent.
    if (std::abs(squared_norm(lights[i].direction) - 1) > 1e-6f) light.direction.normalize();
    light.illuminance = get_rgb(lights[i].illuminance);
    light.id = lights[i].id;
    light.parent = wire.has_parents ? lights[i].parent : -1;
    light.predicted_error = lights[i].predicted_error;
    light.angular_radius_rad = lights[i].angular_radius_rad;
  }
  message.harmonics.resize(harmonics.size() / 3);
  for (std::size_t i = 0; i < harmonics.size(); ++i)
    message.harmonics[i / 3][static_cast<Eigen::Index>(i % 3)] = harmonics[i];
  return {};
}

LightSet FitFrame::light_set() const {
  LightSet set;
  set.method = "fit";
  set.coverage = header.coverage;
  set.total_illuminance = header.total_illuminance;
  set.ambient = ambient;
  for (const Light& light : lights) set.lights.push_back(light.light);
  return set;
}

std::string to_wire(const FitFrame& message, lightwell_FitFrame& wire,
                    std::vector<lightwell_FittedLight>& buffer) {
  if (message.lights.size() > kMaxWireFittedLights)
    return std::to_string(message.lights.size()) + " lights, at most " + std::to_string(kMaxWireFittedLights);
  header_to_wire(message.header, wire.header);
  set_rgb(wire.ambient, message.ambient);
  wire.residual = message.residual;
  set_text(wire.remarks, message.remarks);
  buffer.resize(message.lights.size());
  for (std::size_t i = 0; i < buffer.size(); ++i) {
    const FitFrame::Light& light = message.lights[i];
    for (int c = 0; c < 3; ++c) buffer[i].direction[c] = light.light.direction[c];
    set_rgb(buffer[i].illuminance, light.light.illuminance);
    buffer[i].id = light.light.id;
    buffer[i].direction_sigma_rad = light.direction_sigma_rad;
  }
  const auto count = static_cast<std::uint32_t>(buffer.size());
  wire.lights = {count, count, buffer.data(), false};
  return {};
}

std::string from_wire(const lightwell_FitFrame& wire, FitFrame& message) {
  if (const char* wrong = check_header(wire.header)) return wrong;
  if (!is_power(wire.ambient)) return "ambient is not finite and >= 0";
  if (!(std::isfinite(wire.residual) && wire.residual >= 0)) return "residual is not finite and >= 0";
  if (!is_printable(wire.remarks)) return "remarks have control characters";
  if (wire.lights._length > kMaxWireFittedLights) return "too many lights";
  const std::span lights(wire.lights._buffer, wire.lights._length);
  for (std::size_t i = 0; i < lights.size(); ++i) {
    const auto wrong = [&](const char* what) { return "light " + std::to_string(i) + ": " + what; };
    if (!(std::abs(squared_norm(lights[i].direction) - 1) <= 2e-3f)) return wrong("direction is not unit");
    if (!is_power(lights[i].illuminance)) return wrong("illuminance is not finite and >= 0");
    if (!(lights[i].direction_sigma_rad >= 0)) return wrong("direction_sigma_rad is not >= 0");
  }

  header_from_wire(wire.header, wire.probe, message.header);
  message.ambient = get_rgb(wire.ambient);
  message.residual = wire.residual;
  message.remarks = get_text(wire.remarks);
  message.lights.resize(lights.size());
  for (std::size_t i = 0; i < lights.size(); ++i) {
    DirectionalLight& light = message.lights[i].light;
    light.direction = {lights[i].direction[0], lights[i].direction[1], lights[i].direction[2]};
    if (std::abs(squared_norm(lights[i].direction) - 1) > 1e-6f) light.direction.normalize();
    light.illuminance = get_rgb(lights[i].illuminance);
    light.id = lights[i].id;
    message.lights[i].direction_sigma_rad = lights[i].direction_sigma_rad;
  }
  return {};
}

std::string to_wire(const EnvironmentFrame& message, lightwell_EnvironmentFrame& wire,
                    std::vector<std::uint16_t>& buffer) {
  const PolarMap& map = message.map;
  const PolarGrid& grid = map.grid;
  if (grid.rings < 1 || grid.rings > static_cast<int>(kMaxRings) || grid.sectors < 1 ||
      grid.sectors > static_cast<int>(kMaxSectors) || (map.channels != 1 && map.channels != 3) ||
      map.radiance.size() != grid.size() * static_cast<std::size_t>(map.channels) ||
      map.radiance.size() > kMaxWireHalves)
    return "map of " + std::to_string(grid.rings) + " x " + std::to_string(grid.sectors) + " x " +
           std::to_string(map.channels) + " does not fit";
  header_to_wire(message.header, wire.header);
  wire.rings = static_cast<std::uint32_t>(grid.rings);
  wire.sectors = static_cast<std::uint32_t>(grid.sectors);
  wire.channels = static_cast<std::uint32_t>(map.channels);
  wire.theta_max_rad = static_cast<float>(grid.theta_max_rad);
  wire.scale = scale_for(map.radiance);
  const float inverse = 1 / wire.scale;
  buffer.resize(map.radiance.size());
  for (std::size_t i = 0; i < buffer.size(); ++i) buffer[i] = half_of(map.radiance[i] * inverse);
  const auto count = static_cast<std::uint32_t>(buffer.size());
  wire.half_radiance = {count, count, buffer.data(), false};
  return {};
}

std::string from_wire(const lightwell_EnvironmentFrame& wire, EnvironmentFrame& message) {
  if (const char* wrong = check_header(wire.header)) return wrong;
  if (wire.rings < 1 || wire.rings > kMaxRings)
    return "rings are not within 1 to " + std::to_string(kMaxRings);
  if (wire.sectors < 1 || wire.sectors > kMaxSectors)
    return "sectors are not within 1 to " + std::to_string(kMaxSectors);
  if (wire.channels != 1 && wire.channels != 3) return "channels are neither 1 nor 3";
  const std::span halves(wire.half_radiance._buffer, wire.half_radiance._length);
  if (halves.size() != std::size_t{wire.rings} * wire.sectors * wire.channels)
    return "radiance is not the grid's size";
  // A float just above pi is pi.
  if (!(wire.theta_max_rad > 0 && wire.theta_max_rad <= static_cast<float>(kPi)))
    return "theta_max_rad is not within 0 to pi";
  if (!is_scale(wire.scale)) return "scale is not positive and finite";
  // Sign bit, or all exponent bits: negative, infinite, NaN.
  if (std::any_of(halves.begin(), halves.end(),
                  [](std::uint16_t h) { return (h & 0x8000) != 0 || (h & 0x7c00) == 0x7c00; }))
    return "radiance is not finite and >= 0";

  header_from_wire(wire.header, wire.probe, message.header);
  const PolarGrid grid{static_cast<int>(wire.rings), static_cast<int>(wire.sectors),
                       std::min(static_cast<double>(wire.theta_max_rad), kPi)};
  const int channels = static_cast<int>(wire.channels);
  if (message.map.grid != grid || message.map.channels != channels ||
      message.map.radiance.size() != halves.size())
    message.map = PolarMap::make(grid, channels);
  for (std::size_t i = 0; i < halves.size(); ++i) message.map.radiance[i] = float_of(halves[i]) * wire.scale;
  message.map.peak = message.map.radiance;
  message.map.coverage = wire.header.measured_part;
  return {};
}

std::string to_wire(const ProbeStatus& message, lightwell_ProbeStatus& wire, Wire<ProbeStatus>::Buffer&) {
  set_text(wire.version, message.version);
  wire.uptime_s = message.uptime_s;
  set_text(wire.source, message.source);
  set_text(wire.source_state, message.source_state);
  set_text(wire.source_description, message.source_description);
  wire.nominal_rate_hz = message.nominal_rate_hz;
  wire.measured_rate_hz = message.measured_rate_hz;
  wire.published = message.published;
  wire.received = message.received;
  wire.skipped = message.skipped;
  wire.lost = message.lost;
  wire.incomplete = message.incomplete;
  wire.reconnects = message.reconnects;
  wire.dropped_by_pipeline = message.dropped_by_pipeline;
  wire.latency_ms_p50 = message.latency_ms_p50;
  wire.latency_ms_p99 = message.latency_ms_p99;
  wire.frame_age_ms = message.frame_age_ms;
  set_text(wire.calibration_id, message.calibration_id);
  set_text(wire.calibration_verdict, message.calibration_verdict);
  wire.recording = message.recording;
  set_text(wire.recording_file, message.recording_file);
  wire.recording_frames = message.recording_frames;
  wire.recording_dropped = message.recording_dropped;
  set_text(wire.alarm, message.alarm);
  return {};
}

std::string from_wire(const lightwell_ProbeStatus& wire, ProbeStatus& message) {
  if (!is_printable(wire.version) || !is_printable(wire.source) || !is_printable(wire.source_state) ||
      !is_printable(wire.source_description) || !is_printable(wire.calibration_id) ||
      !is_printable(wire.calibration_verdict) || !is_printable(wire.recording_file) ||
      !is_printable(wire.alarm))
    return "a text has control characters";
  message.probe = get_text(wire.probe);
  message.version = get_text(wire.version);
  message.uptime_s = wire.uptime_s;
  message.source = get_text(wire.source);
  message.source_state = get_text(wire.source_state);
  message.source_description = get_text(wire.source_description);
  message.nominal_rate_hz = wire.nominal_rate_hz;
  message.measured_rate_hz = wire.measured_rate_hz;
  message.published = wire.published;
  message.received = wire.received;
  message.skipped = wire.skipped;
  message.lost = wire.lost;
  message.incomplete = wire.incomplete;
  message.reconnects = wire.reconnects;
  message.dropped_by_pipeline = wire.dropped_by_pipeline;
  message.latency_ms_p50 = wire.latency_ms_p50;
  message.latency_ms_p99 = wire.latency_ms_p99;
  message.frame_age_ms = wire.frame_age_ms;
  message.calibration_id = get_text(wire.calibration_id);
  message.calibration_verdict = get_text(wire.calibration_verdict);
  message.recording = wire.recording;
  message.recording_file = get_text(wire.recording_file);
  message.recording_frames = wire.recording_frames;
  message.recording_dropped = wire.recording_dropped;
  message.alarm = get_text(wire.alarm);
  return {};
}

}  // namespace lightwell
