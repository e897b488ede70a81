// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// The whole board without its hardware: requests in, messages out, and a small world around it in virtual time.
#include "firmware/core/board.h"

#include <gtest/gtest.h>

#include <cmath>
#include <deque>
#include <memory>
#include <numbers>
#include <vector>

#include "firmware/core/board_requests.h"
#include "firmware/core/settings.h"
#include "tests/support/fake_flash.h"

namespace {

using lightwell::test::FakeFlash;

constexpr std::uint32_t kHz = 84'000'000;
constexpr std::uint32_t kStep = kHz / 8000;  // a sample of the photodiode

class World {
 public:
  explicit World(bool with_flash = true, std::uint32_t start = 0xFFF00000u) : counter(start) {
    facts.tick_hz = kHz;
    facts.capabilities = SYNC_CAN_TRIGGER | SYNC_CAN_UPDATE;
    facts.sample_hz = 8000;
    facts.highest_code = 4095;
    facts.serial[2] = 7;
    facts.memory = with_flash ? &memory.driver : nullptr;
    verifier.verify = update_verify_none;
    facts.verifier = &verifier;
    facts.image_region_size = 2048;
    board_init(self.get(), &facts, counter);
    frame_receiver_init(&receiver_);
  }

  void send(const sync_message& message) {
    std::uint8_t wire[SYNC_MAX_WIRE];
    send_bytes({wire, wire + frame_encode_message(&message, sequence_++, wire)});
  }
  void send_bytes(const std::vector<std::uint8_t>& bytes) {
    for (const std::uint8_t byte : bytes) board_byte(self.get(), link, byte, counter);
    board_finish_update(self.get());
  }
  void send(std::uint8_t type) {
    sync_message message{};
    message.type = type;
    send(message);
  }

  // A strobe answers every pulse 300 µs later and lasts 2 ms, unless the camera is off or deaf.
  void run(double seconds, bool host_speaks = true) {
    for (double t = 0; t < seconds; t += 1.0 / 8000) {
      counter += kStep;
      now += kStep;
      board_poll(self.get(), counter);
      if (board_forgets_pulses(self.get())) waiting.clear();
      while (!waiting.empty() && static_cast<std::int32_t>(waiting.front() - counter) <= 0) {
        if (!camera_deaf && board_camera_power(self.get())) strobes.push_back(waiting.front() + kHz / 3333);
        pulses.push_back(waiting.front());
        waiting.pop_front();
        board_pulse_done(self.get(), true);
      }
      std::uint32_t rise, fall;
      while (board_take_pulse(self.get(), &rise, &fall)) {
        EXPECT_EQ(fall - rise, static_cast<std::uint32_t>(ns_to_ticks(self->settings.pulse_ns, kHz)));
        waiting.push_back(rise);
      }
      while (!strobes.empty() && static_cast<std::int32_t>(strobes.front() + kHz / 500 - counter) <= 0) {
        board_edge(self.get(), BOARD_STROBE_RISE, strobes.front());
        board_edge(self.get(), BOARD_STROBE_FALL, strobes.front() + kHz / 500);
        strobes.pop_front();
      }
      const double light = 1 + 0.2 * std::cos(2 * std::numbers::pi * 100 * static_cast<double>(now) / kHz);
      board_sample(self.get(), static_cast<std::uint16_t>(std::lround(1000 * light)));
      if (host_speaks && now / kHz != heard_) {
        heard_ = now / kHz;
        send(SYNC_STATUS_REQUEST);
      }
      drain();
    }
  }

  void drain() {
    std::uint8_t byte;
    frame_view view;
    while (outbox_take(&self->out, &byte))
      if (frame_receive(&receiver_, byte, &view)) {
        sync_message message{};
        ASSERT_TRUE(frame_message(&view, &message));
        messages.push_back(message);
      }
    ASSERT_EQ(receiver_.damaged, 0u);
  }

  // The only message of that type since the last call of clear; or a message of type 0.
  sync_message the(std::uint8_t type) {
    drain();
    sync_message found{};
    int count = 0;
    for (const auto& message : messages)
      if (message.type == type) {
        found = message;
        ++count;
      }
    EXPECT_EQ(count, 1) << int{type};
    return count == 1 ? found : sync_message{};
  }
  sync_message ask(const sync_message& request, std::uint8_t answer) {
    drain();
    messages.clear();
    send(request);
    return the(answer);
  }
  sync_message ask(std::uint8_t type, std::uint8_t answer) {
    sync_message request{};
    request.type = type;
    return ask(request, answer);
  }
  sync_message configure(const sync_configuration& settings, std::uint8_t answer) {
    sync_message request{};
    request.type = SYNC_CONFIGURE;
    request.configuration = settings;
    return ask(request, answer);
  }

