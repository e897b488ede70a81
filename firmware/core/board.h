// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// The board, without its hardware: what arrives goes in, what is to be done comes out. One loop calls it; no interrupt does.
// Everything lies in this struct (12 KB), nothing is allocated.

#include <stdbool.h>
#include <stdint.h>

#include "firmware/core/board_state.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum { BOARD_STROBE_RISE, BOARD_STROBE_FALL, BOARD_REFERENCE, BOARD_TIMECODE } board_input;

void board_init(board* self, const board_facts* facts, uint32_t counter);

// Time goes on: status, watchdogs, strobes whose end is overdue. Call at least every 2 ms, with the counter of now.
void board_poll(board* self, uint32_t counter);

// A byte that came over a link (below BOARD_LINKS). The host is at the link that last brought a good HELLO_REQUEST: from the
// others nothing else counts, and what waits to be sent goes to self->link.
void board_byte(board* self, uint8_t link, uint8_t byte, uint32_t counter);

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

bool board_led(const board* self);  // and board_camera_power

#ifdef __cplusplus
}
#endif
