// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// Two watchdogs: over the host, whose silence brings safe defaults back, and over the camera, which is switched off and on
// where it answers no triggers.

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
  uint32_t patience_ms;  // 0: never
  uint32_t heard_ms;
  bool silent;
} host_guard;

void host_guard_init(host_guard* self, uint32_t patience_ms, uint32_t now_ms);
void host_guard_heard(host_guard* self, uint32_t now_ms);
// Silent for longer than patience. Nothing was ever heard counts from the start.
bool host_guard_silent(host_guard* self, uint32_t now_ms);

typedef struct {
  uint32_t patience_ms, off_ms;  // patience 0: never
  bool wanted;                   // on
  bool off;                      // by the watchdog, for off_ms
  bool restarted;                // a camera that starts needs longer: four times the patience
  uint32_t answered_ms;          // or when triggering began
  uint32_t off_since_ms;
  uint32_t cycles;
} camera_guard;

// Keeps cycles.
void camera_guard_init(camera_guard* self, bool on, uint32_t patience_ms, uint32_t off_ms, uint32_t now_ms);
void camera_guard_answered(camera_guard* self, uint32_t now_ms);
// Whether the camera is to have power. triggering: triggers are being sent.
bool camera_guard_power(camera_guard* self, bool triggering, uint32_t now_ms);

#ifdef __cplusplus
}
#endif