  FakeFlash memory{2048};
  update_verifier verifier{};
  board_facts facts{};
  std::unique_ptr<board> self = std::make_unique<board>();
  std::uint32_t counter;
  std::uint8_t link = 0;  // over which the host speaks
  std::uint64_t now = 0;
  std::deque<std::uint32_t> waiting, strobes;
  std::vector<std::uint32_t> pulses;
  std::vector<sync_message> messages;
  bool camera_deaf = false;

 private:
  frame_receiver receiver_{};
  std::uint16_t sequence_ = 0;
  std::uint64_t heard_ = 0;
};

sync_configuration running(std::uint32_t numerator = 60, std::uint32_t denominator = 1) {
  sync_configuration settings = settings_default();
  settings.rate_numerator = numerator;
  settings.rate_denominator = denominator;
  settings.trigger_on = 1;
  settings.camera_on = 1;
  settings.pulse_ns = 50'000;
  return settings;
}

TEST(Board, HelloSaysSchemaAndFacts) {
  World world;
  const sync_message hello = world.ask(SYNC_HELLO_REQUEST, SYNC_HELLO);
  EXPECT_EQ(hello.hello.schema_hash, SYNC_SCHEMA_HASH);
  EXPECT_EQ(hello.hello.capabilities, world.facts.capabilities);
  EXPECT_EQ(hello.hello.tick_hz, kHz);
  EXPECT_EQ(hello.hello.serial[2], 7u);
}

TEST(Board, PingComesBackWithBoardTimeAcrossTheWrap) {
  World world(false, 0xFFFFFFF0u);
  world.counter += 0x20;
  sync_message ping{};
  ping.type = SYNC_PING;
  ping.ping.t_host_ns = 0x0807060504030201ull;
  const sync_message pong = world.ask(ping, SYNC_PONG);
  EXPECT_EQ(pong.pong.t_host_ns, 0x0807060504030201ull);
  EXPECT_EQ(pong.pong.t_received_board_ns, ticks_to_ns(0x100000010ull, kHz));
  EXPECT_LE(pong.pong.t_received_board_ns, pong.pong.t_sent_board_ns);
}

TEST(Board, TheHostIsAtTheLinkThatLastSaidHello) {
  World world;
  world.ask(SYNC_HELLO_REQUEST, SYNC_HELLO);
  EXPECT_EQ(world.self->link, 0);
  world.drain();
  world.messages.clear();

  // At the other link nothing but a good HELLO_REQUEST counts: not a heartbeat, not a damaged one, not half of one.
  world.link = 1;
  const std::uint32_t heard_ms = world.self->host.heard_ms;
  world.run(0.1, false);
  world.send(SYNC_STATUS_REQUEST);
  std::uint8_t wire[SYNC_MAX_WIRE];
  sync_message hello{};
  hello.type = SYNC_HELLO_REQUEST;
  const std::size_t size = frame_encode_message(&hello, 0, wire);
  std::vector<std::uint8_t> damaged(wire, wire + size);
  damaged[size - 2] ^= 1;
  world.send_bytes(damaged);
  world.send_bytes({wire, wire + size / 2});
  world.drain();
  EXPECT_TRUE(world.messages.empty());
  EXPECT_EQ(world.self->link, 0);
  EXPECT_EQ(world.self->host.heard_ms, heard_ms);

  // Its second half, with the first host's bytes in between: each link has its own frames. What waited for the first host
  // is gone.
  world.link = 0;
  world.send(SYNC_STATUS_REQUEST);
  world.link = 1;
  world.send_bytes({wire + size / 2, wire + size});
  EXPECT_EQ(world.self->link, 1);
  world.drain();
  ASSERT_EQ(world.messages.size(), 1u);
  EXPECT_EQ(world.messages[0].type, SYNC_HELLO);
  EXPECT_EQ(world.ask(SYNC_STATUS_REQUEST, SYNC_STATUS).status.link_damaged, 1u);  // of this link
}

TEST(Board, WhatItDoesNotKnowIsAFaultThatNamesIt) {
  World world;
  std::uint8_t wire[SYNC_MAX_WIRE];
  const std::uint8_t one = 1;
  world.send_bytes({wire, wire + frame_encode(0x55, 0, nullptr, 0, wire)});
  sync_message fault = world.the(SYNC_FAULT);
  EXPECT_EQ(fault.fault.code, SYNC_FAULT_UNKNOWN_TYPE);
  EXPECT_EQ(fault.fault.type, 0x55);
  world.messages.clear();
  world.send_bytes({wire, wire + frame_encode(SYNC_PING, 0, &one, 1, wire)});
  fault = world.the(SYNC_FAULT);
  EXPECT_EQ(fault.fault.code, SYNC_FAULT_PAYLOAD_SIZE);
  EXPECT_EQ(fault.fault.minimum, 8);
  fault = world.ask(SYNC_TRIGGER, SYNC_FAULT);  // the board's own
  EXPECT_EQ(fault.fault.code, SYNC_FAULT_UNKNOWN_TYPE);
}

TEST(Board, ARefusedConfigurationChangesNothingAndNamesFieldAndRange) {
  World world;
  sync_configuration settings = running();
  ASSERT_EQ(world.configure(settings, SYNC_CONFIGURATION).configuration.rate_numerator, 60u);
  settings.rate_numerator = 50;
  settings.exposure_ns = 0;
  const sync_message fault = world.configure(settings, SYNC_FAULT);
  EXPECT_EQ(fault.fault.code, SYNC_FAULT_RANGE);
  sync_field_list list;
  ASSERT_TRUE(sync_fields(SYNC_CONFIGURE, &list));
  EXPECT_STREQ(list.fields[fault.fault.field].name, "exposure_ns");
  EXPECT_EQ(fault.fault.minimum, 1);
  EXPECT_EQ(fault.fault.maximum, 1'000'000'000);
  EXPECT_EQ(world.ask(SYNC_CONFIGURATION_REQUEST, SYNC_CONFIGURATION).configuration.rate_numerator, 60u);
}

TEST(Board, TriggersGoOutAtTheRateAndStrobesComeBackPaired) {
  World world;
  world.configure(running(24000, 1001), SYNC_CONFIGURATION);
  world.run(20);
  std::uint32_t triggers = 0, strobes = 0;
  std::vector<std::uint64_t> sent;
  for (const auto& message : world.messages) {
    if (message.type == SYNC_TRIGGER) {
      ASSERT_EQ(message.trigger.n, triggers++);
      EXPECT_EQ(message.trigger.flags, 0);
      EXPECT_EQ(message.trigger.phase_ns, 0);
      sent.push_back(message.trigger.t_board_ns);
      // Whole rates do not drift: every trigger is at its place of the first, to a tick of 11.9 ns either way.
      const double exact = static_cast<double>(sent.size() - 1) * 1001 / 24000 * 1e9;
      EXPECT_NEAR(static_cast<double>(sent.back() - sent.front()), exact, 12);
    }
    if (message.type == SYNC_STROBE) {
      ASSERT_EQ(message.strobe.n, strobes++);
      EXPECT_EQ(message.strobe.flags, SYNC_STROBE_PAIRED);
      EXPECT_NEAR(static_cast<double>(message.strobe.t_rise_board_ns - sent.at(message.strobe.n)), 300'030,
                  20);
      EXPECT_NEAR(static_cast<double>(message.strobe.t_fall_board_ns - message.strobe.t_rise_board_ns), 2e6,
                  20);
    }
  }
  EXPECT_NEAR(triggers, 479, 1);
  EXPECT_GE(strobes + 1, triggers);
  const sync_message status = world.ask(SYNC_STATUS_REQUEST, SYNC_STATUS);
  EXPECT_EQ(status.status.triggers, triggers);
  EXPECT_EQ(status.status.late_triggers, 0u);
  EXPECT_EQ(status.status.stray_strobes, 0u);
  EXPECT_EQ(status.status.link_dropped, 0u);
}

TEST(Board, ALoopThatStallsLeavesTriggersOutAndSaysSo) {
  World world;
  world.configure(running(), SYNC_CONFIGURATION);
  world.run(1);
  world.counter += kHz / 2;  // half a second of an erase
  world.now += kHz / 2;
  // What the hardware had armed is made; the rest of the time nothing was.
  world.run(1);
  const sync_message status = world.ask(SYNC_STATUS_REQUEST, SYNC_STATUS);
  EXPECT_NEAR(status.status.late_triggers, 28, 2);
  bool said = false;
  for (const auto& message : world.messages) said = said || message.type == SYNC_TRIGGER;
  const auto& n = world.pulses;
  for (std::size_t i = 1; i < n.size(); ++i) {
    const std::uint32_t gap = n[i] - n[i - 1];
    EXPECT_EQ((gap + kHz / 120) / (kHz / 60) * (kHz / 60), gap);  // whole periods, always
  }
}

TEST(Board, FollowsAPulsePerSecondAndHoldsOver) {
  World world;
  sync_configuration settings = running();
  settings.reference = SYNC_REFERENCE_PULSE;
  world.configure(settings, SYNC_CONFIGURATION);
  EXPECT_EQ(world.ask(SYNC_STATUS_REQUEST, SYNC_STATUS).status.lock, SYNC_LOCK_ACQUIRING);
  const std::uint32_t slow = kHz + kHz / 10'000;  // 100 ppm
  std::uint32_t edge = world.counter + 12345;
  for (int i = 0; i < 8; ++i, edge += slow) {
    while (static_cast<std::int32_t>(edge - world.counter) > 0) world.run(1.0 / 8000);
    board_edge(world.self.get(), BOARD_REFERENCE, edge);
  }
  sync_message status = world.ask(SYNC_STATUS_REQUEST, SYNC_STATUS);
  EXPECT_EQ(status.status.lock, SYNC_LOCK_LOCKED);
  EXPECT_NEAR(status.status.frequency_ppb, -100'000, 20);
  EXPECT_LE(std::abs(status.status.phase_error_ns), 12);
  world.messages.clear();
  world.run(0.9);
  int locked = 0;
  for (const auto& message : world.messages)
    if (message.type == SYNC_TRIGGER) {
      EXPECT_EQ(message.trigger.flags, SYNC_TRIGGER_LOCKED);
      ++locked;
    }
  EXPECT_GT(locked, 50);
  // The last pulse is a whole number of sixtieths of the reference's second away from its edge.
  const double place = static_cast<double>(world.pulses.back() - (edge - slow)) / slow * 60;
  EXPECT_NEAR(place, std::round(place), 60 * 2.0 / kHz);
  world.run(6);
  status = world.ask(SYNC_STATUS_REQUEST, SYNC_STATUS);
  EXPECT_EQ(status.status.lock, SYNC_LOCK_HOLDOVER);
  EXPECT_GE(status.status.holdover_s, 5u);
}

TEST(Board, ASilentHostBringsSafeDefaultsUntilItConfiguresAgain) {
  World world;
  sync_configuration settings = running();
  settings.heartbeat_ms = 500;
  world.configure(settings, SYNC_CONFIGURATION);
  world.run(0.45, false);
  EXPECT_GT(world.pulses.size(), 20u);
  world.run(0.2, false);
  const std::size_t sent = world.pulses.size();
  world.run(1, false);
  EXPECT_EQ(world.pulses.size(), sent);
  EXPECT_TRUE(board_camera_power(world.self.get()));
  EXPECT_EQ(world.ask(SYNC_STATUS_REQUEST, SYNC_STATUS).status.safe, 1);
  world.configure(settings, SYNC_CONFIGURATION);
  world.run(0.3);
  EXPECT_GT(world.pulses.size(), sent);
  EXPECT_EQ(world.ask(SYNC_STATUS_REQUEST, SYNC_STATUS).status.safe, 0);
}

TEST(Board, ADeafCameraIsSwitchedOffAndOn) {
  World world;
  sync_configuration settings = running();
  settings.camera_watchdog_ms = 500;
  settings.camera_off_ms = 300;
  world.configure(settings, SYNC_CONFIGURATION);
  world.run(1);
  EXPECT_EQ(world.ask(SYNC_STATUS_REQUEST, SYNC_STATUS).status.power_cycles, 0u);
  world.camera_deaf = true;
  world.run(0.6);
  EXPECT_FALSE(board_camera_power(world.self.get()));
  world.camera_deaf = false;
  world.run(1);
  EXPECT_TRUE(board_camera_power(world.self.get()));
  const sync_message status = world.ask(SYNC_STATUS_REQUEST, SYNC_STATUS);
  EXPECT_EQ(status.status.power_cycles, 1u);
  EXPECT_GT(status.status.unanswered_triggers, 20u);
}

TEST(Board, TheLampsFlickerIsReportedWithAdvice) {
  World world;
  sync_configuration settings = running();
  settings.photodiode_ulx = 500'000;
  settings.exposure_ns = 6'000'000;
  world.configure(settings, SYNC_CONFIGURATION);
  world.run(2.1);
  const sync_photodiode light = world.the(SYNC_PHOTODIODE).photodiode;
  EXPECT_NEAR(light.level_mlx, 500'000, 200);  // 1000 codes of half a lux, rounded to codes
  ASSERT_EQ(light.frequencies, 1);
  EXPECT_NEAR(light.frequency_mhz[0], 100'000, 50);
  EXPECT_NEAR(light.depth_ppm[0], 200'000, 2'000);
  EXPECT_EQ(light.flags, SYNC_PHOTODIODE_ADVICE);
  EXPECT_NEAR(light.exposure_ns, 10'000'000, 10'000);
  EXPECT_EQ(light.rate_mhz, 60'000u);
}

TEST(Board, SettingsThatWereStoredRuleAfterAStart) {
  World world;
  sync_configuration settings = running(50);
  settings.store = 1;
  EXPECT_EQ(world.configure(settings, SYNC_CONFIGURATION).configuration.store, 1);
  board_init(world.self.get(), &world.facts, world.counter);
  const sync_configuration loaded = world.ask(SYNC_CONFIGURATION_REQUEST, SYNC_CONFIGURATION).configuration;
  EXPECT_EQ(loaded.rate_numerator, 50u);
  EXPECT_EQ(loaded.store, 1);
  World without(false);
  EXPECT_EQ(without.configure(settings, SYNC_FAULT).fault.code, SYNC_FAULT_UNSUPPORTED);
}

TEST(Board, NoFlashIsErasedWhileRecordingAndNoImageIsTakenWithoutAVerifier) {
  World world;
  sync_message state{};
  state.type = SYNC_HOST_STATE;
  state.host_state.state = SYNC_HOST_RECORDING;
  world.send(state);
  sync_message begin{};
  begin.type = SYNC_UPDATE_BEGIN;
  begin.update_begin.size = 100;
  const std::uint64_t operations = world.memory.operations;
  EXPECT_EQ(world.ask(begin, SYNC_FAULT).fault.code, SYNC_FAULT_RECORDING);
  sync_configuration settings = running();
  settings.store = 1;
  EXPECT_EQ(world.configure(settings, SYNC_FAULT).fault.code, SYNC_FAULT_RECORDING);
  EXPECT_EQ(world.memory.operations, operations);
  state.host_state.state = SYNC_HOST_IDLE;
  world.send(state);
  EXPECT_EQ(world.ask(begin, SYNC_UPDATE_STATE).update_state.step, SYNC_UPDATE_RECEIVING);
  sync_message block{};
  block.type = SYNC_UPDATE_BLOCK;
  EXPECT_EQ(world.ask(block, SYNC_UPDATE_STATE).update_state.next_offset, 128u);
  EXPECT_EQ(world.ask(SYNC_UPDATE_FINISH, SYNC_FAULT).fault.code, SYNC_FAULT_SIGNATURE);
}

TEST(Board, ImuTemperatureAndButtonArrive) {
  World world;
  const float up[3] = {0, 0, 9.80665f}, still[3] = {0.01f, 0, 0};
  for (int i = 0; i < 400; ++i) {
    world.counter += kHz / 208;
    board_poll(world.self.get(), world.counter);
    board_imu(world.self.get(), up, still, world.counter);
    world.drain();
  }
  const sync_message imu = world.messages.back();
  ASSERT_EQ(imu.type, SYNC_IMU);
  EXPECT_NEAR(imu.imu.up_um_s2[2], 9'806'650,
              200);  // the bias, while it is not yet learned, tilts it by a few mrad
  EXPECT_EQ(imu.imu.flags, SYNC_IMU_STEADY);
  world.messages.clear();
  for (int i = 0; i < 3; ++i) board_temperature(world.self.get(), SYNC_SENSOR_CAMERA, 41'500);
  EXPECT_EQ(world.the(SYNC_TEMPERATURE).temperature.temperature_mc, 41'500);
  for (int i = 0; i < 200; ++i) {
    world.counter += kHz / 1000;
    board_poll(world.self.get(), world.counter);
    board_button(world.self.get(), i >= 20 && i < 120);
  }
  EXPECT_EQ(world.the(SYNC_BUTTON).button.press, SYNC_BUTTON_SHORT);
}

}  // namespace
