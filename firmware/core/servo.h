// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// Follows the edges of a reference (PPS, genlock, timecode frames) with a timeline.
//
// The filter is the least-squares line through the edges seen so far, kept recursively: an expanding-memory g-h filter
// with g = 2(2k-1)/(k(k+1)), h = 6/(k(k+1)) (Brookner 1998, "Tracking and Kalman Filtering Made Easy", section
// 1.2.10), whose k stops growing at the memory asked for, so that it then follows a crystal that warms up. From the
// third edge on it is as good as the edges allow: a PPS is followed after two seconds. Edges that are missing cost
// nothing but time; edges that do not belong are refused, and become the reference only when three in a row agree.

#include <stdbool.h>
#include <stdint.h>

#include "firmware/core/timeline.h"
#include "interface/sync_protocol.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
  timeline line;
  uint64_t first_edge, last_edge;  // ticks
  uint32_t seen;                   // k; 0: no edge yet
  uint32_t strikes;                // edges in a row that did not fit a candidate
} servo_track;

typedef struct {
  uint32_t tick_hz;
  uint64_t nominal_q32;  // the reference's period by our clock
  uint32_t memory;       // largest k
  uint32_t lock_edges;   // that must agree
  sync_lock state;
  servo_track held;       // valid when locked or in holdover
  servo_track candidate;  // edges that may become the reference
  uint32_t epoch;         // counts the times that held was replaced: who counts its edges must begin anew
  int64_t error_q32;      // last edge less its prediction
  uint64_t variance_q16;  // of such errors, ticks²
  uint32_t edges, refused;
} servo;

// State FREE: edges are ignored.
void servo_off(servo* self);

// State ACQUIRING.
void servo_follow(servo* self, uint32_t tick_hz, uint32_t numerator, uint32_t denominator);

// An edge of the reference. Edges come in order.
void servo_edge(servo* self, uint64_t tick);

// Notices that edges stay away; call a few times a period.
void servo_advance(servo* self, uint64_t now);

// Locked or in holdover: held.line is where the reference is.
bool servo_holds(const servo* self);

int32_t servo_error_ns(const servo* self);
uint32_t servo_rms_ns(const servo* self);
int32_t servo_frequency_ppb(const servo* self);

#ifdef __cplusplus
}
#endif
