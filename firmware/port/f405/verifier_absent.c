// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// An image that was built without Monocypher: there is nobody who could sign an update.
#include "firmware/port/f405/port.h"

const update_verifier* chip_verifier(void) {
  return NULL;
}
