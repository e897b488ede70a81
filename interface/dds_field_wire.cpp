// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// FieldFrame of interface/lightwell.idl.
#include <cmath>

#include "interface/dds_wire.h"
#include "interface/dds_wire_parts.h"

namespace lightwell {

using namespace wire;

namespace {

// No stage is larger.
constexpr float kMostMetres = 1e6f;

void set_vector(float (&to)[3], const Vec3d& from) {
  for (int a = 0; a < 3; ++a) to[a] = static_cast<float>(from[a]);
}

Vec3d get_vector(const float (&from)[3]) {
  return Vec3f(from[0], from[1], from[2]).cast<double>();
}

bool is_place(const float (&v)[3]) {
  return std::all_of(v, v + 3, [](float value) { return std::abs(value) <= kMostMetres; });
}

bool is_part(float value) {
  return value >= 0 && value <= 1;
}

std::string check_grid(const lightwell_FieldFrame& wire) {
  std::size_t points = 1;
  for (int a = 0; a < 3; ++a) {
    if (wire.size[a] < 2 || wire.size[a] > kMaxWireFieldPoints)
      return "size is not 2 or more along each axis";
    points *= wire.size[a];
    if (points > kMaxWireFieldPoints)
      return "size is above " + std::to_string(kMaxWireFieldPoints) + " points";
  }
  if (!is_place(wire.low) || !is_place(wire.high)) return "bounds are not finite";
  for (int a = 0; a < 3; ++a)
    if (!(wire.low[a] < wire.high[a])) return "low is not below high";
  if (wire.degree < 1 || wire.degree > static_cast<std::uint32_t>(kMostFieldDegree))
    return "degree is not within 1 to " + std::to_string(kMostFieldDegree);
  const auto numbers = static_cast<std::size_t>(3 * harmonic_count(static_cast<int>(wire.degree)));
  if (wire.half_radiance._length != points * numbers) return "radiance is not the grid's size";
  if (wire.confidence._length != points) return "confidence is not the grid's size";
  return {};
}

std::string check_parts(const lightwell_FieldFrame& wire) {
  if (wire.probes._length > kMaxWireFieldParts || wire.lamps._length > kMaxWireFieldParts)
    return "more than " + std::to_string(kMaxWireFieldParts) + " probes or lamps";
  for (const lightwell_FieldProbe& probe : std::span(wire.probes._buffer, wire.probes._length)) {
    if (!is_printable(probe.probe)) return "a probe's name has control characters";
    if (!is_place(probe.position)) return "a probe's position is not finite";
    if (!(std::isfinite(probe.age_s) && probe.age_s >= 0)) return "a probe's age_s is not finite and >= 0";
    if (!is_part(probe.weight)) return "a probe's weight is not within 0 to 1";
  }
  for (const lightwell_FieldLamp& lamp : std::span(wire.lamps._buffer, wire.lamps._length)) {
    if (!is_place(lamp.position)) return "a lamp's position is not finite";
    if (!(std::isfinite(lamp.sigma_m) && lamp.sigma_m >= 0)) return "a lamp's sigma_m is not finite and >= 0";
    if (!is_power(lamp.intensity)) return "a lamp's intensity is not finite and >= 0";
    if (!is_part(lamp.weight)) return "a lamp's weight is not within 0 to 1";
  }
  return {};
}

template <class Sequence, class T>
void lend(std::vector<T>& from, Sequence& to) {
  const auto count = static_cast<std::uint32_t>(from.size());
  to = {count, count, from.data(), false};
}

}  // namespace

std::string to_wire(const FieldFrame& message, lightwell_FieldFrame& wire, Wire<FieldFrame>::Buffer& buffer) {
  const LightField& field = message.field;
  const std::size_t points = field.grid.points();
  if (points > kMaxWireFieldPoints || field.radiance.size() > kMaxWireFieldHalves)
    return std::to_string(points) + " points of degree " + std::to_string(field.degree) + ", at most " +
           std::to_string(kMaxWireFieldPoints) + " points and " + std::to_string(kMaxWireFieldHalves) +
           " numbers";
  if (field.radiance.size() != points * static_cast<std::size_t>(3 * field.harmonics()) ||
      field.confidence.size() != points)
    return "a field whose numbers are not those of its grid";
  if (message.probes.size() > kMaxWireFieldParts || message.lamps.size() > kMaxWireFieldParts)
    return "more than " + std::to_string(kMaxWireFieldParts) + " probes or lamps";
  header_to_wire(message.header, wire.header);
  for (std::size_t a = 0; a < 3; ++a) wire.size[a] = static_cast<std::uint32_t>(field.grid.size[a]);
  set_vector(wire.low, field.grid.low);
  set_vector(wire.high, field.grid.high);
  wire.degree = static_cast<std::uint32_t>(field.degree);
  wire.scale = scale_for(field.radiance);
  const float inverse = 1 / wire.scale;
  buffer.radiance.resize(field.radiance.size());
  for (std::size_t i = 0; i < field.radiance.size(); ++i)
    buffer.radiance[i] = half_of(field.radiance[i] * inverse);
  lend(buffer.radiance, wire.half_radiance);
  buffer.confidence.resize(points);
  for (std::size_t i = 0; i < points; ++i)
    buffer.confidence[i] =
        static_cast<std::uint8_t>(std::lround(255 * std::clamp(field.confidence[i], 0.0f, 1.0f)));
  lend(buffer.confidence, wire.confidence);
  buffer.probes.resize(message.probes.size());
  for (std::size_t i = 0; i < message.probes.size(); ++i) {
    const FieldFrame::Probe& probe = message.probes[i];
    set_text(buffer.probes[i].probe, probe.name);
    set_vector(buffer.probes[i].position, probe.position);
    buffer.probes[i].number = probe.number;
    buffer.probes[i].age_s = probe.age_s;
    buffer.probes[i].weight = probe.weight;
  }
  lend(buffer.probes, wire.probes);
  buffer.lamps.resize(message.lamps.size());
  for (std::size_t i = 0; i < message.lamps.size(); ++i) {
    const FieldFrame::Lamp& lamp = message.lamps[i];
    buffer.lamps[i].id = lamp.id;
    set_vector(buffer.lamps[i].position, lamp.position);
    buffer.lamps[i].sigma_m = lamp.sigma_m;
    set_rgb(buffer.lamps[i].intensity, lamp.intensity);
    buffer.lamps[i].weight = lamp.weight;
  }
  lend(buffer.lamps, wire.lamps);
  return {};
}

std::string from_wire(const lightwell_FieldFrame& wire, FieldFrame& message) {
  if (const char* wrong = check_header(wire.header)) return wrong;
  if (std::string wrong = check_grid(wire); !wrong.empty()) return wrong;
  if (!is_scale(wire.scale)) return "scale is not positive and finite";
  const std::span halves(wire.half_radiance._buffer, wire.half_radiance._length);
  if (std::any_of(halves.begin(), halves.end(), [](std::uint16_t h) { return (h & 0x7c00) == 0x7c00; }))
    return "radiance is not finite";
  if (std::string wrong = check_parts(wire); !wrong.empty()) return wrong;

  header_from_wire(wire.header, wire.probe, message.header);
  LightField& field = message.field;
  for (std::size_t a = 0; a < 3; ++a) field.grid.size[a] = static_cast<int>(wire.size[a]);
  field.grid.low = get_vector(wire.low);
  field.grid.high = get_vector(wire.high);
  field.degree = static_cast<int>(wire.degree);
  field.radiance.resize(halves.size());
  for (std::size_t i = 0; i < halves.size(); ++i) field.radiance[i] = float_of(halves[i]) * wire.scale;
  field.confidence.resize(wire.confidence._length);
  for (std::size_t i = 0; i < field.confidence.size(); ++i)
    field.confidence[i] = static_cast<float>(wire.confidence._buffer[i]) / 255;
  message.probes.resize(wire.probes._length);
  for (std::size_t i = 0; i < message.probes.size(); ++i) {
    const lightwell_FieldProbe& probe = wire.probes._buffer[i];
    message.probes[i] = {get_text(probe.probe), get_vector(probe.position), probe.number, probe.age_s,
                         probe.weight};
  }
  message.lamps.resize(wire.lamps._length);
  for (std::size_t i = 0; i < message.lamps.size(); ++i) {
    const lightwell_FieldLamp& lamp = wire.lamps._buffer[i];
    message.lamps[i] = {lamp.id, get_vector(lamp.position), lamp.sigma_m, get_rgb(lamp.intensity),
                        lamp.weight};
  }
  return {};
}

}  // namespace lightwell
