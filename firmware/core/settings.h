// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// What a configuration may be. Times and rates that depend on each other are checked together, and the fault names the
// field and the range that would be taken beside the others.

#include <stdbool.h>
#include <stdint.h>

#include "interface/sync_protocol.h"

#ifdef __cplusplus
extern "C" {
#endif

// Safe: no triggers, no reference, camera off.
sync_configuration settings_default(void);

// The index of the first field refused and its range; true: all is taken.
typedef struct {
  uint8_t field;  // as in sync_fields(SYNC_CONFIGURE)
  int64_t minimum, maximum;
} settings_refusal;

bool settings_valid(const sync_configuration* settings, settings_refusal* refusal);

// What rules while the host is silent: these settings, without triggers. The camera keeps its power, or a daemon that is
// started anew would find it cold.
sync_configuration settings_safe(const sync_configuration* settings);

#ifdef __cplusplus
}
#endif
