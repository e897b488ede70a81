// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/daemon.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <filesystem>
#include <future>
#include <limits>
#include <mutex>

#include "daemon/adaptation.h"
#include "daemon/alarm.h"
#include "daemon/assembly.h"
#include "daemon/clock.h"
#include "daemon/pipeline/fit_worker.h"
#include "daemon/pipeline/pipeline.h"
#include "daemon/pipeline/snapshot.h"
#include "daemon/publish/publisher.h"
#include "daemon/record/recorder.h"
#include "daemon/record/take_name.h"
#include "daemon/sync/exposure_stamper.h"
#include "daemon/sync/gpio_sync.h"
#include "daemon/sync/sync_board.h"
#include "daemon/sync/temperature_stamper.h"
#include "daemon/sync/timecode_stamper.h"
#include "daemon/web/listen_address.h"
#include "daemon/web/server.h"
#include "interface/calibration_io.h"
#include "interface/dds_domain.h"

namespace lightwell {
namespace {

// The folder must be there when a take is asked for, and a typing error should show at the start.
Status check_record_directory(const Configuration& configuration) {
  const std::filesystem::path directory = configuration.record.directory;
  std::error_code error;
  if (std::filesystem::is_directory(directory, error)) return {};
  return Error{ErrorKind::failed, fmt::format("record.directory = {}: not a folder", directory.string())};
}

// What a reload cannot change, by name; empty: nothing of that changed.
std::string needs_restart(const Configuration& now, const Configuration& wanted) {
  if (now.http != wanted.http) return "[http]";
  if (now.dds != wanted.dds) return "[dds]";
  if (now.probe != wanted.probe) return "[probe]";
  if (now.record != wanted.record) return "[record]";
  if (now.board != wanted.board) return "[board]";
  return {};
}

bool is_take(const std::string& source) {
  return source.rfind("recording:", 0) == 0;
}

// No board triggers a take or a simulation.
bool is_camera(const std::string& source) {
  return !is_take(source) && source.rfind("simulated:", 0) != 0;
}

}  // namespace

// In order of construction: whoever uses a part comes after it, so that destruction goes the other way.
struct Daemon::Parts {
  Parts(const Configuration& given, Calibration calibration_given)
      : configuration(given),
        snapshots(FramePath::prototype(frame_path_options(given))),
        calibration(std::move(calibration_given)),
        recorder(given.record.directory),
        pipeline(&recorder, {&stamper, &timecodes, &temperatures}) {}

  void use_stampers(const std::string& source) {
    stamper.use(is_camera(source));
    timecodes.use(!is_take(source));
    temperatures.use(!is_take(source));
  }

