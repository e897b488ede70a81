// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// The frame path alone over many frames, as fast as it goes: how long a frame takes, and that memory stays where it is.

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "daemon/clock.h"
#include "daemon/pipeline/pipeline.h"
#include "daemon/simulator/frame_generator.h"
#include "daemon/simulator/probe_setup.h"
#include "tests/support/endless_source.h"
#include "tests/support/resident_memory.h"

namespace {

using namespace lightwell;

struct Arguments {
  std::uint64_t frames = 10000;
  int width = 1024, height = 1024;
  std::string pixel_format = "Mono12p", scenario = "day";
};

int run(const Arguments& a) {
  constexpr std::uint64_t kWarm = 200;  // every table is made and every snapshot written once
  simulator::ProbeOptions probe;
  probe.scenario = a.scenario;
  probe.width = a.width;
  probe.height = a.height;
  probe.pixel_format = a.pixel_format;
  const auto setup = simulator::set_up_probe(probe);
  if (!setup) {
    std::fprintf(stderr, "frame_path_run: %s\n", setup.error().message.c_str());
    return static_cast<int>(setup.error().kind);
  }
  std::vector<std::vector<std::byte>> pictures;
  {
    simulator::FrameGenerator generator(setup->scene, setup->model);
    for (int i = 0; i < 4; ++i) {
      pictures.emplace_back(setup->model.format.bytes());
      generator.render(0.5 * (i + 1), setup->exposure_us, static_cast<std::uint64_t>(i),
                       setup->model.format.pixel_format, pictures.back());
    }
  }
  const FramePathOptions options;
  SnapshotChannel snapshots(FramePath::prototype(options));
  double start_bytes = 0, middle_bytes = 0, end_bytes = 0;
  std::int64_t start_ns = 0;
  const auto watch = [&](std::uint64_t taken) {
    if (taken == kWarm) start_bytes = test::resident_bytes(), start_ns = mono_now_ns();
    if (taken == a.frames / 2) middle_bytes = test::resident_bytes();
    if (taken == a.frames) end_bytes = test::resident_bytes();
  };
  const auto source =
      std::make_shared<test::EndlessSource>(setup->model.format, setup->rate_hz, pictures, a.frames, watch);
  Pipeline pipeline(nullptr);
  const Status started =
      pipeline.start(source, std::make_shared<FramePath>(setup->model.calibration, options, snapshots));
  if (!started) return static_cast<int>(started.error().kind);
  std::uint64_t seen = 0;
  while (seen < a.frames)
    if (const auto lease = snapshots.wait_newer(seen, std::chrono::seconds(1))) seen = lease->number;
  const double seconds = static_cast<double>(mono_now_ns() - start_ns) * 1e-9;
  pipeline.stop();
  const FramePath& path = *pipeline.view().path;
  const auto quantiles = [](const LatencyWindow& window) {
    const auto q = window.quantiles();
    return nlohmann::json{{"p50", q.p50}, {"p99", q.p99}};
  };
  constexpr double kMb = 1 << 20;
  const nlohmann::ordered_json result = {
      {"size", std::to_string(a.width) + "x" + std::to_string(a.height)},
      {"pixel_format", a.pixel_format},
      {"scenario", a.scenario},
      {"frames", a.frames},
      {"hz", static_cast<double>(a.frames - kWarm) / seconds},
      {"develop_ms", quantiles(path.develop_ms())},
      {"lights_ms", quantiles(path.lights_ms())},
      {"rss_mb", {{"start", start_bytes / kMb}, {"middle", middle_bytes / kMb}, {"end", end_bytes / kMb}}}};
  std::printf("%s\n", result.dump(2).c_str());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Frames through the frame path as fast as it takes them, with its memory", "frame_path_run"};
  Arguments a;
  app.add_option("--frames", a.frames, "how many")
      ->check(CLI::Range(1000, 100'000'000))
      ->capture_default_str();
  app.add_option("--width", a.width, "of the sensor, pixels")->capture_default_str();
  app.add_option("--height", a.height, "of the sensor, pixels")->capture_default_str();
  app.add_option("--pixel-format", a.pixel_format, "of the camera")->capture_default_str();
  app.add_option("--scenario", a.scenario, "what four frames of it show")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  return run(a);
}
