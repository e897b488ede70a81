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

}  // namespace
}  // namespace lightwell
