// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

typedef void (*vector)(void);

void reset_handler(void);
void hang(void);  // a fault: the watchdog starts the board anew
