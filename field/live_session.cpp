// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "field/live_session.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>

#include "interface/option_range.h"
#include "interface/printable.h"
#include "lighting/field/polar_turn.h"

namespace lightwell {
namespace {

constexpr std::size_t kMostStrangers = 64;  // whom we remember by name

std::vector<Vec3d> places_of(const std::vector<StageProbe>& probes) {
  std::vector<Vec3d> places;
  for (const StageProbe& probe : probes) places.push_back(probe.position);
  return places;
}

// The mean over the points of radiance summed over all directions, ∫ L = √(4π) L_00.
Rgb mean_illuminance(const LightField& field) {
  Rgbd sum = Rgbd::Zero();
  for (int z = 0; z < field.grid.size[2]; ++z)
    for (int c = 0; c < 3; ++c) {
      const float* plane = field.plane(z, 0, c);
      sum[c] += std::accumulate(plane, plane + field.slab_points(), 0.0);
    }
  return (sum * (std::sqrt(4 * kPi) / static_cast<double>(field.grid.points()))).max(0.0).cast<float>();
}

}  // namespace

Result<StageProbe> parse_stage_probe(const std::string& text) {
  const Error wrong{ErrorKind::usage,
                    "--probe is " + text +
                        ", allowed: NAME=X,Y,Z[,HEADING], a name of 1 to 63 printable ASCII characters, "
                        "-100000 to 100000 metres, -360 to 360 degrees"};
  const std::size_t equals = text.rfind('=');
  if (equals == std::string::npos || equals == 0 || equals > 63) return wrong;
  StageProbe probe;
  probe.name = text.substr(0, equals);
  if (!std::all_of(probe.name.begin(), probe.name.end(), [](char c) { return c >= 0x20 && c < 0x7f; }))
    return wrong;
  std::string_view rest = std::string_view(text).substr(equals + 1);
  for (int i = 0; i < 4; ++i) {
    const std::size_t comma = rest.find(',');
    const auto value = option_range::parse<double>(rest.substr(0, comma));
    if (!value || !(std::abs(*value) <= (i < 3 ? 1e5 : 360))) return wrong;
    (i < 3 ? probe.position[i] : probe.heading_deg) = *value;
    if (comma == std::string_view::npos) return i >= 2 ? Result<StageProbe>(probe) : wrong;
    rest.remove_prefix(comma + 1);
  }
  return wrong;
}

LiveSession::LiveSession(const LiveFieldOptions& options, std::vector<StageProbe> probes)
    : options_(options),
      probes_(std::move(probes)),
      states_(probes_.size()),
      field_(options, places_of(probes_)) {}

bool LiveSession::heard_any() const {
  return std::any_of(states_.begin(), states_.end(), [](const ProbeState& state) { return state.maps > 0; });
}

void LiveSession::hear(const EnvironmentFrame& map, double now_s) {
  const std::string& name = map.header.probe;
  const auto found = std::find_if(probes_.begin(), probes_.end(),
                                  [&](const StageProbe& probe) { return probe.name == name; });
  if (found == probes_.end()) {
    if (strangers_.size() < kMostStrangers && strangers_.insert(name).second)
      news_.push_back("probe '" + printable(name) + "' is on the wire without a place here (--probe '" +
                      printable(name) + "=X,Y,Z')");
    return;
  }
  const auto index = static_cast<std::size_t>(found - probes_.begin());
  ProbeState& state = states_[index];
  if (state.maps == 0) {
    char text[120];
    std::snprintf(text, sizeof text, "' is heard: %d x %d bins to %.4g degrees from the zenith",
                  map.map.grid.rings, map.map.grid.sectors, map.map.grid.theta_max_rad * 180 / kPi);
    news_.push_back("probe '" + printable(name) + text);
  } else if (state.silent) {
    news_.push_back("probe '" + printable(name) + "' is back");
  }
  state.silent = false;
  state.last_s = now_s;
  state.number = map.header.number;
  ++state.maps;
  if (found->heading_deg != 0) {
    turn_about_zenith(map.map, found->heading_deg * kPi / 180, turned_);
    field_.update(index, turned_, now_s);
  } else {
    field_.update(index, map.map, now_s);
  }
  frame_.header.capture_mono_ns = std::max(frame_.header.capture_mono_ns, map.header.capture_mono_ns);
  frame_.header.capture_utc_ns = std::max(frame_.header.capture_utc_ns, map.header.capture_utc_ns);
}

// Says who fell silent, and who was never heard.
void LiveSession::watch(double now_s) {
  if (!begin_s_) begin_s_ = now_s;
  for (std::size_t n = 0; n < probes_.size(); ++n) {
    ProbeState& state = states_[n];
    const std::string name = "probe '" + printable(probes_[n].name) + "'";
    if (state.last_s && !state.silent && now_s - *state.last_s > options_.hold_s) {
      state.silent = true;
      news_.push_back(name + " is silent and fades out");
    }
    if (!state.last_s && !state.missing_said && now_s - *begin_s_ > kMissing_s) {
      state.missing_said = true;
      std::string others;
      for (const std::string& stranger : strangers_)
        others += (others.empty() ? "" : ", ") + printable(stranger);
      news_.push_back(
          name + " was not heard yet; on the wire without a place: " + (others.empty() ? "none" : others));
    }
  }
}

FieldFrame& LiveSession::make(double now_s) {
  watch(now_s);
  const LightField& field = field_.make(now_s);
  frame_.field = field;
  ++frame_.header.number;
  frame_.header.coverage = Coverage::hemisphere;
  frame_.header.measured_part =
      static_cast<float>(std::accumulate(field.confidence.begin(), field.confidence.end(), 0.0) /
                         static_cast<double>(field.grid.points()));
  frame_.header.total_illuminance = mean_illuminance(field);
  frame_.probes.resize(probes_.size());
  for (std::size_t n = 0; n < probes_.size(); ++n) {
    const ProbeState& state = states_[n];
    frame_.probes[n] = {probes_[n].name, probes_[n].position, state.number,
                        static_cast<float>(state.last_s ? now_s - *state.last_s : now_s - *begin_s_),
                        static_cast<float>(field_.weights()[n])};
  }
  frame_.lamps.clear();
  for (const LampTrack& lamp : field_.lamps())
    frame_.lamps.push_back({lamp.id, lamp.position, static_cast<float>(lamp.sigma_m),
                            lamp.intensity.cast<float>(), static_cast<float>(lamp.weight)});
  return frame_;
}

std::vector<std::string> LiveSession::news() {
  return std::exchange(news_, {});
}

}  // namespace lightwell