  std::int64_t start_mono_ns = mono_now_ns();
  mutable std::mutex mutex;  // guards configuration and calibration
  Configuration configuration;
  SnapshotChannel snapshots;
  Calibration calibration;
  Recorder recorder;
  StrobeRing strobes;
  ExposureStamper stamper{strobes};
  TimecodeStamper timecodes;
  TemperatureStamper temperatures;
  Pipeline pipeline;
  std::unique_ptr<Publisher> publisher;
  std::unique_ptr<FitWorker> fits;
  std::unique_ptr<WebServer> web;
  std::unique_ptr<GpioSync> gpio;    // null: the address is none of GPIO lines
  std::unique_ptr<SyncBoard> board;  // null: none is configured; its button asks the others
  std::future<void> button;          // what its last press began
  std::unique_ptr<Adaptation> adaptation;
  std::string logged_mismatch;  // log_changes' own
};

Status Daemon::check(const Configuration& configuration) {
  for (const Status& status :
       {check_listen_address(configuration.http.listen),
        check_dds_options({configuration.dds.domain, configuration.dds.network_interface}),
        check_record_directory(configuration)})
    if (!status) return status;
  const auto source = make_capture_source(configuration.source.address, capture_options(configuration));
  if (!source) return source.error();
  if (const auto gpio = gpio_options(configuration); !gpio) return gpio.error();
  const auto calibration = choose_calibration(configuration);
  if (!calibration) return calibration.error();
  if (const auto use = adaptation_options(configuration, *calibration); !use) return use.error();
  return check_frames_fit(configuration, *calibration);
}

Result<std::unique_ptr<Daemon>> Daemon::start(const Configuration& configuration) {
  auto source = make_capture_source(configuration.source.address, capture_options(configuration));
  if (!source) return source.error();
  auto board = board_options(configuration);
  if (!board) return board.error();
  auto gpio = gpio_options(configuration);
  if (!gpio) return gpio.error();
  auto calibration = choose_calibration(configuration);
  if (!calibration) return calibration.error();
  auto use = adaptation_options(configuration, *calibration);
  if (!use) return use.error();

  auto parts = std::make_unique<Parts>(configuration, *calibration);
  Parts& p = *parts;
  p.use_stampers(configuration.source.address);
  std::unique_ptr<Daemon> daemon(new Daemon(std::move(parts)));
  // Before those who ask for the status of all.
  if (*gpio) p.gpio = std::make_unique<GpioSync>(std::move(**gpio), p.strobes);
  if (*board) {
    (*board)->on_button = [d = daemon.get()](sync_press press) { d->take_button(press); };
    p.board = std::make_unique<SyncBoard>(std::move(**board), p.strobes, p.timecodes);
  }
  p.adaptation = std::make_unique<Adaptation>(p.board.get(), p.pipeline, p.snapshots, std::move(*use));
  auto publisher = Publisher::start({configuration.probe.name,
                                     {configuration.dds.domain, configuration.dds.network_interface},
                                     configuration.dds.environment_hz},
                                    p.snapshots, *daemon);
  if (!publisher) return publisher.error();
  p.publisher = std::move(*publisher);
  p.fits = std::make_unique<FitWorker>(p.snapshots, fit_options(configuration),
                                       [&p](const FitSnapshot& fit) { p.publisher->send(fit); });
  auto web = WebServer::start({configuration.http.listen}, p.snapshots, *daemon);
  if (!web) return web.error();
  p.web = std::move(*web);

  Status started = p.pipeline.start(
      std::move(*source),
      std::make_shared<FramePath>(p.calibration, frame_path_options(configuration), p.snapshots));
  if (!started) return started.error();
  return daemon;
}

Daemon::Daemon(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
Daemon::~Daemon() {
  stop();
}

Status Daemon::reload(const Configuration& wanted) {
  const std::scoped_lock lock(parts_->mutex);
  const Configuration& now = parts_->configuration;
  if (const std::string section = needs_restart(now, wanted); !section.empty())
    return Error{ErrorKind::usage, section + " changed; that takes a restart"};
  const auto calibration = choose_calibration(wanted);
  if (!calibration) return calibration.error();
  auto use = adaptation_options(wanted, *calibration);
  if (!use) return use.error();
  std::shared_ptr<CaptureSource> source;
  const bool source_changed = now.source != wanted.source;
  if (source_changed) {
    auto made = make_capture_source(wanted.source.address, capture_options(wanted));
    if (!made) return made.error();
    source = std::move(*made);
  }
  const Calibration used = parts_->adaptation->adapted(*calibration);
  Status replaced = parts_->pipeline.replace(
      std::move(source), std::make_shared<FramePath>(used, frame_path_options(wanted), parts_->snapshots));
  if (!replaced) return replaced;
  parts_->use_stampers(wanted.source.address);
  if (now.fit != wanted.fit) parts_->fits->set_options(fit_options(wanted));
  parts_->configuration = wanted;
  parts_->calibration = used;
  parts_->adaptation->use(std::move(*use), !source_changed);
  return {};
}

void Daemon::close_take() {
  if (!parts_->recorder.stats().active) return;  // that none was begun is no failure here
  if (const Status closed = parts_->recorder.stop(); !closed) spdlog::error("{}", closed.error().message);
}

// A short press begins a take or ends it, on a thread of its own: a slow disk must not keep the board from its heartbeat.
void Daemon::take_button(sync_press press) {
  if (press != SYNC_BUTTON_SHORT) return;
  std::future<void>& button = parts_->button;
  if (button.valid() && button.wait_for(std::chrono::seconds(0)) != std::future_status::ready) {
    spdlog::warn("record button: the last press is still being worked on");
    return;
  }
  button = std::async(std::launch::async, [this] {
    const Status done =
        parts_->recorder.stats().active ? stop_recording() : start_recording(take_name_at(utc_now_ns()));
    if (!done) spdlog::error("record button: {}", done.error().message);
  });
}

void Daemon::tell_board() {
  if (!parts_->board) return;
  const DaemonStatus now = status();
  const sync_host idle = now.source_state == SourceState::streaming ? SYNC_HOST_LIVE : SYNC_HOST_IDLE;
  parts_->board->set_host_state(now.recording.active ? SYNC_HOST_RECORDING
                                : !now.alarm.empty() ? SYNC_HOST_TROUBLE
                                                     : idle);
}

void Daemon::adapt() {
  const std::scoped_lock lock(
      parts_->mutex);  // no take begins meanwhile, with a calibration that is not to be its own
  if (is_take(parts_->configuration.source.address)) return;  // its light is not the light on set
  if (parts_->board) {
    const auto camera = parts_->board->view().temperature[SYNC_SENSOR_CAMERA];
    parts_->temperatures.set(camera ? static_cast<float>(camera->temperature_mc) * 1e-3F
                                    : std::numeric_limits<float>::quiet_NaN());
  }
  const auto calibration = parts_->adaptation->turn(parts_->recorder.stats().active);
  if (!calibration) return;
  const Status replaced = parts_->pipeline.replace(
      nullptr, std::make_shared<FramePath>(*calibration, frame_path_options(parts_->configuration),
                                           parts_->snapshots));
  if (replaced)
    parts_->calibration = *calibration;
  else
    spdlog::error("calibration: {}", replaced.error().message);
}

void Daemon::stop() {
  close_take();                              // first: nothing else can lose anything
  if (parts_->board) parts_->board->stop();  // its button may ask for a take
  parts_->button = {};
  parts_->pipeline.stop();
  parts_->snapshots.close();
  parts_->web.reset();
  parts_->fits.reset();
  parts_->publisher.reset();
}

DaemonStatus Daemon::status() const {
  const Pipeline::View view = parts_->pipeline.view();
  const std::int64_t now_ns = mono_now_ns();
  DaemonStatus status;
  std::filesystem::path record_directory;
  status.version = "0.1.0";
  status.uptime_s = static_cast<double>(now_ns - parts_->start_mono_ns) * 1e-9;
  {
    const std::scoped_lock lock(parts_->mutex);
    status.source = parts_->configuration.source.address;
    status.calibration_id = parts_->calibration.id;
    record_directory = parts_->configuration.record.directory;
  }
  if (view.source) {  // between construction and start there is none
    status.source_state = view.source->state();
    status.source_description = view.source->describe();
    status.capture = view.source->counters();
    status.nominal_rate_hz = view.source->rate_hz();
  }
  status.measured_rate_hz = view.measured_rate_hz;
  status.calibration_verdict = view.mismatch;
  status.dropped_by_pipeline = view.dropped;
  if (view.path) {
    status.published = view.path->published();
    const auto develop = view.path->develop_ms().quantiles();
    const auto lights = view.path->lights_ms().quantiles();
    const auto latency = view.path->latency_ms().quantiles();
    status.develop_ms_p50 = develop.p50, status.develop_ms_p99 = develop.p99;
    status.lights_ms_p50 = lights.p50, status.lights_ms_p99 = lights.p99;
    status.latency_ms_p50 = latency.p50, status.latency_ms_p99 = latency.p99;
  }
  if (const auto newest = parts_->snapshots.wait_newer(0, std::chrono::milliseconds(0)))
    status.frame_age_ms = static_cast<double>(now_ns - newest->capture_mono_ns) * 1e-6;
  const Recorder::Stats take = parts_->recorder.stats();
  status.recording = {take.active, take.file, take.frames, take.dropped, take.bytes, take.error};
  std::error_code ignored;
  status.recording.directory = std::filesystem::absolute(record_directory, ignored).string();
  if (parts_->gpio) {
    status.board = parts_->gpio->view();
    status.board.stamped = parts_->stamper.stamped();
    status.board.left = parts_->stamper.left();
  }
  if (parts_->board) {
    status.board = parts_->board->view();
    status.board.stamped = parts_->stamper.stamped();
    status.board.left = parts_->stamper.left();
    parts_->adaptation->describe(status.board);
  }
  status.alarm = alarm_for(status);
  return status;
}

std::optional<FitSnapshot> Daemon::newest_fit() const {
  return parts_->fits->newest();
}

Status Daemon::start_recording(const std::string& file) {
  const auto newest = parts_->snapshots.wait_newer(0, std::chrono::milliseconds(0));
  if (!newest) return Error{ErrorKind::failed, "nothing to record: no frame has come yet"};
  RecordingHeader header;
  header.format = newest->format;
  header.rate_hz = parts_->pipeline.view().source->rate_hz();
  header.start_utc_ns = utc_now_ns();
  const std::scoped_lock lock(parts_->mutex);
  header.codec = parts_->configuration.record.codec == "ffv1" ? RecordingCodec::ffv1 : RecordingCodec::raw;
  header.source = parts_->configuration.source.address;
  header.calibration_json = calibration_to_json(parts_->calibration);
  return parts_->recorder.start(file, header);
}

Status Daemon::stop_recording() {
  return parts_->recorder.stop();
}

std::string Daemon::url() const {
  return parts_->web->url();
}
std::uint64_t Daemon::heartbeat() const {
  return parts_->pipeline.heartbeat();
}
void Daemon::log_changes() {
  const std::string now = parts_->pipeline.view().mismatch;
  const std::string line = calibration_change(parts_->logged_mismatch, now);
  if (line.empty()) return;
  if (now.empty())
    spdlog::info("{}", line);
  else
    spdlog::error("{}", line);
  parts_->logged_mismatch = now;
}
bool Daemon::ended() const {
  return parts_->pipeline.view().source->state() == SourceState::ended;
}

}  // namespace lightwell
