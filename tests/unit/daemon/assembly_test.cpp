// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/assembly.h"

#include <gtest/gtest.h>

namespace lightwell {
namespace {

TEST(CaptureOptionsOfAConfiguration, BoardThatTriggersHasItsCameraTriggered) {
  Configuration configuration;
  EXPECT_EQ(capture_options(configuration).trigger, "");
  configuration.board.address = "usb";
  EXPECT_EQ(capture_options(configuration).trigger, "") << "a board that only listens";
  configuration.board.trigger_rate = "24000/1001";
  EXPECT_EQ(capture_options(configuration).trigger, "any");
  EXPECT_DOUBLE_EQ(capture_options(configuration).trigger_rate_hz, 24000.0 / 1001);
}

TEST(CaptureOptionsOfAConfiguration, TriggerThatIsGivenStands) {
  Configuration configuration;
  configuration.source.trigger = "Line2";
  EXPECT_EQ(capture_options(configuration).trigger, "Line2");
  configuration.board.address = "usb";
  configuration.board.trigger_rate = "25";
  for (const char* given : {"Line2", "off"}) {
    configuration.source.trigger = given;
    EXPECT_EQ(capture_options(configuration).trigger, given);
    EXPECT_DOUBLE_EQ(capture_options(configuration).trigger_rate_hz, 25);
  }
}

}  // namespace
}  // namespace lightwell
