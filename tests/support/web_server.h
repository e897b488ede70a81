// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cmath>
#include <memory>
#include <string>

#include "daemon/web/server.h"
#include "interface/http_client.h"
#include "tests/support/fake_daemon.h"

namespace lightwell::test {

// A server of its own before a daemon that is not there.
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

  SnapshotChannel channel_{snapshot_shape()};
  FakeControl control_;
  std::unique_ptr<WebServer> server_;
};

}  // namespace lightwell::test
