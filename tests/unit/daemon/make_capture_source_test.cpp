// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/capture/capture_source.h"
#include "daemon/capture/socket_buffer.h"

namespace lightwell {
namespace {

using testing::HasSubstr;

TEST(MakeCaptureSource, UnknownKindIsUsageAndNamesTheKnown) {
  for (const char* source : {"V4L2:/dev/video0", "camera", "", ":", "ARAVIS:127.0.0.1"}) {
    const auto made = make_capture_source(source, {});
    ASSERT_FALSE(made) << source;
    EXPECT_EQ(made.error().kind, ErrorKind::usage);
    EXPECT_THAT(made.error().message, HasSubstr("aravis:ADDRESS"));
  }
}

TEST(MakeCaptureSource, MissingRestIsUsage) {
  const auto made = make_capture_source("aravis:", {});
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().kind, ErrorKind::usage);
}

TEST(MakeCaptureSource, OptionOutOfRangeIsUsageAndNamesFieldValueAndRange) {
  CaptureOptions options;
  options.buffers = 2;
  const auto made = make_capture_source("aravis:127.0.0.1", options);
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().kind, ErrorKind::usage);
  EXPECT_EQ(made.error().message, "capture buffers 2 is not in 4…64");

  options = {};
  options.rate_hz = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(make_capture_source("aravis:127.0.0.1", options));
  options = {};
  options.pixel_format = "Mono14";
  EXPECT_FALSE(make_capture_source("aravis:127.0.0.1", options));
}

TEST(MakeCaptureSource, MalformedAddressFailsAtStart) {
  for (const char* source : {"aravis:camera.local", "aravis:300.0.0.1", "aravis:1.2.3"}) {
    auto made = make_capture_source(source, {});
    ASSERT_TRUE(made);
    const Status started = (*made)->start();
    ASSERT_FALSE(started) << source;
    EXPECT_EQ(started.error().kind, ErrorKind::usage);
    (*made)->stop();
  }
}

TEST(SocketBufferRemark, SpeaksOnlyWhereAFrameDoesNotFitAndSaysWhatToDo) {
  EXPECT_EQ(socket_buffer_remark(1000, 1000), "");
  EXPECT_THAT(socket_buffer_remark(8 << 20, 4 << 20), HasSubstr("sysctl -w net.core.rmem_max=16777216"));
}

}  // namespace
}  // namespace lightwell
