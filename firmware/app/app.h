// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#ifdef __cplusplus
extern "C" {
#endif

// One turn of the board's loop: everything that has arrived is taken, everything that is due is done. Ports whose time is
// virtual call it between their steps.
void app_start(void);
void app_poll(void);

#ifdef __cplusplus
}
#endif
