// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// Temperature, button, LED and the two watchdogs.
#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "firmware/core/button.h"
#include "firmware/core/guard.h"
#include "firmware/core/lamp.h"
#include "firmware/core/temperature.h"

namespace {

TEST(Temperature, CodesAreThoseOfTheDataSheets) {
  // Texas Instruments SBOS288, table of the TMP105's digital output.
  EXPECT_EQ(temperature_of_tmp105(0x7FF0), 127'937);
  EXPECT_EQ(temperature_of_tmp105(0x6400), 100'000);
  EXPECT_EQ(temperature_of_tmp105(0x1900), 25'000);
  EXPECT_EQ(temperature_of_tmp105(0x0040), 250);
  EXPECT_EQ(temperature_of_tmp105(0x0000), 0);
  EXPECT_EQ(temperature_of_tmp105(0xFFC0), -250);
  EXPECT_EQ(temperature_of_tmp105(0xE700), -25'000);
  EXPECT_EQ(temperature_of_tmp105(0xC900), -55'000);
  EXPECT_EQ(temperature_of_stm32(944, 944, 1210), 30'000);
  EXPECT_EQ(temperature_of_stm32(1210, 944, 1210), 110'000);
  EXPECT_EQ(temperature_of_stm32(1077, 944, 1210), 70'000);
  EXPECT_EQ(temperature_of_stm32(1000, 0xFFFF, 0xFFFF), INT32_MAX);  // never calibrated
}

TEST(Temperature, SpikesAndBusErrorsDoNotPass) {
  temperature self{};
  temperature_init(&self);
  std::int32_t filtered = 0;
  EXPECT_FALSE(temperature_sample(&self, 25'000, &filtered));
  EXPECT_FALSE(temperature_sample(&self, INT32_MAX, &filtered));
  EXPECT_FALSE(temperature_sample(&self, 25'000, &filtered));
  EXPECT_TRUE(temperature_sample(&self, 25'000, &filtered));
  for (int i = 0; i < 100; ++i) {
    EXPECT_TRUE(temperature_sample(&self, i % 4 == 0 ? 125'000 : i % 7 == 0 ? INT32_MAX : 25'000, &filtered));
    EXPECT_EQ(filtered, 25'000);
  }
  for (int i = 0; i < 100; ++i) temperature_sample(&self, -10'000, &filtered);
  EXPECT_NEAR(filtered, -10'000, 1);  // an eighth a sample: 35 °C are below 1 m°C after 80
}

// Presses out of a level sampled every 2 ms.
std::vector<sync_press> presses(const std::vector<std::pair<bool, std::uint32_t>>& levels,
                                std::uint32_t start = 0) {
  button self;
  button_init(&self, start);
  std::vector<sync_press> found;
  std::uint32_t now = start;
  for (const auto& [level, ms] : levels)
    for (const std::uint32_t end = now + ms; now != end; now += 2) {
      sync_press press;
      if (button_sample(&self, level, now, &press)) found.push_back(press);
    }
  return found;
}

TEST(Button, OneShortPressWhateverItBounces) {
  for (const std::uint32_t start : {0u, 0xFFFFFFF0u})  // and across the wrap
    EXPECT_EQ(presses({{false, 50},
                       {true, 4},
                       {false, 2},
                       {true, 6},
                       {false, 4},
                       {true, 200},
                       {false, 4},
                       {true, 2},
                       {false, 100}},
                      start),
              std::vector{SYNC_BUTTON_SHORT});
}

TEST(Button, ALongPressIsToldWhileHeldAndNotAgainWhenLetGo) {
  EXPECT_EQ(presses({{true, 1100}}), std::vector{SYNC_BUTTON_LONG});
  EXPECT_EQ(presses({{true, 5000}, {false, 500}, {true, 100}, {false, 100}}),
            (std::vector{SYNC_BUTTON_LONG, SYNC_BUTTON_SHORT}));
}

TEST(Button, NoiseShorterThanItsSettlingIsNoPress) {
  std::vector<std::pair<bool, std::uint32_t>> noise;
  std::mt19937 random(1);
  for (int i = 0; i < 1000; ++i) noise.emplace_back(i % 2 == 0, 2 * (1 + random() % 9));
  EXPECT_TRUE(presses(noise).empty());
}

TEST(Lamp, EveryStateLooksDifferent) {
  const auto seconds = [](lamp shows) {
    int lit = 0, changes = 0;
    for (std::uint32_t ms = 0; ms < 4000; ++ms) {
      lit += lamp_is_lit(shows, ms);
      changes += lamp_is_lit(shows, ms) != lamp_is_lit(shows, ms + 1);
    }
    return std::pair{lit, changes};
  };
  EXPECT_EQ(seconds(LAMP_ALONE), (std::pair{100, 4}));
  EXPECT_EQ(seconds(LAMP_IDLE), (std::pair{500, 500}));
  EXPECT_EQ(seconds(LAMP_LIVE), (std::pair{4000, 0}));
  EXPECT_EQ(seconds(LAMP_RECORDING), (std::pair{2000, 8}));
  EXPECT_EQ(seconds(LAMP_TROUBLE), (std::pair{2000, 40}));
}

TEST(HostGuard, SilenceIsNoticedOnceAndForAllUntilAWord) {
  host_guard self;
  host_guard_init(&self, 1000, 0xFFFFFF00u);
  EXPECT_FALSE(host_guard_silent(&self, 0xFFFFFF00u + 1000));
  EXPECT_TRUE(host_guard_silent(&self, 0xFFFFFF00u + 1001));
  EXPECT_TRUE(host_guard_silent(&self, 0xFFFFFF00u));  // 49 days later the counter is back
  host_guard_heard(&self, 5000);
  EXPECT_FALSE(host_guard_silent(&self, 6000));
  host_guard_init(&self, 0, 0);
  EXPECT_FALSE(host_guard_silent(&self, 4'000'000'000u));
}

TEST(CameraGuard, ACameraThatDoesNotAnswerIsSwitchedOffAndOn) {
  camera_guard self{};
  camera_guard_init(&self, true, 1000, 300, 0);
  std::uint32_t now = 0;
  for (; now < 3000; ++now)
    EXPECT_TRUE(camera_guard_power(&self, true, now));  // it starts: four times as long
  camera_guard_answered(&self, now);
  for (const std::uint32_t end = now + 1000; now <= end; ++now)
    EXPECT_TRUE(camera_guard_power(&self, true, now));
  for (const std::uint32_t end = now + 300; now < end; ++now)
    EXPECT_FALSE(camera_guard_power(&self, true, now)) << now;
  EXPECT_TRUE(camera_guard_power(&self, true, now));
  EXPECT_EQ(self.cycles, 1u);
  for (const std::uint32_t end = now + 4000; now <= end; ++now)
    EXPECT_TRUE(camera_guard_power(&self, true, now));
  EXPECT_FALSE(camera_guard_power(&self, true, now));
  EXPECT_EQ(self.cycles, 2u);
}

TEST(CameraGuard, WithoutTriggersOrPatienceNothingIsSwitched) {
  camera_guard self{};
  camera_guard_init(&self, true, 1000, 300, 0);
  for (std::uint32_t now = 0; now < 20'000; now += 10) EXPECT_TRUE(camera_guard_power(&self, false, now));
  camera_guard_init(&self, true, 0, 300, 0);
  for (std::uint32_t now = 0; now < 20'000; now += 10) EXPECT_TRUE(camera_guard_power(&self, true, now));
  camera_guard_init(&self, false, 1000, 300, 0);
  EXPECT_FALSE(camera_guard_power(&self, true, 0));
  EXPECT_EQ(self.cycles, 0u);
}

}  // namespace
