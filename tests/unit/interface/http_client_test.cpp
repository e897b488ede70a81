// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/http_client.h"

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <string>
#include <thread>

#include "interface/host_port.h"

namespace lightwell {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

// Listens on a port of its own and answers one connection with fixed bytes; an empty answer never comes.
class OneAnswer {
 public:
  explicit OneAnswer(std::string answer)
      : answer_(std::move(answer)), listener_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(::bind(listener_, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    EXPECT_EQ(::listen(listener_, 4), 0);
    socklen_t size = sizeof address;
    ::getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size);
    address_ = "127.0.0.1:" + std::to_string(ntohs(address.sin_port));
    thread_ = std::thread([this] { serve(); });
  }
  ~OneAnswer() {
    ::shutdown(listener_, SHUT_RDWR);
    thread_.join();
    ::close(listener_);
  }
  [[nodiscard]] const std::string& address() const { return address_; }
  // What was asked; after the answer.
  std::string asked;

 private:
  void serve() {
    const int peer = ::accept(listener_, nullptr, nullptr);
    if (peer < 0) return;
    char buffer[4096];
    // An empty answer: reads until the client gives up.
    for (;;) {
      const ssize_t n = ::recv(peer, buffer, sizeof buffer, 0);
      if (n <= 0) break;
      asked.append(buffer, static_cast<std::size_t>(n));
      if (answer_.empty() || asked.find("\r\n\r\n") == std::string::npos) continue;
      EXPECT_EQ(::send(peer, answer_.data(), answer_.size(), MSG_NOSIGNAL),
                static_cast<ssize_t>(answer_.size()));
      break;
    }
    ::close(peer);
  }
  std::string answer_;
  int listener_;
  std::string address_;
  std::thread thread_;
};

TEST(HttpClient, ReturnsStatusTypeAndBodyOfAnyAnswer) {
  for (const char* status : {"200 OK", "404 Not Found", "503 Service Unavailable"}) {
    OneAnswer server(std::string("HTTP/1.1 ") + status +
                     "\r\nContent-Type: text/plain\r\nContent-Length: 5\r\n\r\nhello");
    const auto response =
        http_request(server.address(), {.path = "/x?y=1", .headers = {{"Origin", "http://a.b"}}});
    ASSERT_TRUE(response) << response.error().message;
    EXPECT_EQ(response->status, std::atoi(status));
    EXPECT_EQ(response->content_type, "text/plain");
    EXPECT_EQ(response->body, "hello");
    EXPECT_THAT(server.asked, testing::StartsWith("GET /x?y=1 HTTP/1.1\r\n"));
    EXPECT_THAT(server.asked, HasSubstr("Host: " + server.address() + "\r\n"));
    EXPECT_THAT(server.asked, HasSubstr("Origin: http://a.b\r\n"));
  }
}

TEST(HttpClient, PostCarriesItsBody) {
  OneAnswer server("HTTP/1.1 204 No Content\r\n\r\n");
  const auto response = http_request(server.address(), {.method = "POST", .path = "/", .body = "{\"a\": 1}"});
  ASSERT_TRUE(response) << response.error().message;
  EXPECT_EQ(response->status, 204);
  EXPECT_THAT(server.asked, HasSubstr("Content-Length: 8\r\n"));
  EXPECT_THAT(server.asked, HasSubstr("Content-Type: application/json\r\n"));
}

TEST(HttpClient, NobodyListeningIsOneLineThatNamesTheAddress) {
  std::string address;
  {
    const OneAnswer gone("");
    address = gone.address();
  }
  const auto response = http_request(address, {.path = "/api/v1/status"});
  ASSERT_FALSE(response);
  EXPECT_EQ(response.error().kind, ErrorKind::failed);
  EXPECT_THAT(response.error().message, HasSubstr(address));
  EXPECT_EQ(response.error().message.find('\n'), std::string::npos);
}

TEST(HttpClient, SilentServerTimesOut) {
  OneAnswer server("");
  const auto response = http_request(server.address(), {.timeout = 50ms});
  ASSERT_FALSE(response);
  EXPECT_THAT(response.error().message, HasSubstr("no answer in time"));
}

TEST(HttpClient, AnswerThatIsNotHttpOrTooLargeFails) {
  {
    OneAnswer server("garbage\r\n\r\n");
    EXPECT_FALSE(http_request(server.address(), {}));
  }
  OneAnswer server("HTTP/1.1 200 OK\r\nContent-Length: 50\r\n\r\n" + std::string(50, 'x'));
  EXPECT_FALSE(http_request(server.address(), {.body_limit_bytes = 49}));
}

TEST(HttpClient, WrongAddressAndMethodAreUsage) {
  EXPECT_EQ(http_request("localhost", {}).error().kind, ErrorKind::usage);
  EXPECT_EQ(http_request("127.0.0.1:1", {.method = "BREW"}).error().kind, ErrorKind::usage);
}

TEST(HostPort, ReadsAddressesAndRefusesTheRest) {
  EXPECT_EQ(parse_host_port("127.0.0.1:8650")->host, "127.0.0.1");
  EXPECT_EQ(parse_host_port("127.0.0.1:8650")->port, 8650);
  EXPECT_EQ(parse_host_port("[::1]:0")->host, "::1");
  EXPECT_EQ(parse_host_port("probe.local:65535")->port, 65535);
  for (const char* wrong : {"", ":", ":80", "a", "a:", "a:x", "a:65536", "a:-1", "a:80x", "::1:80", "[]:80",
                            "a b:80", "a/b:80", "[::1]", "a:99999999999999999999"})
    EXPECT_EQ(parse_host_port(wrong).error().kind, ErrorKind::usage) << wrong;
}

TEST(HostPort, LoopbackIsByNumberOrLocalhostAlone) {
  for (const char* yes : {"127.0.0.1", "127.255.0.3", "::1", "localhost"})
    EXPECT_TRUE(is_loopback(yes)) << yes;
  for (const char* no :
       {"128.0.0.1", "0.0.0.0", "::", "localhost.example.com", "127.0.0.1.example.com", "127.1", ""})
    EXPECT_FALSE(is_loopback(no)) << no;
}

}  // namespace
}  // namespace lightwell
