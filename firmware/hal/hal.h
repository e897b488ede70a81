// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// All that a port provides. Nothing above this header touches a register; nothing below it decides anything.

#include <stdbool.h>
#include <stdint.h>

#include "firmware/core/board.h"

#ifdef __cplusplus
extern "C" {
#endif

// Clocks, pins, timer, interrupts; the trigger low, the camera without power. The facts stay where they are.
const board_facts* hal_init(void);

uint32_t hal_ticks(void);  // the free-running timer that makes and stamps edges; wraps at 2^32

// The links to a host, below BOARD_LINKS: UART, USB bulk. A port that has one has link 0.
bool hal_link_read(uint8_t link, uint8_t* byte);  // false: nothing has arrived
bool hal_link_ready(uint8_t link);                // one byte can be written without waiting
void hal_link_write(uint8_t link, uint8_t byte);  // only where it is ready

// Trigger pulses, in order, made by output compare. The port holds PULSES_AHEAD of them.
void hal_pulse(uint32_t rise, uint32_t fall);
bool hal_pulse_done(bool* made);  // one more has ended; made false: its time had passed when it was armed
void hal_pulses_forget(void);     // none of those waiting is made or reported; the line is low

typedef struct {
  board_input input;
  uint32_t stamp;
} hal_edge_event;

bool hal_edge(hal_edge_event* event);  // captured edges, in order of each input
bool hal_sample(uint16_t* code);       // of the photodiode, at facts->sample_hz
bool hal_imu(float acceleration[3], float rate[3], uint32_t* stamp);  // m/s², rad/s
bool hal_temperature(uint8_t* sensor, int32_t* reading_mc);           // a few a second
bool hal_button(void);
void hal_led(bool lit);
void hal_camera_power(bool on);
uint32_t hal_overruns(void);  // edges, samples or bytes lost since the start
void hal_watchdog(void);      // must be called every second, or the board starts anew

#ifdef __cplusplus
}
#endif
