// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "firmware/core/flash.h"

extern const flash ram_flash;  // for the settings
