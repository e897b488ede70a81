// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// All that a port provides. Nothing above this header touches a register.

#include <stdbool.h>
#include <stdint.h>

void hal_init(void);
uint32_t hal_counter_us(void);      // free-running, wraps at 2^32
bool hal_link_read(uint8_t* byte);  // false: nothing has arrived
void hal_link_write(uint8_t byte);  // waits for room
