// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// The board, without its hardware: what arrives goes in, what is to be done comes out. One loop calls it; no interrupt does.
// Everything lies in this struct (12 KB), nothing is allocated.

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "firmware/core/board_time.h"
#include "firmware/core/button.h"
#include "firmware/core/flash.h"
#include "firmware/core/flicker.h"
#include "firmware/core/gravity.h"
#include "firmware/core/guard.h"
#include "firmware/core/lamp.h"
#include "firmware/core/outbox.h"
#include "firmware/core/pulses.h"
#include "firmware/core/strobe.h"
#include "firmware/core/temperature.h"
#include "firmware/core/timecode.h"
#include "firmware/core/update.h"
#include "interface/sync_frame.h"

#ifdef __cplusplus
extern "C" {
#endif

// What a port says about itself.
typedef struct {
  uint32_t tick_hz;
  uint32_t capabilities;  // SYNC_CAN_…
  uint32_t serial[3];
  uint8_t slot;
  uint32_t sample_hz;     // of the photodiode
  uint16_t highest_code;  // of its converter
  const flash* memory;    // null: none
  const update_verifier* verifier;
  uint32_t image_region_size;
} board_facts;

typedef enum { BOARD_STROBE_RISE, BOARD_STROBE_FALL, BOARD_REFERENCE, BOARD_TIMECODE } board_input;

enum { BOARD_SENSORS = 2 };

typedef struct {
  const board_facts* facts;
  board_time time;
  frame_receiver receiver;
  outbox out;
  sync_configuration settings;
  bool stored;  // settings are those in flash
  bool safe;
  uint8_t host_state;
  pulses train;
  strobe camera_strobe;
  timecode code;
  flicker light;
  gravity up;
  uint64_t last_imu;
  uint32_t imu_skipped;
  temperature sensors[BOARD_SENSORS];
  button record;
  host_guard host;
  camera_guard camera;
  update images;
  bool confirmed;
  uint32_t status_ms, hello_ms;
  bool greeted;
  bool restart_train;  // the hardware's pulses are of settings that have gone
  uint32_t overruns;   // as the port counts them
} board;

void board_init(board* self, const board_facts* facts, uint32_t counter);

// Time goes on: status, watchdogs, strobes whose end is overdue. Call at least every 2 ms, with the counter of now.
void board_poll(board* self, uint32_t counter);

// A byte from the host.
void board_byte(board* self, uint8_t byte, uint32_t counter);

// An edge that the timer has captured; those of one input in order.
void board_edge(board* self, board_input input, uint32_t stamp);

// The next trigger pulse for the hardware; false: none now.
bool board_take_pulse(board* self, uint32_t* rise, uint32_t* fall);
// The oldest pulse taken was made; or missed, its time having passed before it was armed.
void board_pulse_done(board* self, bool made);
// True once after a change of settings: the hardware forgets the pulses it has.
bool board_forgets_pulses(board* self);

void board_sample(board* self, uint16_t code);
void board_imu(board* self, const float acceleration[3], const float rate[3], uint32_t counter);
void board_temperature(board* self, uint8_t sensor, int32_t reading_mc);
void board_button(board* self, bool pressed);

bool board_led(const board* self);
bool board_camera_power(board* self);

// Within the core: ticks as milliseconds, as nanoseconds, and a message for the host.
uint32_t board_ms(const board* self);
uint64_t board_ns(const board* self, uint64_t ticks);
void board_send(board* self, const sync_message* message);
void board_apply(board* self);                            // the settings
void board_answer(board* self, const frame_view* frame);  // a request: board_requests.c
void board_send_status(board* self);

#ifdef __cplusplus
}
#endif
