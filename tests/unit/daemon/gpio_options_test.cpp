// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "daemon/assembly.h"

namespace lightwell {
namespace {

using testing::AllOf;
using testing::HasSubstr;

Configuration with_lines() {
  Configuration configuration;
  configuration.board.address = "gpio:/dev/gpiochip0";
  configuration.board.trigger_line = "17";
  configuration.board.strobe_line = "STROBE";
  configuration.board.trigger_rate = "30000/1001";
  return configuration;
}

TEST(GpioOptions, LinesRateAndPulseAreTaken) {
  Configuration configuration = with_lines();
  configuration.board.pulse_us = 250;
  const auto options = gpio_options(configuration);
  ASSERT_TRUE(options && *options);
  EXPECT_EQ((*options)->chip, "/dev/gpiochip0");
  EXPECT_EQ((*options)->trigger_line, "17");
  EXPECT_EQ((*options)->strobe_line, "STROBE");
  EXPECT_EQ((*options)->pulses.rate_numerator, 30000U);
  EXPECT_EQ((*options)->pulses.rate_denominator, 1001U);
  EXPECT_EQ((*options)->pulses.pulse_ns, 250'000U);
  const auto board = board_options(configuration);
  ASSERT_TRUE(board);
  EXPECT_FALSE(*board) << "no board";
}

TEST(GpioOptions, AStrobeAloneNeedsNoRate) {
  Configuration configuration = with_lines();
  configuration.board.trigger_line = configuration.board.trigger_rate = "";
  const auto options = gpio_options(configuration);
  EXPECT_TRUE(options && *options);
}

TEST(GpioOptions, ABoardHasNone) {
  Configuration configuration;
  configuration.board.address = "usb";
  const auto options = gpio_options(configuration);
  ASSERT_TRUE(options);
  EXPECT_FALSE(*options);
}

TEST(GpioOptions, WhatDoesNotGoTogetherIsNamedWithWhatIsAllowed) {
  const auto refused = [](const std::function<void(Configuration::Board&)>& change) {
    Configuration configuration = with_lines();
    change(configuration.board);
    const auto options = gpio_options(configuration);
    if (options) return std::string("taken");
    EXPECT_EQ(options.error().kind, ErrorKind::usage);
    return options.error().message;
  };
  using Board = Configuration::Board;
  EXPECT_THAT(refused([](Board& b) { b.address = "usb"; }),
              AllOf(HasSubstr("trigger_line"), HasSubstr("gpio")));
  EXPECT_THAT(refused([](Board& b) { b.address = "gpio:"; }), HasSubstr("gpio:/dev/gpiochipN"));
  EXPECT_THAT(refused([](Board& b) { b.trigger_line = b.strobe_line = ""; }), HasSubstr("strobe_line"));
  EXPECT_THAT(refused([](Board& b) { b.strobe_line = "17"; }), HasSubstr("another line"));
  EXPECT_THAT(refused([](Board& b) { b.reference = "pulse"; }), HasSubstr("board.reference = \"pulse\""));
  EXPECT_THAT(refused([](Board& b) { b.avoid_flicker = true; }), HasSubstr("board.avoid_flicker"));
  EXPECT_THAT(refused([](Board& b) { b.axes = "x,y,z"; }), HasSubstr("board.axes"));
  EXPECT_THAT(refused([](Board& b) { b.trigger_line = ""; }), HasSubstr("without trigger_line"));
  EXPECT_THAT(refused([](Board& b) { b.trigger_rate = ""; }), HasSubstr("board.trigger_rate"));
  EXPECT_THAT(refused([](Board& b) { b.trigger_rate = "1001"; }), HasSubstr("1 to 1000"));
  EXPECT_THAT(refused([](Board& b) { b.trigger_rate = "1/2"; }), HasSubstr("1 to 1000"));
  EXPECT_THAT(refused([](Board& b) { b.trigger_rate = "100", b.pulse_us = 5001; }),
              HasSubstr("at most 5000"));
}

}  // namespace
}  // namespace lightwell
