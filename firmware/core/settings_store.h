// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// Settings in flash, in two copies: the one written last rules, the other is what was before. A power cut at any moment of
// writing leaves one of them whole.

#include "firmware/core/flash.h"
#include "interface/sync_protocol.h"

#ifdef __cplusplus
extern "C" {
#endif

// The newest copy that is whole, holds this image's schema and is valid; false: there is none, *settings is untouched.
bool settings_load(const flash* memory, sync_configuration* settings);

// Into the older copy's place. False: flash failed; the copy before still rules.
bool settings_save(const flash* memory, const sync_configuration* settings);

#ifdef __cplusplus
}
#endif
