// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/web/metrics.h"

#include <array>
#include <charconv>
#include <cmath>

namespace lightwell {
namespace {

std::string number(double value) {
  if (std::isnan(value)) return "NaN";
  if (std::isinf(value)) return value > 0 ? "+Inf" : "-Inf";
  char digits[32];
  return {digits, std::to_chars(digits, digits + sizeof digits, value).ptr};
}

// Backslash, quote and newline are what a label value escapes.
std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\' || c == '"') out += '\\';
    if (c == '\n')
      out += "\\n";
    else
      out += c;
  }
  return out;
}

class Page {
 public:
  void family(const char* name, const char* type, const char* help) {
    name_ = name;
    text_ += std::string("# HELP ") + name + " " + help + "\n# TYPE " + name + " " + type + "\n";
  }
  void sample(double value, const std::string& labels = {}) {
    text_ += name_ + (labels.empty() ? "" : "{" + labels + "}") + " " + number(value) + "\n";
  }
  void counter(const char* name, std::uint64_t value, const char* help) {
    family(name, "counter", help);
    sample(static_cast<double>(value));
  }
  void gauge(const char* name, double value, const char* help) {
    family(name, "gauge", help);
    sample(value);
  }
  // Milliseconds in, seconds out: Prometheus wants base units.
  void quantiles(const char* name, double p50_ms, double p99_ms, const char* help) {
    family(name, "gauge", help);
    sample(p50_ms / 1000, "quantile=\"0.5\"");
    sample(p99_ms / 1000, "quantile=\"0.99\"");
  }
  std::string take() { return std::move(text_); }

 private:
  std::string text_, name_;
};

void add_capture(Page& page, const DaemonStatus& status) {
  const CaptureCounters& capture = status.capture;
  page.counter("lightwell_frames_received_total", capture.received, "Complete frames from the camera.");
  page.counter("lightwell_frames_skipped_total", capture.skipped,
               "Complete frames passed over for a fresher one.");
  page.counter("lightwell_frames_lost_total", capture.lost, "Gaps in the camera's sequence.");
  page.counter("lightwell_frames_incomplete_total", capture.incomplete, "Frames with packets missing.");
  page.counter("lightwell_source_reconnects_total", capture.reconnects, "Times the camera was opened again.");
  page.family("lightwell_source_state", "gauge", "1 for the state the source is in.");
  for (const SourceState state :
       {SourceState::no_device, SourceState::opening, SourceState::no_signal, SourceState::streaming,
        SourceState::stalled, SourceState::wrong_format, SourceState::ended})
    page.sample(state == status.source_state ? 1 : 0, std::string("state=\"") + name(state) + "\"");
}

void add_pipeline(Page& page, const DaemonStatus& status) {
  page.counter("lightwell_frames_published_total", status.published, "Frames whose lights were published.");
  page.counter("lightwell_frames_dropped_total", status.dropped_by_pipeline,
               "Frames the pipeline could not use.");
  page.gauge("lightwell_rate_hertz", status.measured_rate_hz, "Published frames a second.");
  page.gauge("lightwell_nominal_rate_hertz", status.nominal_rate_hz, "Frame rate agreed with the camera.");
  page.quantiles("lightwell_develop_seconds", status.develop_ms_p50, status.develop_ms_p99,
                 "Raw frame to radiance map, over the last 1000 frames.");
  page.quantiles("lightwell_lights_seconds", status.lights_ms_p50, status.lights_ms_p99,
                 "Radiance map to lights, over the last 1000 frames.");
  page.quantiles("lightwell_latency_seconds", status.latency_ms_p50, status.latency_ms_p99,
                 "Frame in memory to lights published, over the last 1000 frames.");
  page.gauge("lightwell_frame_age_seconds", status.frame_age_ms / 1000,
             "Since the last published frame's capture.");
}

void add_light(Page& page, const Snapshot& snapshot) {
  page.gauge("lightwell_clipped_pixels", snapshot.map.clipped_pixels,
             "Pixels at the top code in the last frame.");
  page.gauge("lightwell_lights", static_cast<double>(snapshot.lights.size()), "Lights in the last frame.");
  page.family("lightwell_illuminance_lux", "gauge",
              "Light of the measured directions, summed without a cosine.");
  for (int c = 0; c < 3; ++c)
    page.sample(static_cast<double>(snapshot.total_illuminance[c]),
                std::string("channel=\"") + "rgb"[c] + "\"");
}

// What the board has not said is not there.
void add_board(Page& page, const BoardView& board) {
  if (board.state == BoardState::off) return;
  page.gauge("lightwell_board_connected", board.state == BoardState::connected ? 1 : 0,
             "1 while the sync board answers.");
  page.counter("lightwell_board_reconnects_total", board.reconnects, "Times the board was found again.");
  page.counter("lightwell_board_stamped_frames_total", board.stamped,
               "Frames whose exposure the strobe told.");
  page.counter("lightwell_board_unstamped_frames_total", board.left,
               "Frames that no strobe could be given to.");
  if (board.status) {
    page.gauge("lightwell_board_locked", board.status->lock == SYNC_LOCK_LOCKED ? 1 : 0,
               "1 while triggers follow the reference.");
    page.gauge("lightwell_board_phase_rms_seconds", board.status->phase_rms_ns * 1e-9,
               "Of the reference's last edges against their prediction.");
  }
  if (board.photodiode)
    page.gauge("lightwell_board_illuminance_lux", board.photodiode->level_mlx * 1e-3,
               "Mean of the photodiode.");
  if (const auto& t = board.temperature[SYNC_SENSOR_BOARD])
    page.gauge("lightwell_board_temperature_celsius", t->temperature_mc * 1e-3, "Of the board.");
}

}  // namespace

std::string metrics_text(const DaemonStatus& status, const Snapshot* snapshot, const WebCounters& web) {
  Page page;
  page.family("lightwell_build_info", "gauge", "Version and calibration as labels.");
  page.sample(1, "version=\"" + escaped(status.version) + "\",calibration=\"" +
                     escaped(status.calibration_id) + "\"");
  page.gauge("lightwell_uptime_seconds", status.uptime_s, "Since the daemon started.");
  add_capture(page, status);
  add_pipeline(page, status);
  add_board(page, status.board);
  if (snapshot != nullptr) add_light(page, *snapshot);
  page.gauge("lightwell_alarm", status.alarm.empty() ? 0 : 1, "1 while something is wrong.");
  page.gauge("lightwell_recording", status.recording.active ? 1 : 0, "1 while a take is recorded.");
  page.gauge("lightwell_recording_frames", static_cast<double>(status.recording.frames),
             "Frames in the take.");
  page.gauge("lightwell_recording_dropped_frames", static_cast<double>(status.recording.dropped),
             "Frames the disk was too slow for.");
  page.gauge("lightwell_recording_bytes", static_cast<double>(status.recording.bytes), "Size of the take.");
  page.counter("lightwell_http_requests_total", web.requests, "HTTP requests.");
  page.counter("lightwell_http_refused_total", web.refused, "Requests with a foreign Host or Origin.");
  page.gauge("lightwell_stream_clients", static_cast<double>(web.stream_clients),
             "Event streams that are open.");
  page.counter("lightwell_stream_dropped_total", web.stream_dropped, "Events that slow clients did not get.");
  return page.take();
}

}  // namespace lightwell
