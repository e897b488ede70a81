// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/publish/messages.h"

namespace lightwell {
namespace {

// Which frame it was, and when: what both kinds of snapshot say.
template <class AnySnapshot>
void fill_frame(const AnySnapshot& snapshot, FrameHeader& header) {
  header.number = snapshot.number;
  header.sequence = snapshot.sequence;
  header.capture_mono_ns = snapshot.capture_mono_ns;
  header.capture_utc_ns = snapshot.capture_utc_ns;
  header.publish_mono_ns = snapshot.publish_mono_ns;
  header.calibration_id = snapshot.calibration_id.data();
}

void fill_header(const Snapshot& snapshot, FrameHeader& header) {
  fill_frame(snapshot, header);
  header.timecode = snapshot.timecode ? timecode_text(*snapshot.timecode) : std::string();
  header.coverage = snapshot.coverage;
  header.measured_part = snapshot.map.coverage;
  header.total_illuminance = snapshot.total_illuminance;
  header.delay_frames = snapshot.delay_frames;
}

}  // namespace

bool lights_form_a_tree(const std::vector<DirectionalLight>& lights) {
  if (lights.empty() || lights.front().parent != -1) return false;
  for (std::size_t i = 1; i < lights.size(); ++i)
    if (lights[i].parent < 0 || static_cast<std::size_t>(lights[i].parent) >= i) return false;
  return true;
}

LightSet light_set(const Snapshot& snapshot) {
  LightSet set;
  set.method = snapshot.method;
  set.coverage = snapshot.coverage;
  set.total_illuminance = snapshot.total_illuminance;
  set.lights = snapshot.lights;
  set.has_parents = lights_form_a_tree(set.lights);
  return set;
}

void fill_message(const Snapshot& snapshot, LightFrame& message) {
  fill_header(snapshot, message.header);
  message.lights = snapshot.lights;
  message.has_parents = lights_form_a_tree(message.lights);
  message.harmonics.assign(snapshot.harmonics.begin(), snapshot.harmonics.end());
}

void fill_message(const FitSnapshot& snapshot, FitFrame& message) {
  const FewLightsFit& fit = snapshot.fit;
  const LightSet set = light_set(fit);
  FrameHeader& header = message.header;
  fill_frame(snapshot, header);
  header.coverage = set.coverage;
  header.measured_part = snapshot.measured_part;
  header.total_illuminance = set.total_illuminance;
  header.delay_frames = 0;
  message.ambient = set.ambient;
  message.residual = static_cast<float>(fit.residual);
  message.remarks.clear();
  for (const std::string& remark : remarks(fit))
    message.remarks += (message.remarks.empty() ? "" : "; ") + remark;
  message.lights.resize(set.lights.size());
  for (std::size_t i = 0; i < set.lights.size(); ++i)
    message.lights[i] = {set.lights[i], static_cast<float>(fit.lights[i].direction_sigma_rad)};
}

void fill_message(const Snapshot& snapshot, EnvironmentFrame& message) {
  fill_header(snapshot, message.header);
  message.map.grid = snapshot.map.grid;
  message.map.channels = snapshot.map.channels;
  message.map.radiance = snapshot.map.radiance;
}

ProbeStatus status_message(const DaemonStatus& status) {
  ProbeStatus message;
  message.version = status.version;
  message.uptime_s = status.uptime_s;
  message.source = status.source;
  message.source_state = name(status.source_state);
  message.source_description = status.source_description;
  message.nominal_rate_hz = status.nominal_rate_hz;
  message.measured_rate_hz = status.measured_rate_hz;
  message.published = status.published;
  message.received = status.capture.received;
  message.skipped = status.capture.skipped;
  message.lost = status.capture.lost;
  message.incomplete = status.capture.incomplete;
  message.reconnects = status.capture.reconnects;
  message.dropped_by_pipeline = status.dropped_by_pipeline;
  message.latency_ms_p50 = status.latency_ms_p50;
  message.latency_ms_p99 = status.latency_ms_p99;
  message.frame_age_ms = status.frame_age_ms;
  message.calibration_id = status.calibration_id;
  message.calibration_verdict = status.calibration_verdict;
  message.recording = status.recording.active;
  message.recording_file = status.recording.file;
  message.recording_frames = status.recording.frames;
  message.recording_dropped = status.recording.dropped;
  message.alarm = status.alarm;
  return message;
}

}  // namespace lightwell
