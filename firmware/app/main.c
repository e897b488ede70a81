// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "firmware/app/app.h"

int main(void) {
  app_start();
  for (;;) app_poll();
}
