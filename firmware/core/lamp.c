// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/lamp.h"

bool lamp_is_lit(lamp shows, uint32_t now_ms) {
  switch (shows) {
    case LAMP_ALONE:
      return now_ms % 2000u < 50u;
    case LAMP_IDLE:
      return now_ms % 16u < 2u;
    case LAMP_LIVE:
      return true;
    case LAMP_RECORDING:
      return now_ms % 1000u < 500u;
    default:
      return now_ms % 200u < 100u;
  }
}
