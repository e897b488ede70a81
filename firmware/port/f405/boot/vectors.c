// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "firmware/port/startup.h"

__attribute__((section(".vectors"), used)) static const vector vectors[SYSTEM_VECTOR_COUNT] = {
    SYSTEM_VECTORS};
