// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <signal.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "daemon/simulator/gige_camera.h"
#include "daemon/simulator/probe_setup.h"
#include "daemon/simulator/tracker_output.h"
#include "daemon/simulator/truth_file.h"
#include "interface/calibration_io.h"
#include "interface/option_range.h"
#include "interface/printable.h"

// lightwell-camera: a GigE Vision camera that looks at known light.
namespace lightwell::simulator {
namespace {

struct CommandLine {
  ProbeOptions probe;
  GigeCameraOptions camera;
  std::string size = "640x480";
  std::string truth, calibration_folder, tracking_out;
  TrackerOptions tracker;
  double tracking_lag_ms = 0;
  double seconds = 0;        // 0: until a signal
  std::uint64_t frames = 0;  // 0: any number
};

int fail(const Error& error) {
  std::fprintf(stderr, "lightwell-camera: %s\n", printable(error.message).c_str());
  return static_cast<int>(error.kind);
}

void declare(CLI::App& app, CommandLine& c) {
  app.footer(
      "Example: lightwell-camera --scenario day --size 640x480 --rate 60 --truth truth.jsonl "
      "--write-calibration "
      "calibration\n"
      "Truth: one JSON line a frame with frame, frame_id, time_ns (mid-exposure, CLOCK_MONOTONIC), "
      "total_illuminance and "
      "lights.\nA monochrome camera sees luminance, so its truth has R = G = B.");
  app.add_option("--address", c.camera.address, "IPv4 address of this machine to answer on")
      ->capture_default_str();
  auto* environment =
      app.add_option("--environment", c.probe.environments, "Environment images (EXR, HDR), shown in turn");
  auto* scenario = app.add_option("--scenario", c.probe.scenario,
                                  "day, studio, flicker, walk, static, stage or stage@X,Y,Z");
  scenario->capture_default_str();
  environment->excludes(scenario);
  app.add_option("--hold", c.probe.hold_s, "Seconds that each environment is shown")->capture_default_str();
  app.add_option("--size", c.size, "Sensor size, WIDTHxHEIGHT")->capture_default_str();
  app.add_option("--pixel-format", c.probe.pixel_format,
                 "Mono8, Mono10, Mono12, Mono12p, Mono16, BayerRG8, BayerRG10, BayerRG12 or BayerRG16; also "
                 "the sensor's kind")
      ->capture_default_str();
  app.add_option("--rate", c.probe.rate_hz, "Frames a second at the start; a client may change it")
      ->capture_default_str();
  app.add_option("--exposure", c.probe.exposure_us, "Microseconds at the start [the scene's own]");
  app.add_option("--response", c.probe.response, "response.json of the sensor [logarithmic, eight decades]");
  app.add_option("--lens", c.probe.lens,
                 "lens.json, of --size; its zenith tilts the camera [a fisheye of 180 degrees]");
  app.add_option("--noise", c.probe.noise_codes, "Temporal noise, standard deviation in 12 bit codes")
      ->capture_default_str();
  app.add_option("--loss", c.camera.loss, "Part of the packets that is not sent, 0 to 1")
      ->capture_default_str();
  app.add_option("--seed", c.probe.seed, "Of fixed pattern, noise and loss")
      ->check(whole_numbers(0, UINT32_MAX))
      ->capture_default_str();
  app.add_option("--truth", c.truth, "File for what every frame shows, a JSON line a frame");
  app.add_option("--write-calibration", c.calibration_folder,
                 "Folder for the camera's exact response.json, lens.json and flat.json");
  auto* tracking =
      app.add_option("--tracking-out", c.tracking_out,
                     "Send the probe's exact pose as a tracker does, opentrackio:ADDRESS:PORT or "
                     "freed:ADDRESS:PORT (--scenario walk)");
  app.add_option("--tracking-lag", c.tracking_lag_ms, "Milliseconds by which each pose is sent late")
      ->check(numbers_from(0, 1000, "0 to 1000 ms"))
      ->needs(tracking);
  app.add_option("--tracking-rate", c.tracker.rate_hz, "Poses a second")
      ->check(numbers_from(1, 1000, "1 to 1000 Hz"))
      ->capture_default_str()
      ->needs(tracking);
  app.add_option("--seconds", c.seconds, "End after so many seconds [never]");
  app.add_option("--frames", c.frames, "End when so many frames have left [never]");
}

Status check(CommandLine& c) {
  int used = 0;
  if (std::sscanf(c.size.c_str(), "%5dx%5d%n", &c.probe.width, &c.probe.height, &used) != 2 ||
      static_cast<std::size_t>(used) != c.size.size())
    return Error{ErrorKind::usage, "--size = " + c.size + ": allowed WIDTHxHEIGHT, 1x1 to 4096x4096"};
  if (!(c.camera.loss >= 0 && c.camera.loss <= 1))
    return Error{ErrorKind::usage, "--loss = " + std::to_string(c.camera.loss) + ": allowed 0 to 1"};
  if (!(c.seconds >= 0 && c.seconds <= 1e9))
    return Error{ErrorKind::usage, "--seconds = " + std::to_string(c.seconds) + ": allowed 0 to 1e9"};
  if (!(c.probe.rate_hz >= 0.1))
    return Error{ErrorKind::usage,
                 "--rate = " + std::to_string(c.probe.rate_hz) + ": allowed 0.1 to 1000 Hz"};
  if (!c.tracking_out.empty()) {
    const auto to = parse_tracking(c.tracking_out, "--tracking-out");
    if (!to) return to.error();
    c.tracker.to = *to;
    c.tracker.lag_s = c.tracking_lag_ms * 1e-3;
  }
  return {};
}

// What happens to frames that left; the first failure ends the program.
class Told {
 public:
  Told(std::optional<TruthFile> truth, std::unique_ptr<TrackerOutput> tracker)
      : truth_(std::move(truth)), tracker_(std::move(tracker)) {}
  void frame(const SentFrame& sent) {
    if (tracker_) tracker_->frame(sent);
    if (!truth_ || failed_.load()) return;
    if (const Status status = truth_->write(sent); !status) {
      error_ = status.error();
      failed_.store(true);
    }
  }
  [[nodiscard]] bool failed() const { return failed_.load(); }
  [[nodiscard]] const Error& error() const { return error_; }  // once failed

