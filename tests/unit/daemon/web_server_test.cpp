// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/web/server.h"

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <thread>

#include "daemon/web/pictures.h"
#include "interface/environment_io.h"
#include "interface/http_client.h"
#include "interface/light_set_io.h"
#include "tests/support/fake_daemon.h"

namespace lightwell {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;
using test::publish;
using testing::HasSubstr;

class WebServerTest : public testing::Test {
 protected:
  WebServerTest() : server_(WebServer::start({.listen = "127.0.0.1:0"}, channel_, control_).value()) {
    control_.change([](DaemonStatus& status) {
      status.version = "0.1.0";
      status.source = "aravis:127.0.0.1";
      status.source_state = SourceState::streaming;
      status.capture.lost = 7;
      status.latency_ms_p50 = std::nan("");
      status.latency_ms_p99 = 2.5;
      status.calibration_id = "quote\"back\\slash";
    });
  }
  [[nodiscard]] std::string address() const { return "127.0.0.1:" + std::to_string(server_->port()); }
  HttpResponse ask(HttpRequest request) const {
    auto response = http_request(address(), request);
    EXPECT_TRUE(response) << response.error().message;
    return response ? *response : HttpResponse{};
  }
  HttpResponse get(const std::string& path) const { return ask({.path = path}); }
  HttpResponse record(const std::string& body) const {
    return ask({.method = "POST", .path = "/api/v1/record", .body = body});
  }

