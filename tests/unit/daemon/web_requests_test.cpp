// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <regex>

#include "tests/support/web_server.h"

namespace lightwell {
namespace {

using nlohmann::json;
using test::publish;
using test::WebServerTest;
using testing::HasSubstr;

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
