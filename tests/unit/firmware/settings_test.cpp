// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/settings.h"

#include <gtest/gtest.h>

#include <functional>
#include <random>
#include <string>

#include "firmware/core/settings_store.h"
#include "tests/support/fake_flash.h"

namespace {

using lightwell::test::FakeFlash;

std::string refused(const sync_configuration& settings, settings_refusal& refusal) {
  if (settings_valid(&settings, &refusal)) return "";
  sync_field_list list;
  sync_fields(SYNC_CONFIGURE, &list);
  return refusal.field < list.count ? list.fields[refusal.field].name : "?";
}

TEST(Settings, DefaultsAreValidAndSendNothing) {
  const sync_configuration settings = settings_default();
  settings_refusal refusal;
  EXPECT_EQ(refused(settings, refusal), "");
  EXPECT_EQ(settings.trigger_on, 0);
  EXPECT_EQ(settings.camera_on, 0);
}

// Each field, one beyond either end of its range: the fault names it and the range, whose ends are taken.
TEST(Settings, WhatIsRefusedIsNamedWithItsRange) {
  struct Case {
    const char* name;
    std::function<void(sync_configuration&, std::int64_t)> set;
    std::int64_t bad;
  };
  const auto narrow = [](auto member) {
    return [member](sync_configuration& s, std::int64_t value) {
      s.*member = static_cast<std::remove_reference_t<decltype(s.*member)>>(value);
    };
  };
  using C = sync_configuration;
  const Case cases[] = {{"rate_numerator", narrow(&C::rate_numerator), 60'001},
                        {"rate_numerator", narrow(&C::rate_numerator), 0},
                        {"rate_denominator", narrow(&C::rate_denominator), 0},
                        {"rate_denominator", narrow(&C::rate_denominator), 10'001},
                        {"phase_ns", narrow(&C::phase_ns), 500'000'001},
                        {"phase_ns", narrow(&C::phase_ns), -500'000'001},
                        {"pulse_ns", narrow(&C::pulse_ns), 9'999},
                        {"pulse_ns", narrow(&C::pulse_ns), 8'333'334},
                        {"trigger_on", narrow(&C::trigger_on), 2},
                        {"reference", narrow(&C::reference), 3},
                        {"reference_numerator", narrow(&C::reference_numerator), 241},
                        {"reference_denominator", narrow(&C::reference_denominator), 0},
                        {"strobe_window_ns", narrow(&C::strobe_window_ns), 999},
                        {"strobe_active_low", narrow(&C::strobe_active_low), 255},
                        {"exposure_ns", narrow(&C::exposure_ns), 0},
                        {"photodiode_dark", narrow(&C::photodiode_dark), 65'536},
                        {"photodiode_ulx", narrow(&C::photodiode_ulx), 0},
                        {"heartbeat_ms", narrow(&C::heartbeat_ms), 99},
                        {"camera_on", narrow(&C::camera_on), 2},
                        {"camera_watchdog_ms", narrow(&C::camera_watchdog_ms), 499},
                        {"camera_off_ms", narrow(&C::camera_off_ms), 60'001},
                        {"store", narrow(&C::store), 2}};
  for (const Case& c : cases) {
    sync_configuration settings = settings_default();
    if (c.bad == 60'001 && std::string(c.name) == "rate_numerator") settings.rate_denominator = 60;
    c.set(settings, c.bad);
    settings_refusal refusal{};
    if (std::string(c.name) == "rate_numerator" && c.bad == 60'001) settings.pulse_ns = 10'000;
    ASSERT_EQ(refused(settings, refusal), c.name) << c.bad;
    EXPECT_TRUE(c.bad < refusal.minimum || c.bad > refusal.maximum) << c.name;
    for (const std::int64_t end : {refusal.minimum, refusal.maximum}) {
      settings_refusal other{};
      c.set(settings, end);
      const std::string still = refused(settings, other);
      EXPECT_NE(still, c.name) << end;
    }
  }
}

TEST(Settings, RatesThatMeetTooRarelyAreRefusedOnlyWithAReference) {
  sync_configuration settings = settings_default();
  settings.rate_numerator = 999'983;
  settings.rate_denominator = 9'973;
  settings.reference_numerator = 999'979;
  settings.reference_denominator = 9'967;
  settings_refusal refusal{};
  EXPECT_EQ(refused(settings, refusal), "");
  settings.reference = SYNC_REFERENCE_PULSE;
  EXPECT_EQ(refused(settings, refusal), "rate_denominator");
}

TEST(SettingsStore, WhatWasSavedLastIsLoaded) {
  FakeFlash memory(4096);
  sync_configuration settings = settings_default(), loaded;
  EXPECT_FALSE(settings_load(&memory.driver, &loaded));
  for (std::uint32_t rate = 1; rate <= 100; ++rate) {
    settings.rate_numerator = rate;
    ASSERT_TRUE(settings_save(&memory.driver, &settings));
    ASSERT_TRUE(settings_load(&memory.driver, &loaded));
    ASSERT_EQ(loaded.rate_numerator, rate);
    ASSERT_EQ(loaded.store, 1);
  }
  EXPECT_EQ(memory.misuses, 0);
}

TEST(SettingsStore, APowerCutAtEveryWriteLeavesTheOldOrTheNew) {
  for (std::uint64_t cut = 0; cut < 40; ++cut)
    for (unsigned seed = 0; seed < 50; ++seed) {
      FakeFlash memory(256, seed);
      sync_configuration settings = settings_default(), loaded;
      // From one copy and from two, into either region.
      for (std::uint32_t rate = 10; rate < 10 + 1 + seed % 3; ++rate) {
        settings.rate_numerator = rate;
        ASSERT_TRUE(settings_save(&memory.driver, &settings));
      }
      const std::uint32_t before = settings.rate_numerator;
      settings.rate_numerator = 77;
      memory.cut_power_at(cut);
      const bool saved = settings_save(&memory.driver, &settings);
      memory.restore_power();
      ASSERT_TRUE(settings_load(&memory.driver, &loaded)) << cut;
      ASSERT_TRUE(loaded.rate_numerator == before || loaded.rate_numerator == 77) << cut;
      if (saved) {
        ASSERT_EQ(loaded.rate_numerator, 77u);
      }
      settings.rate_numerator = 88;  // and it goes on
      ASSERT_TRUE(settings_save(&memory.driver, &settings));
      ASSERT_TRUE(settings_load(&memory.driver, &loaded));
      ASSERT_EQ(loaded.rate_numerator, 88u);
    }
}

TEST(SettingsStore, NoFlippedBitIsTakenForSettings) {
  FakeFlash memory(256);
  sync_configuration settings = settings_default(), loaded;
  ASSERT_TRUE(settings_save(&memory.driver, &settings));
  const auto whole = memory.regions[FLASH_SETTINGS_A];
  std::size_t refusals = 0, size = 0;
  for (std::size_t i = 0; i < whole.size(); ++i)
    for (int bit = 0; bit < 8; ++bit) {
      memory.regions[FLASH_SETTINGS_A] = whole;
      memory.regions[FLASH_SETTINGS_A][i] ^= static_cast<std::uint8_t>(1u << bit);
      if (!settings_load(&memory.driver, &loaded)) {
        ++refusals;
        size = i + 1;
      }
    }
  EXPECT_EQ(refusals, size * 8);  // every bit of the record counts
  EXPECT_GT(size, sync_payload_size(SYNC_CONFIGURATION));
}

}  // namespace