  // All that comes back for the request line and `Host: localhost`, as bytes.
  [[nodiscard]] std::string exchange(const std::string& line, const std::string& headers = "") const {
    const int socket = ::socket(AF_INET, SOCK_STREAM, 0);
    const timeval patience{20, 0};
    ::setsockopt(socket, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(static_cast<std::uint16_t>(server_->port()));
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(::connect(socket, reinterpret_cast<sockaddr*>(&to), sizeof to), 0);
    const std::string request =
        line + " HTTP/1.1\r\nHost: localhost\r\n" + headers + "Connection: close\r\n\r\n";
    EXPECT_EQ(::send(socket, request.data(), request.size(), 0), static_cast<ssize_t>(request.size()));
    std::string answer;
    char buffer[65536];
    for (ssize_t n = 0; (n = ::recv(socket, buffer, sizeof buffer, 0)) > 0;)
      answer.append(buffer, static_cast<std::size_t>(n));
    ::close(socket);
    return answer;
  }

  SnapshotChannel channel_{test::snapshot_shape()};
  test::FakeControl control_;
  std::unique_ptr<WebServer> server_;
};

// A client of the event stream on a plain socket, so that it can also be one that does not read.
class StreamClient {
 public:
  explicit StreamClient(int port, int receive_buffer = 0) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    if (receive_buffer > 0)
      ::setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &receive_buffer, sizeof receive_buffer);
    const timeval patience{20, 0};
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(::connect(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    const std::string request = "GET /api/v1/stream HTTP/1.1\r\nHost: localhost\r\n\r\n";
    EXPECT_EQ(::send(socket_, request.data(), request.size(), 0), static_cast<ssize_t>(request.size()));
  }
  ~StreamClient() { ::close(socket_); }
  StreamClient(const StreamClient&) = delete;
  StreamClient& operator=(const StreamClient&) = delete;

  // The headers are here: the server knows this client.
  void wait_open() {
    while (text_.find("retry:") == std::string::npos && receive()) {
    }
  }
  // The next event's data; chunk borders of HTTP lie outside of it. Null at the end of the stream.
  json next() {
    for (;;) {
      const auto at = text_.find("data: ");
      const auto end = at == std::string::npos ? at : text_.find("\n\n", at);
      if (end != std::string::npos) {
        const std::string data = text_.substr(at + 6, end - at - 6);
        text_.erase(0, end + 2);
        return json::parse(data);
      }
      if (!receive()) return {};
    }
  }

 private:
  bool receive() {
    char buffer[65536];
    const ssize_t n = ::recv(socket_, buffer, sizeof buffer, 0);
    if (n > 0) text_.append(buffer, static_cast<std::size_t>(n));
    return n > 0;
  }
  int socket_;
  std::string text_;
};

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

TEST(FisheyePicture, PutsPlusZAtTheTopAndPlusXAtTheRight) {
  PolarMap map = PolarMap::make({.rings = 9, .sectors = 36}, 1);
  std::fill(map.radiance.begin(), map.radiance.end(), 1.0f);
  // Bright near the horizon around azimuth 90°, which is +X.
  for (int ring = 6; ring < 9; ++ring)
    for (int sector = 7; sector < 11; ++sector)
      map.radiance[static_cast<std::size_t>(ring * 36 + sector)] = 50.0f;
  const auto picture = fisheye_picture(map, 101);
  const auto value = [&](int x, int y) { return picture[static_cast<std::size_t>((y * 101 + x) * 3)]; };
  EXPECT_GT(value(93, 50), value(50, 7));
  EXPECT_GT(value(93, 50), value(7, 50));
  EXPECT_EQ(value(50, 7), value(50, 93));
  EXPECT_EQ(value(0, 0), 0) << "outside the circle";
}

TEST(FisheyePicture, AnyMapGivesAPicture) {
  for (const int channels : {1, 3})
    for (const float level : {0.0f, 1e-30f, 1.0f, 1e30f}) {
      PolarMap map = PolarMap::make({.rings = 1, .sectors = 1, .theta_max_rad = 1.7}, channels);
      std::fill(map.radiance.begin(), map.radiance.end(), level);
      EXPECT_EQ(fisheye_picture(map, 7).size(), 147u);
    }
}

TEST_F(WebServerTest, StreamBringsEachFrameOnceInOrder) {
  publish(channel_, 1);
  StreamClient client(server_->port());
  EXPECT_EQ(client.next()["sequence"], 1001) << "the newest comes at once";
  for (std::uint64_t number = 2; number <= 30; ++number) {
    publish(channel_, number);
    const json event = client.next();
    EXPECT_EQ(event["sequence"], 1000 + number);
    EXPECT_LT(event["capture_time_ns"], event["publish_time_ns"]);
    EXPECT_EQ(event["total_illuminance"].size(), 3u);
    ASSERT_EQ(event["lights"].size(), 72u);
    EXPECT_EQ(event["lights"][1]["parent"], 0);
    EXPECT_EQ(event["lights"][1]["direction"].size(), 3u);
  }
}

TEST_F(WebServerTest, FiftyClientsThatDoNotReadCostTheOthersNothing) {
  publish(channel_, 1);
  std::vector<std::unique_ptr<StreamClient>> idle;
  for (int i = 0; i < 50; ++i) {
    idle.push_back(std::make_unique<StreamClient>(server_->port(), 4096));
    idle.back()->wait_open();
  }
  StreamClient reader(server_->port());
  EXPECT_EQ(reader.next()["sequence"], 1001);
  // 600 events of 10 kB: 25 times what may wait for a client.
  for (std::uint64_t number = 2; number <= 600; ++number) {
    publish(channel_, number);
    ASSERT_EQ(reader.next()["sequence"], 1000 + number);
  }
  const std::string metrics = get("/metrics").body;
  EXPECT_THAT(metrics, HasSubstr("lightwell_stream_clients 51\n"));
  std::smatch dropped;
  ASSERT_TRUE(std::regex_search(metrics, dropped, std::regex("\nlightwell_stream_dropped_total (\\S+)\n")));
  EXPECT_GT(std::stod(dropped[1]), 0) << "what does not fit is dropped, not remembered";
  // One that wakes up gets what was waiting for it, a gap, and then the newest.
  std::uint64_t last = 0;
  while (last < 1600) {
    const json event = idle[0]->next();
    ASSERT_FALSE(event.is_null());
    EXPECT_GT(event["sequence"].get<std::uint64_t>(), last);
    last = event["sequence"];
  }
}

TEST_F(WebServerTest, ClientsThatLeaveAreForgotten) {
  publish(channel_, 1);
  for (int i = 0; i < 20; ++i) StreamClient(server_->port()).wait_open();
  std::uint64_t number = 1;
  while (get("/metrics").body.find("lightwell_stream_clients 0\n") == std::string::npos)
    publish(channel_, ++number);
}

TEST_F(WebServerTest, ServerStopsWithOpenStreams) {
  publish(channel_, 1);
  StreamClient client(server_->port());
  client.wait_open();
  server_.reset();
  while (!client.next().is_null()) {
  }
}

TEST_F(WebServerTest, ForeignHostOrOriginIsRefusedEverywhere) {
  publish(channel_, 1);
  const std::string own = "http://" + address();
  for (const std::string path :
       {"/", "/api/v1/status", "/api/v1/lights", "/api/v1/stream", "/metrics", "/nothing"}) {
    for (const std::string host :
         {"evil.example", "evil.example:80", "192.168.0.1", "127.0.0.1.evil.example", ""})
      EXPECT_EQ(ask({.path = path, .headers = {{"Host", host}}}).status, 403) << path << " " << host;
    for (const std::string origin :
         {"http://evil.example", "null", "http://localhost:1", "https://127.0.0.1"})
      EXPECT_EQ(ask({.path = path, .headers = {{"Origin", origin}}}).status, 403) << path << " " << origin;
  }
  EXPECT_EQ(get("http://evil.example/api/v1/status").status, 403);
  EXPECT_EQ(get("//evil.example/api/v1/status").status, 404);  // a path, of which there is none
  EXPECT_EQ(ask({.path = "/api/v1/status", .headers = {{"Origin", own}}}).status, 200);
  EXPECT_EQ(ask({.path = "/api/v1/status", .headers = {{"Host", "localhost:9"}}}).status, 200);
  const std::string start = R"({"action": "start", "file": "a.mkv"})";
  EXPECT_EQ(ask({.method = "POST",
                 .path = "/api/v1/record",
                 .body = start,
                 .headers = {{"Origin", "http://evil.example"}}})
                .status,
            403);
  EXPECT_EQ(
      ask({.method = "POST", .path = "/api/v1/record", .body = start, .headers = {{"Host", "evil.example"}}})
          .status,
      403);
  EXPECT_FALSE(control_.status().recording.active);
}

TEST_F(WebServerTest, RecordStartsAndStops) {
  const auto started = record(R"({"action": "start", "file": "take 1_a-b.mkv"})");
  EXPECT_EQ(started.status, 200) << started.body;
  EXPECT_EQ(json::parse(started.body)["recording"]["file"], "take 1_a-b.mkv");
  EXPECT_TRUE(control_.status().recording.active);
  const auto again = record(R"({"action": "start", "file": "other.mkv"})");
  EXPECT_EQ(again.status, 409);
  EXPECT_THAT(json::parse(again.body)["error"], HasSubstr("already recording"));
  EXPECT_EQ(record(R"({"action": "stop"})").status, 200);
  EXPECT_EQ(record(R"({"action": "stop"})").status, 409);
}

TEST_F(WebServerTest, RecordTakesPlainNamesOnly) {
  for (const char* name :
       {"../a.mkv", "/etc/a.mkv", "a/b.mkv", "..", ".mkv", ".a.mkv", "-a.mkv", "a.txt", "", "a\\u0000.mkv",
        "a\\n.mkv", "a;b.mkv", "%2e%2e%2fa.mkv", "\\u00e9.mkv", "a\\\\b.mkv"})
    EXPECT_EQ(record(std::string(R"({"action": "start", "file": ")") + name + "\"}").status, 400) << name;
  EXPECT_EQ(record(R"({"action": "start", "file": ")" + std::string(200, 'a') + ".mkv\"}").status, 400);
  EXPECT_EQ(record(R"({"action": "start", "file": 5})").status, 400);
  EXPECT_EQ(record(R"({"action": "start"})").status, 400);
  EXPECT_FALSE(control_.status().recording.active);
}

TEST_F(WebServerTest, MalformedRequestsAre400) {
  for (const char* body : {"", "{", "[]", "5", "null", "{\"action\": \"erase\"}", "{\"action\": 1}",
                           "\xff\xfe", "{\"action\": \"start\", \"file\": \"a.mkv\"} trailing"})
    EXPECT_EQ(record(body).status, 400) << body;
  const std::string deep(60'000, '[');
  EXPECT_EQ(record(deep).status, 400);
}

TEST_F(WebServerTest, OversizedBodyIs413) {
  EXPECT_EQ(record(std::string(70'000, ' ')).status, 413);
  EXPECT_EQ(get("/api/v1/status").status, 200);
}

TEST_F(WebServerTest, OtherMethodsAre405AndOtherPaths404) {
  for (const char* method : {"PUT", "DELETE", "OPTIONS", "PATCH", "POST"})
    EXPECT_EQ(ask({.method = method, .path = "/api/v1/status"}).status, 405) << method;
  EXPECT_EQ(get("/api/v1/record").status, 405);
  for (const char* path :
       {"/nothing", "/api/v1/status/", "/api/v2/status", "/../etc/passwd", "/index.html/..", "/openapi.yaml",
        "/%2e%2e/etc/passwd", "//", "//api/v1/status", "//api/v1/record"}) {
    const auto response = get(path);
    EXPECT_EQ(response.status, 404) << path;
    EXPECT_TRUE(json::parse(response.body).contains("error"));
  }
}

TEST_F(WebServerTest, HeadIsGetWithoutTheBody) {
  publish(channel_, 1);
  const std::regex length("Content-Length: ([0-9]+)\r\n");
  const std::regex date("Date: [^\r]*\r\n");
  for (const std::string path : {"/", "/page.js", "/api/v1/lights", "/api/v1/environment.exr", "/nothing"}) {
    const std::string got = exchange("GET " + path);
    const std::string head = exchange("HEAD " + path);
    const auto end = got.find("\r\n\r\n");
    ASSERT_NE(end, std::string::npos) << path;
    EXPECT_EQ(std::regex_replace(head, date, ""), std::regex_replace(got.substr(0, end + 4), date, ""))
        << path;
    std::smatch said;
    ASSERT_TRUE(std::regex_search(head, said, length)) << head;
    EXPECT_EQ(std::stoul(said[1]), got.size() - end - 4) << path;
  }
  const std::string stream = exchange("HEAD /api/v1/stream");
  EXPECT_THAT(stream, testing::StartsWith("HTTP/1.1 200 OK\r\n"));
  EXPECT_THAT(stream, HasSubstr("Content-Type: text/event-stream\r\n"));
  EXPECT_THAT(stream, testing::EndsWith("\r\n\r\n"));
  EXPECT_THAT(exchange("HEAD /api/v1/record"), testing::StartsWith("HTTP/1.1 405 "));
}

TEST_F(WebServerTest, MoreThanOneHostIs400) {
  EXPECT_THAT(exchange("GET /api/v1/status", "host: localhost\r\n"), testing::StartsWith("HTTP/1.1 400 "));
  EXPECT_THAT(exchange("GET /api/v1/status", "Host: evil.example\r\n"), testing::StartsWith("HTTP/1.1 400 "));
  EXPECT_THAT(exchange("GET /api/v1/status"), testing::StartsWith("HTTP/1.1 200 "));
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

TEST(WebServer, AddressInUseAndBeyondLoopbackAreRefused) {
  SnapshotChannel channel(test::snapshot_shape());
  test::FakeControl control;
  const auto first = WebServer::start({.listen = "127.0.0.1:0"}, channel, control).value();
  EXPECT_EQ(first->url(), "http://127.0.0.1:" + std::to_string(first->port()) + "/");
  const auto second =
      WebServer::start({.listen = "127.0.0.1:" + std::to_string(first->port())}, channel, control);
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().kind, ErrorKind::failed);
  EXPECT_THAT(second.error().message, HasSubstr(std::to_string(first->port())));
  const auto open = WebServer::start({.listen = "0.0.0.0:0"}, channel, control);
  ASSERT_FALSE(open);
  EXPECT_EQ(open.error().kind, ErrorKind::usage);
}

}  // namespace
}  // namespace lightwell
