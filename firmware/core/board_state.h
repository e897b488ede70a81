// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// All that the board knows, and what its parts share: time as messages tell it, the way to the host, the settings in force.

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

enum { BOARD_SENSORS = 2, BOARD_LINKS = 2 };

typedef struct {
  const board_facts* facts;
  board_time time;
  frame_receiver receiver[BOARD_LINKS];
  uint8_t link;  // that of the host: the last that brought a good HELLO_REQUEST
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

// Ticks as milliseconds since the start, and as nanoseconds.
uint32_t board_ms(const board* self);
uint64_t board_ns(const board* self, uint64_t ticks);

void board_send(board* self, const sync_message* message);
void board_send_status(board* self);
void board_apply(board* self);  // the settings
bool board_camera_power(board* self);

#ifdef __cplusplus
}
#endif
