// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/web/json.h"

#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

#include "daemon/publish/messages.h"
#include "daemon/web/board_json.h"
#include "interface/fit_json.h"
#include "interface/light_set_io.h"

namespace lightwell {
namespace {

using Json = nlohmann::ordered_json;

// Text from a device may not be UTF-8; the answer must be.
std::string dump(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

Json quantiles(double p50, double p99) {
  return {{"p50", p50}, {"p99", p99}};
}  // NaN dumps as null

template <class Number>
void append(std::string& text, Number value) {
  if constexpr (std::is_floating_point_v<Number>)
    if (!std::isfinite(value)) {
      text += "null";
      return;
    }
  char digits[32];
  text.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
}

template <class Vector>
void append_triple(std::string& text, const char* key, const Vector& v) {
  text += key;
  text += '[';
  append(text, v[0]);
  text += ',';
  append(text, v[1]);
  text += ',';
  append(text, v[2]);
  text += ']';
}

// An object that goes on: light sets write their own numbers, shortest and exact, and are joined as text.
std::string opened(const Json& object) {
  std::string text = object.dump(-1, ' ', false, Json::error_handler_t::replace);
  text.back() = ',';
  return text;
}

}  // namespace

std::string error_json(const std::string& message) {
  return dump({{"error", message}});
}

std::string status_json(const DaemonStatus& status) {
  const auto& recording = status.recording;
  const auto& capture = status.capture;
  return dump({
      {"version", status.version},
      {"uptime_s", status.uptime_s},
      {"source", status.source},
      {"source_state", name(status.source_state)},
      {"source_description", status.source_description},
      {"capture",
       {{"received", capture.received},
        {"skipped", capture.skipped},
        {"lost", capture.lost},
        {"incomplete", capture.incomplete},
        {"reconnects", capture.reconnects}}},
      {"nominal_rate_hz", status.nominal_rate_hz},
      {"measured_rate_hz", status.measured_rate_hz},
      {"published", status.published},
      {"dropped_by_pipeline", status.dropped_by_pipeline},
      {"develop_ms", quantiles(status.develop_ms_p50, status.develop_ms_p99)},
      {"lights_ms", quantiles(status.lights_ms_p50, status.lights_ms_p99)},
      {"latency_ms", quantiles(status.latency_ms_p50, status.latency_ms_p99)},
      {"frame_age_ms", status.frame_age_ms},
      {"calibration_id", status.calibration_id},
      {"calibration_verdict", status.calibration_verdict},
      {"recording",
       {{"active", recording.active},
        {"file", recording.file},
        {"directory", recording.directory},
        {"frames", recording.frames},
        {"dropped", recording.dropped},
        {"bytes", recording.bytes},
        {"error", recording.error}}},
      {"board", board_json(status.board)},
      {"alarm", status.alarm},
  });
}

std::string lights_json(const Snapshot& snapshot, const FitSnapshot* fit) {
  Json frame{{"number", snapshot.number},
             {"sequence", snapshot.sequence},
             {"capture_time_ns", snapshot.capture_mono_ns},
             {"capture_utc_ns", snapshot.capture_utc_ns},
             {"timecode", snapshot.timecode ? Json(timecode_text(*snapshot.timecode)) : Json(nullptr)},
             {"publish_time_ns", snapshot.publish_mono_ns},
             {"calibration_id", std::string(snapshot.calibration_id.data())},
             {"measured_part", snapshot.map.coverage},
             {"delay_frames", snapshot.delay_frames}};
  std::string text = opened(frame);
  text += "\"sh\":[";
  const char* separator = "";
  for (const Rgb& coefficient : snapshot.harmonics) {
    append_triple(text, separator, coefficient);
    separator = ",";
  }
  text += "],";
  if (fit != nullptr) {
    const Json of_frame{{"number", fit->number},
                        {"sequence", fit->sequence},
                        {"capture_time_ns", fit->capture_mono_ns},
                        {"publish_time_ns", fit->publish_mono_ns}};
    const std::string set = fit_to_json(fit->fit, true);
    text += "\"fit\":" + opened(of_frame) + set.substr(1, set.rfind('}')) + ",";
  }
  const std::string set = light_set_to_json(light_set(snapshot), true);
  return text + set.substr(set.find('{') + 1);
}

void write_stream_event(const Snapshot& snapshot, std::string& event) {
  event.clear();
  event += "id: ";
  append(event, snapshot.number);
  event += "\ndata: {\"sequence\":";
  append(event, snapshot.sequence);
  event += ",\"capture_time_ns\":";
  append(event, snapshot.capture_mono_ns);
  event += ",\"publish_time_ns\":";
  append(event, snapshot.publish_mono_ns);
  if (snapshot.timecode) event += ",\"timecode\":\"" + timecode_text(*snapshot.timecode) + "\"";
  event += ",\"clipped_pixels\":";
  append(event, snapshot.map.clipped_pixels);
  append_triple(event, ",\"total_illuminance\":", snapshot.total_illuminance);
  event += ",\"lights\":[";
  const bool tree = lights_form_a_tree(snapshot.lights);
  const char* separator = "";
  for (const DirectionalLight& light : snapshot.lights) {
    event += separator;
    append_triple(event, "{\"direction\":", light.direction);
    append_triple(event, ",\"illuminance\":", light.illuminance);
    event += ",\"id\":";
    append(event, light.id);
    if (tree) {
      event += ",\"parent\":";
      append(event, light.parent);
    }
    event += '}';
    separator = ",";
  }
  event += "]}\n\n";
}

}  // namespace lightwell
