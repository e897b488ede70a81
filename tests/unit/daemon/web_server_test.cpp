// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/web/server.h"

#include <gmock/gmock.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>

#include "interface/environment_io.h"
#include "interface/light_set_io.h"
#include "tests/support/web_server.h"

namespace lightwell {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;
using test::publish;
using test::WebServerTest;
using testing::HasSubstr;

TEST_F(WebServerTest, ServesThePageAndItsFilesWithoutForeignParts) {
  const auto page = get("/");
  EXPECT_EQ(page.status, 200);
  EXPECT_EQ(page.content_type, "text/html; charset=utf-8");
  EXPECT_THAT(page.body, HasSubstr("<title>Lightwell</title>"));
  EXPECT_EQ(get("/style.css").content_type, "text/css; charset=utf-8");
  EXPECT_EQ(get("/page.js").content_type, "text/javascript; charset=utf-8");
  for (const char* path : {"/", "/style.css", "/page.js"}) {
    const std::string body = get(path).body;
    EXPECT_THAT(body, testing::Not(testing::AnyOf(HasSubstr("http://"), HasSubstr("https://")))) << path;
  }
  EXPECT_THAT(get("/api/openapi.yaml").body, HasSubstr("/api/v1/stream"));
}

TEST_F(WebServerTest, EveryPathOfOpenApiIsServed) {
  publish(channel_, 1);
  const std::string document = get("/api/openapi.yaml").body;
  const std::regex path_line("\n  (/[^\n:]*):\n    (get|post):");
  int paths = 0;
  for (std::sregex_iterator at(document.begin(), document.end(), path_line), end; at != end; ++at) {
    const std::string path = (*at)[1];
    ++paths;
    if (path == "/api/v1/stream") continue;  // does not end
    EXPECT_EQ(get(path).status, (*at)[2] == "get" ? 200 : 405) << path;
  }
  EXPECT_EQ(paths, 8);
}

TEST_F(WebServerTest, StatusIsTheDaemonsWithNullForWhatIsNotKnown) {
  const auto response = get("/api/v1/status");
  EXPECT_EQ(response.content_type, "application/json");
  const json status = json::parse(response.body);
  EXPECT_EQ(status["source"], "aravis:127.0.0.1");
  EXPECT_EQ(status["source_state"], name(SourceState::streaming));
  EXPECT_EQ(status["capture"]["lost"], 7);
  EXPECT_TRUE(status["latency_ms"]["p50"].is_null());
  EXPECT_EQ(status["latency_ms"]["p99"], 2.5);
  EXPECT_EQ(status["recording"]["active"], false);
}

TEST_F(WebServerTest, StatusIsJsonEvenWhenADeviceSendsNonsenseText) {
  control_.change([](DaemonStatus& status) { status.source_description = "bad \xff\xfe \"name\"\n"; });
  EXPECT_TRUE(json::parse(get("/api/v1/status").body)["source_description"].is_string());
}

TEST_F(WebServerTest, NothingPublishedIs503) {
  for (const char* path : {"/api/v1/lights", "/api/v1/environment.exr", "/api/v1/environment.jpg"}) {
    const auto response = get(path);
    EXPECT_EQ(response.status, 503) << path;
    EXPECT_TRUE(json::parse(response.body).contains("error"));
  }
  EXPECT_EQ(get("/metrics").status, 200);
}

TEST_F(WebServerTest, LightsAreALightSetWithTheFramesNumbersBesideIt) {
  publish(channel_, 5, 1.0f);
  const std::string body = get("/api/v1/lights").body;
  const auto set = light_set_from_json(body, "lights");
  ASSERT_TRUE(set) << set.error().message;
  EXPECT_EQ(set->method, "havran");
  EXPECT_TRUE(set->has_parents);
  const auto lease = channel_.wait_newer(0, 0ms);
  ASSERT_EQ(set->lights.size(), lease->lights.size());
  EXPECT_TRUE((set->lights[3].illuminance == lease->lights[3].illuminance).all());
  const json frame = json::parse(body);
  EXPECT_EQ(frame["sequence"], 1005);
  EXPECT_EQ(frame["number"], 5);
  EXPECT_EQ(frame["capture_time_ns"], lease->capture_mono_ns);
  EXPECT_EQ(frame["publish_time_ns"], lease->publish_mono_ns);
  EXPECT_EQ(frame["calibration_id"], "0123456789abcdef");
}

TEST_F(WebServerTest, HarmonicsAndTheFitStandBesideTheLights) {
  publish(channel_, 5, 1.0f);
  const auto lease = channel_.wait_newer(0, 0ms);
  json frame = json::parse(get("/api/v1/lights").body);
  ASSERT_EQ(frame["sh"].size(), 25u);
  EXPECT_EQ(frame["sh"][3][1].get<float>(), lease->harmonics[3][1]);
  EXPECT_FALSE(frame.contains("fit"));
  FitSnapshot fit;
  fit.number = 4;
  fit.sequence = 1004;
  fit.fit = fit_few_lights(lease->map, {.lights = 2}).value();
  control_.set_fit(fit);
  const std::string body = get("/api/v1/lights").body;
  EXPECT_TRUE(light_set_from_json(body, "lights"));
  frame = json::parse(body);
  EXPECT_EQ(frame["fit"]["sequence"], 1004);
  const auto set = light_set_from_json(frame["fit"].dump(), "fit");
  ASSERT_TRUE(set) << set.error().message;
  EXPECT_EQ(set->method, "fit");
  ASSERT_EQ(set->lights.size(), light_set(fit.fit).lights.size());
  EXPECT_EQ(set->lights[0].direction, light_set(fit.fit).lights[0].direction);
  EXPECT_EQ(frame["fit"]["residual"], fit.fit.residual);
}

TEST_F(WebServerTest, EnvironmentExrHoldsTheMapsRadianceInItsPlace) {
  publish(channel_, 1, 1.0f);
  const auto response = get("/api/v1/environment.exr");
  EXPECT_EQ(response.content_type, "image/x-exr");
  const auto read = environment_from_bytes(response.body, "environment.exr");
  ASSERT_TRUE(read) << read.error().message;
  const LatLongImage& image = read->image;
  EXPECT_EQ(image.width, 120);
  EXPECT_EQ(image.height, 60);
  // Back to a polar map by the reader's own way; rows are rings, so nothing was resampled.
  const PolarMap back = polar_map_from_lat_long(image, true);
  const auto lease = channel_.wait_newer(0, 0ms);
  ASSERT_EQ(back.grid, lease->map.grid);
  for (std::size_t bin = 0; bin < back.grid.size(); ++bin)
    for (int c = 0; c < 3; ++c)
      // Area weights are sums of float fractions.
      ASSERT_NEAR(back.rgb(bin)[c], lease->map.rgb(bin)[c], 1e-5f * lease->map.rgb(bin)[c]) << "bin " << bin;
  EXPECT_TRUE((image.at(0, 59) == Rgb::Zero()).all()) << "below the horizon nothing was measured";
}

TEST_F(WebServerTest, EnvironmentJpgIsAJpegAndFollowsTheFrames) {
  publish(channel_, 1, 0);
  const auto first = get("/api/v1/environment.jpg?t=1");
  EXPECT_EQ(first.content_type, "image/jpeg");
  EXPECT_EQ(first.body.substr(0, 3), "\xff\xd8\xff");
  EXPECT_EQ(first.body, get("/api/v1/environment.jpg?t=2").body);
  publish(channel_, 2, 2);
  EXPECT_NE(first.body, get("/api/v1/environment.jpg?t=3").body);
}

TEST_F(WebServerTest, CurlAgrees) {
  if (std::system("curl --version >/dev/null 2>&1") != 0) GTEST_SKIP() << "curl is not installed";
  const std::string command = "curl -sf --max-time 20 http://" + address() + "/api/v1/status";
  FILE* pipe = ::popen(command.c_str(), "r");
  ASSERT_NE(pipe, nullptr);
  std::string body(65536, '\0');
  body.resize(std::fread(body.data(), 1, body.size(), pipe));
  EXPECT_EQ(::pclose(pipe), 0);
  EXPECT_EQ(json::parse(body)["source"], "aravis:127.0.0.1");
}

// The exposition format 0.0.4: each family has HELP and TYPE before its samples, names and labels are well
// formed, values are numbers, no sample comes twice, counters end in _total.
TEST_F(WebServerTest, MetricsFollowTheExpositionFormat) {
  publish(channel_, 1);
  const auto response = get("/metrics");
  EXPECT_EQ(response.content_type, "text/plain; version=0.0.4; charset=utf-8");
  ASSERT_THAT(response.body, testing::EndsWith("\n"));
  const std::regex help("# HELP ([a-z_]+) .+");
  const std::regex type("# TYPE ([a-z_]+) (counter|gauge)");
  const std::regex sample(
      R"re(([a-z_]+)(\{([a-z_]+="([^"\\]|\\["\\n])*",?)+\})? (NaN|[+-]?Inf|[-+0-9.eE]+))re");
  std::set<std::string> families, samples;
  std::string family, kind;
  std::istringstream lines(response.body);
  for (std::string line; std::getline(lines, line);) {
    std::smatch match;
    if (std::regex_match(line, match, help)) {
      EXPECT_TRUE(families.insert(match[1]).second) << "twice: " << line;
      family = match[1];
    } else if (std::regex_match(line, match, type)) {
      EXPECT_EQ(match[1], family);
      kind = match[2];
    } else {
      ASSERT_TRUE(std::regex_match(line, match, sample)) << line;
      EXPECT_EQ(match[1], family);
      EXPECT_EQ(kind == "counter", family.ends_with("_total")) << family;
      EXPECT_TRUE(samples.insert(line.substr(0, line.rfind(' '))).second) << "twice: " << line;
    }
  }
  EXPECT_THAT(families,
              testing::IsSupersetOf({"lightwell_frames_lost_total", "lightwell_latency_seconds",
                                     "lightwell_rate_hertz", "lightwell_recording",
                                     "lightwell_clipped_pixels", "lightwell_frames_published_total"}));
  EXPECT_THAT(response.body, HasSubstr("lightwell_latency_seconds{quantile=\"0.5\"} NaN\n"));
  EXPECT_THAT(response.body, HasSubstr("lightwell_latency_seconds{quantile=\"0.99\"} 0.0025\n"));
  EXPECT_THAT(response.body, HasSubstr("lightwell_frames_lost_total 7\n"));
}

}  // namespace
}  // namespace lightwell