 private:
  std::optional<TruthFile> truth_;
  std::unique_ptr<TrackerOutput> tracker_;
  Error error_;
  std::atomic<bool> failed_{false};
};

void announce(const CommandLine& c, const ProbeSetup& setup) {
  const std::string shows =
      c.probe.environments.empty()
          ? c.probe.scenario
          : c.probe.environments.front().string() +
                (c.probe.environments.size() > 1
                     ? " and " + std::to_string(c.probe.environments.size() - 1) + " more"
                     : "");
  std::fprintf(stderr, "lightwell-camera: ready on %s: %s, %dx%d %s, %g Hz, exposure %g us, calibration %s\n",
               c.camera.address.c_str(), shows.c_str(), setup.model.format.width, setup.model.format.height,
               c.probe.pixel_format.c_str(), setup.rate_hz, setup.exposure_us,
               setup.model.calibration.id.c_str());
}

// Until a signal, the end of the time or of the frames, or a failure.
void wait_for_the_end(const CommandLine& c, const GigeCamera& camera, const Told& told,
                      const sigset_t& signals) {
  const auto begin = std::chrono::steady_clock::now();
  const timespec step{0, 20'000'000};
  while (!told.failed()) {
    if (::sigtimedwait(&signals, nullptr, &step) > 0) return;
    if (c.frames > 0 && camera.frames() >= c.frames) return;
    if (c.seconds > 0 &&
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count() >= c.seconds)
      return;
  }
}

int run(CommandLine& c) {
  // Blocked before any thread starts, so that all of them leave the signals to the wait below.
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  ::pthread_sigmask(SIG_BLOCK, &signals, nullptr);

  if (const Status status = check(c); !status) return fail(status.error());
  auto setup = set_up_probe(c.probe);
  if (!setup) return fail(setup.error());
  for (const std::string& message : setup->messages)
    std::fprintf(stderr, "lightwell-camera: %s\n", printable(message).c_str());
  if (!c.calibration_folder.empty())
    if (const Status status = write_calibration(c.calibration_folder, setup->model.calibration); !status)
      return fail(status.error());
  std::optional<TruthFile> truth;
  if (!c.truth.empty()) {
    auto created = TruthFile::create(c.truth);
    if (!created) return fail(created.error());
    truth = *std::move(created);
  }
  std::unique_ptr<TrackerOutput> tracker;
  if (!c.tracking_out.empty()) {
    auto started = TrackerOutput::start(c.tracker, setup->scene);
    if (!started) return fail(started.error());
    tracker = *std::move(started);
  }
  Told told(std::move(truth), std::move(tracker));
  auto camera = GigeCamera::start(c.camera, *setup, [&](const SentFrame& frame) { told.frame(frame); });
  if (!camera) return fail(camera.error());
  announce(c, *setup);
  wait_for_the_end(c, **camera, told, signals);
  (*camera)->stop();
  std::fprintf(stderr, "lightwell-camera: %llu frames sent\n",
               static_cast<unsigned long long>((*camera)->frames()));
  return told.failed() ? fail(told.error()) : 0;
}

int run(int argc, char** argv) {
  CLI::App app("A simulated GigE Vision lighting probe that looks at known light.", "lightwell-camera");
  CommandLine command_line;
  declare(app, command_line);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help
    std::fprintf(stderr, "lightwell-camera: %s\n", error.what());
    return 2;
  }
  return run(command_line);
}

}  // namespace
}  // namespace lightwell::simulator

int main(int argc, char** argv) {
  try {
    return lightwell::simulator::run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "lightwell-camera: %s\n", error.what());
    return 1;
  }
}
