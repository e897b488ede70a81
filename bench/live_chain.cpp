// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// The whole chain as separate programs over loopback, for as long as is asked: simulated camera → daemon → reader, with
// or without a renderer beside them. Prints what was lost, how late the light was, and what it cost, as JSON.

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "interface/dds_topics.h"
#include "interface/http_client.h"
#include "tests/support/child_process.h"
#include "tests/support/eventually.h"
#include "tests/support/temporary_folder.h"

namespace {

using namespace lightwell;
using Clock = std::chrono::steady_clock;
using Words = std::vector<std::string>;

struct Arguments {
  double seconds = 60;
  std::string size = "640x480", pixel_format = "Mono12p", scenario = "day", out;
  double rate = 60;
  bool renderer = false;
};

struct Resources {
  double rss_mb = 0;
  double cpu_s = 0;
};

Resources resources_of(pid_t pid) {
  Resources r;
  std::ifstream status("/proc/" + std::to_string(pid) + "/status");
  for (std::string line; std::getline(status, line);)
    if (line.rfind("VmRSS:", 0) == 0) r.rss_mb = std::stod(line.substr(6)) / 1024;
  std::ostringstream text;
  text << std::ifstream("/proc/" + std::to_string(pid) + "/stat").rdbuf();
  std::istringstream fields(text.str().substr(text.str().rfind(')') + 2));
  std::string word;
  for (int field = 3; fields >> word; ++field)  // proc(5): 14 and 15 are user and system time in ticks
    if (field == 14 || field == 15) r.cpu_s += std::stod(word) / static_cast<double>(sysconf(_SC_CLK_TCK));
  return r;
}

double quantile(std::vector<double>& values, double q) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(q * static_cast<double>(values.size() - 1))];
}

nlohmann::json status_of(const std::string& http) {
  HttpRequest request;
  request.path = "/api/v1/status";
  const auto response = http_request(http, request);
  return response ? nlohmann::json::parse(response->body, nullptr, false) : nlohmann::json{};
}

Error fail(const std::string& what) {
  return {ErrorKind::failed, what};
}

// One run: camera, daemon and reader from start to end.
Result<nlohmann::json> measure(const Arguments& a, const std::filesystem::path& bin) {
  const test::TemporaryFolder folder;
  const auto path = [&](const char* name) { return (folder.path() / name).string(); };
  const int domain = 100 + static_cast<int>(getpid()) % 100;
  const std::string address =
      "127.88." + std::to_string(getpid() / 250 % 250) + "." + std::to_string(2 + getpid() % 250);

  test::ChildProcess camera(Words{(bin / "lightwell-camera").string(), "--address", address, "--scenario",
                                  a.scenario, "--size", a.size, "--pixel-format", a.pixel_format, "--rate",
                                  std::to_string(a.rate), "--write-calibration", path("calibration")},
                            path("camera.log"));
  if (!camera.wait_for_line("ready")) return fail("camera: " + camera.stderr_text());
  // With the renderer, as many lights as it has maps: none are clustered away.
  const char* lights = a.renderer ? "[lights]\ncount = 72\nclusters = 0\n" : "";
  std::ofstream(path("config")) << "[http]\nlisten = \"127.0.0.1:0\"\n[dds]\ndomain = " << domain << "\n"
                                << lights;
  test::ChildProcess daemon(Words{(bin / "lightwelld").string(), "--config", path("config"), "--source",
                                  "aravis:" + address, "--calibration", path("calibration")},
                            path("daemon.log"));
  const auto url = daemon.wait_for_line("page: http://");
  if (!url) return fail("daemon: " + daemon.stderr_text());
  const std::string http = url->substr(0, url->find('/'));

  DdsOptions dds;
  dds.domain = domain;
  auto opened = DdsDomain::open(dds);
  if (!opened) return fail(opened.error().message);
  auto reader = LightReader::create(*opened);
  if (!reader) return fail(reader.error().message);
  LightFrame frame;
  if (!(*reader)->take(frame, std::chrono::seconds(30))) return fail("no light: " + daemon.stderr_text());

  std::unique_ptr<test::ChildProcess> renderer;
  if (a.renderer)
    renderer = std::make_unique<test::ChildProcess>(
        Words{(bin / "lightwell-render").string(), "--scene",
              (bin / "../share/lightwell/stage.gltf").string(), "--live", "--domain", std::to_string(domain),
              "--headless", "--size", "320x240", "--shadow-maps", "72", "--seconds",
              std::to_string(a.seconds), "--stats", path("stats.json")},
        path("render.log"));

  const auto warm = Clock::now() + std::chrono::seconds(3);  // tables made, rings filled
  while (Clock::now() < warm) (*reader)->take(frame, std::chrono::milliseconds(100));
  const nlohmann::json before = status_of(http);
  const Resources daemon_before = resources_of(daemon.pid()), camera_before = resources_of(camera.pid());
  const auto start = Clock::now();
  std::vector<double> photon_ms;
  double worst_p99 = 0, worst_p50 = 0;
  auto next_look = start + std::chrono::seconds(10);
  while (std::chrono::duration<double>(Clock::now() - start).count() < a.seconds) {
    if ((*reader)->take(frame, std::chrono::milliseconds(200)))
      photon_ms.push_back(static_cast<double>(frame.header.publish_mono_ns - frame.header.capture_mono_ns) *
                          1e-6);
    if (Clock::now() < next_look) continue;
    next_look += std::chrono::seconds(10);
    const auto latency = status_of(http).at("latency_ms");
    worst_p50 = std::max(worst_p50, latency.at("p50").get<double>());
    worst_p99 = std::max(worst_p99, latency.at("p99").get<double>());
  }
  const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
  const nlohmann::json after = status_of(http);
  const Resources daemon_after = resources_of(daemon.pid()), camera_after = resources_of(camera.pid());
  const auto gained = [&](const char* key) {
    return after.at("capture").at(key).get<std::int64_t>() - before.at("capture").at(key).get<std::int64_t>();
  };

  nlohmann::json result = {
      {"size", a.size},
      {"pixel_format", a.pixel_format},
      {"scenario", a.scenario},
      {"rate_hz", a.rate},
      {"seconds", seconds},
      {"published", after.at("published").get<std::int64_t>() - before.at("published").get<std::int64_t>()},
      {"published_hz", static_cast<double>(after.at("published").get<std::int64_t>() -
                                           before.at("published").get<std::int64_t>()) /
                           seconds},
      {"lost", gained("lost")},
      {"incomplete", gained("incomplete")},
      {"skipped", gained("skipped")},
      {"received_to_published_ms", {{"p50", worst_p50}, {"p99", worst_p99}}},
      {"mid_exposure_to_published_ms", {{"p50", quantile(photon_ms, .5)}, {"p99", quantile(photon_ms, .99)}}},
      {"develop_ms", after.at("develop_ms")},
      {"lights_ms", after.at("lights_ms")},
      {"lights", frame.lights.size()},
      {"daemon",
       {{"rss_mb_start", daemon_before.rss_mb},
        {"rss_mb_end", daemon_after.rss_mb},
        {"cores", (daemon_after.cpu_s - daemon_before.cpu_s) / seconds}}},
      {"camera", {{"cores", (camera_after.cpu_s - camera_before.cpu_s) / seconds}}}};
  if (renderer) {
    renderer->wait_for_end(30);
    std::ifstream stats(path("stats.json"));
    const auto s = nlohmann::json::parse(stats, nullptr, false);
    if (s.is_discarded()) return fail("renderer: " + renderer->stderr_text());
    result["renderer"] = {{"hz", s.at("frames").get<double>() / a.seconds},
                          {"ms", s.at("ms")},
                          {"cpu_ms", s.at("cpu_ms")},
                          {"passes", s.at("passes")},
                          {"lights", s.at("lights")},
                          {"shadow_maps", s.at("shadow_maps")},
                          {"gl_renderer", s.at("gl_renderer")}};
  }
  return result;
}

