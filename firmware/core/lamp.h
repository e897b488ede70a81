// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// What the board's LED shows.

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum {
  LAMP_ALONE,      // no host: a short blink every two seconds
  LAMP_IDLE,       // on, dim: an eighth of every 16 ms
  LAMP_LIVE,       // on
  LAMP_RECORDING,  // half a second on, half a second off
  LAMP_TROUBLE     // five times a second
} lamp;

bool lamp_is_lit(lamp shows, uint32_t now_ms);

#ifdef __cplusplus
}
#endif
