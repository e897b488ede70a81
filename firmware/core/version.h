// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// Of the firmware, as HELLO says it and as its images are signed (firmware/CMakeLists.txt reads it here).
#define FIRMWARE_MAJOR 0
#define FIRMWARE_MINOR 3
#define FIRMWARE_PATCH 0
