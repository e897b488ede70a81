// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/web/listen_address.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace lightwell {
namespace {

TEST(ListenAddress, LoopbackIsTakenAndTheRestRefusedWithTokenAndTlsNamed) {
  for (const char* good : {"127.0.0.1:8650", "127.0.0.2:0", "localhost:80", "[::1]:8650"})
    EXPECT_TRUE(check_listen_address(good)) << good;
  for (const char* open :
       {"0.0.0.0:8650", "[::]:8650", "192.168.1.5:80", "probe.local:80", "127.0.0.1.example:80"}) {
    const Status status = check_listen_address(open);
    ASSERT_FALSE(status) << open;
    EXPECT_EQ(status.error().kind, ErrorKind::usage);
    EXPECT_THAT(status.error().message,
                testing::AllOf(testing::HasSubstr("[http] listen"), testing::HasSubstr("TLS"),
                               testing::HasSubstr("token"), testing::HasSubstr(open)));
  }
  for (const char* wrong : {"", "8650", "127.0.0.1", "127.0.0.1:70000"})
    EXPECT_EQ(check_listen_address(wrong).error().kind, ErrorKind::usage) << wrong;
}

TEST(ListenAddress, HostHeadersOfLoopbackWithAndWithoutPort) {
  for (const char* good : {"127.0.0.1", "127.0.0.1:1", "localhost", "localhost:8650", "[::1]", "[::1]:8650"})
    EXPECT_TRUE(is_loopback_host_header(good)) << good;
  for (const char* bad :
       {"", ":", "example.com", "example.com:80", "localhost.example.com", "127.0.0.1.example.com:80",
        "[::2]:1", "::1", "localhost:", "localhost:x", "10.0.0.1", "127.0.0.1@example.com"})
    EXPECT_FALSE(is_loopback_host_header(bad)) << bad;
}

TEST(ListenAddress, OwnOriginIsTheSameSchemeHostAndPort) {
  EXPECT_TRUE(is_own_origin("http://localhost:8650", "localhost:8650"));
  for (const char* foreign : {"http://localhost:8651", "https://localhost:8650", "http://127.0.0.1:8650",
                              "null", "http://localhost:8650.example.com", ""})
    EXPECT_FALSE(is_own_origin(foreign, "localhost:8650")) << foreign;
}

}  // namespace
}  // namespace lightwell
