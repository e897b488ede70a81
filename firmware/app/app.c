// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "firmware/app/app.h"

#include "firmware/core/board.h"
#include "firmware/core/board_requests.h"
#include "firmware/hal/hal.h"

static board self;

// Samples and bytes that one turn takes at the most, so that triggers never wait for more than a transform.
enum { kSamplesATurn = 16, kBytesATurn = 64 };

void app_start(void) {
  const board_facts* facts = hal_init();
  board_init(&self, facts, hal_ticks());
}

static void move_pulses(void) {
  bool made;
  uint32_t rise;
  uint32_t fall;
  if (board_forgets_pulses(&self)) hal_pulses_forget();
  while (hal_pulse_done(&made)) board_pulse_done(&self, made);
  while (board_take_pulse(&self, &rise, &fall)) hal_pulse(rise, fall);
}

static void move_edges(void) {
  hal_edge_event event;
  while (hal_edge(&event)) board_edge(&self, event.input, event.stamp);
}

static void move_samples(void) {
  uint16_t code;
  float acceleration[3];
  float rate[3];
  uint32_t stamp;
  uint8_t sensor;
  int32_t reading;
  for (int i = 0; i < kSamplesATurn && hal_sample(&code); ++i) board_sample(&self, code);
  if (hal_imu(acceleration, rate, &stamp)) board_imu(&self, acceleration, rate, stamp);
  if (hal_temperature(&sensor, &reading)) board_temperature(&self, sensor, reading);
  board_button(&self, hal_button());
}

static void move_bytes(void) {
  uint8_t byte;
  for (uint8_t link = 0; link < (uint8_t)BOARD_LINKS; ++link)
    for (int i = 0; i < kBytesATurn && hal_link_read(link, &byte); ++i)
      board_byte(&self, link, byte, hal_ticks());
  for (int i = 0; i < kBytesATurn && hal_link_ready(self.link) && outbox_take(&self.out, &byte); ++i)
    hal_link_write(self.link, byte);
}

void app_poll(void) {
  board_poll(&self, hal_ticks());
  self.overruns = hal_overruns();
  move_pulses();
  move_edges();
  move_samples();
  move_bytes();
  board_finish_update(&self);
  hal_led(board_led(&self));
  hal_camera_power(board_camera_power(&self));
  hal_watchdog();
}