// What the issue asks of every scenario, in short; held: nothing lost, and the rate within 1 %.
Result<nlohmann::json> measure_every_scenario(Arguments a, const std::filesystem::path& bin) {
  nlohmann::json table = nlohmann::json::array();
  for (const auto& [size, rate] : {std::pair("640x480", 60.0), {"1024x1024", 25.0}})
    for (const char* scenario : {"day", "studio", "flicker", "walk", "static"}) {
      a.size = size;
      a.rate = rate;
      a.scenario = scenario;
      const auto run = measure(a, bin);
      if (!run) return Error{run.error().kind, std::string(scenario) + ": " + run.error().message};
      const double published_hz = run->at("published_hz").get<double>();
      const bool whole = run->at("lost") == 0 && run->at("incomplete") == 0 && run->at("skipped") == 0;
      nlohmann::json row;
      for (const char* key : {"size", "scenario", "rate_hz", "published_hz", "lost", "incomplete", "skipped",
                              "mid_exposure_to_published_ms"})
        row[key] = run->at(key);
      row["camera_cores"] = run->at("camera").at("cores");
      row["daemon_cores"] = run->at("daemon").at("cores");
      row["held"] = whole && published_hz > 0.99 * rate;
      std::fprintf(stderr, "%-9s %-8s %6.2f of %g Hz%s\n", size, scenario, published_hz, rate,
                   row["held"].get<bool>() ? "" : "  NOT HELD");
      table.push_back(std::move(row));
    }
  return table;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Simulated camera to published lights over loopback, measured", "live_chain"};
  Arguments a;
  bool every_scenario = false;
  app.add_option("--seconds", a.seconds, "measured time")->check(CLI::Range(1.0, 86400.0));
  app.add_option("--size", a.size, "sensor, WxH");
  app.add_option("--pixel-format", a.pixel_format, "of the camera");
  app.add_option("--scenario", a.scenario, "of the camera");
  app.add_option("--rate", a.rate, "frames a second");
  app.add_flag("--renderer", a.renderer, "lightwell-render beside them, 320x240, 72 lights with maps");
  app.add_flag("--every-scenario", every_scenario,
               "each scenario at 640x480, 60 Hz and at 1024x1024, 25 Hz; --seconds of each");
  CLI11_PARSE(app, argc, argv);
  std::signal(SIGPIPE, SIG_IGN);
  const std::filesystem::path bin = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  const auto result = every_scenario ? measure_every_scenario(a, bin) : measure(a, bin);
  if (!result) {
    std::fprintf(stderr, "live_chain: %s\n", result.error().message.c_str());
    return static_cast<int>(result.error().kind);
  }
  std::printf("%s\n", result->dump(2).c_str());
  return 0;
}
