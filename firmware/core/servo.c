// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/servo.h"

#include "firmware/core/integer.h"

enum {
  kLeastLockEdges = 3,  // two intervals that agree
  kMostLockEdges = 32,
  kLocksPerSecond = 4,  // or as many edges as come in a quarter of a second
  kMemorySeconds = 4,   // white capture noise averages out, a crystal's drift (0.01 ppm/s) does not yet show
  kLeastMemory = 8,     // edges; what a PPS gets
  kMostMemory = 256,    //
  kPullPpm = 300,       // crystals err by 100 ppm at the most, on either side
  kSlackUs = 50,        // an edge may be so far off, and …
  kSlackDivisor = 10000,  // … by a 10,000th of the period
  kHoldoverPpm = 1,       // by which the window grows without edges
  kMissedEdges = 3,       // then the reference is lost
  kLongestGap = 4,        // periods between two edges of a candidate
  kStrikes = 3,           // glitches in a row that a candidate bears
  kKeptOnReturn = 4       // k after a holdover: the rate may have moved
};

void servo_off(servo* self) {
  const servo nothing = {0};
  const uint32_t epoch = self->epoch;
  *self = nothing;
  self->epoch = epoch;
}

void servo_follow(servo* self, uint32_t tick_hz, uint32_t numerator, uint32_t denominator) {
  timeline line;
  servo_off(self);
  timeline_init(&line, 0, tick_hz, numerator, denominator);
  self->tick_hz = tick_hz;
  self->nominal_q32 = timeline_period_q32(&line);
  self->memory = clamp_u32(kMemorySeconds * (numerator / denominator), kLeastMemory, kMostMemory);
  self->lock_edges = clamp_u32(numerator / denominator / kLocksPerSecond, kLeastLockEdges, kMostLockEdges);
  self->state = SYNC_LOCK_ACQUIRING;
}

bool servo_holds(const servo* self) {
  return self->state == SYNC_LOCK_LOCKED || self->state == SYNC_LOCK_HOLDOVER;
}

static uint64_t window_ticks(const servo* self, uint64_t since) {
  return (uint64_t)kSlackUs * self->tick_hz / 1000000u + (self->nominal_q32 >> 32) / kSlackDivisor +
         since / 1000000u * kHoldoverPpm;
}

// Edges from the line's base to the one nearest to tick, and how far tick is from it.
static int64_t nearest(const timeline* line, uint64_t tick, int64_t* error_q32) {
  const int64_t ahead = (int64_t)(tick - line->base);
  const int64_t period = line->period;
  const int64_t edges = (ahead >= 0 ? ahead + period / 2 : ahead - period / 2) / period;
  // Parts of a tick over a gap of hours fit 63 bits: 2^32 · 10^6 edges. The base is rolled on long before.
  *error_q32 =
      ((ahead - edges * period) * ((int64_t)1 << 32)) - edges * (int64_t)line->period_part - line->base_part;
  return edges;
}

// One step of the filter: the line at that edge moves by g · error, the period by h · error / edges since the last.
static void correct(const servo* self, servo_track* track, uint64_t tick, int64_t edges, int64_t error_q32) {
  const uint64_t gap = tick - track->last_edge;
  const int64_t periods = (int64_t)((gap + track->line.period / 2u) / track->line.period);
  if (track->seen < self->memory) ++track->seen;
  const int64_t k = track->seen;
  const int64_t scale = k * (k + 1);
  const int64_t period_q32 = (int64_t)timeline_period_q32(&track->line);
  const int64_t change_q32 = error_q32 * 6 / (scale * (periods > 0 ? periods : 1));
  const int64_t nominal = (int64_t)self->nominal_q32;
  const int64_t pull = nominal / 1000000 * kPullPpm;
  const int64_t next_q32 = clamp_i64(period_q32 + change_q32, nominal - pull, nominal + pull);
  timeline_shift_q32(&track->line, error_q32 * (2 * (2 * k - 1)) / scale - edges * (next_q32 - period_q32));
  timeline_set_period_q32(&track->line, (uint64_t)next_q32);
  track->last_edge = tick;
}

static void begin(const servo* self, servo_track* track, uint64_t tick) {
  track->line.index = 0;
  track->line.base = tick;
  track->line.base_part = 0;
  timeline_set_period_q32(&track->line, self->nominal_q32);
  track->first_edge = tick;
  track->last_edge = tick;
  track->seen = 1;
  track->strikes = 0;
}

// True where the edge agrees with those of the candidate before it.
static bool extend(const servo* self, servo_track* track, uint64_t tick) {
  int64_t error_q32;
  const int64_t edges = nearest(&track->line, tick, &error_q32);
  const uint64_t periods = (tick - track->last_edge + track->line.period / 2u) / track->line.period;
  if (periods < 1u || periods > (uint64_t)kLongestGap) return false;
  // Since its first edge it must have kept the rate; from the second on, be where the line says.
  const uint64_t span = tick - track->first_edge;
  const uint64_t nominal = self->nominal_q32 >> 32;
  const uint64_t slip = (span + nominal / 2u) % nominal;
  const uint64_t off = slip > nominal / 2u ? slip - nominal / 2u : nominal / 2u - slip;
  const uint64_t window = window_ticks(self, 0);
  if (off > window + span / 1000000u * kPullPpm) return false;
  if (track->seen > 1u && magnitude_i64(error_q32 / ((int64_t)1 << 32)) > window) return false;
  correct(self, track, tick, edges, error_q32);
  return true;
}

static void consider(servo* self, uint64_t tick) {
  servo_track* track = &self->candidate;
  if (track->seen == 0u || !extend(self, track, tick)) {
    ++track->strikes;
    if (track->seen < 2u || track->strikes >= (uint32_t)kStrikes) begin(self, track, tick);
    return;
  }
  track->strikes = 0;
  if (track->seen < self->lock_edges) return;
  self->held = *track;
  self->state = SYNC_LOCK_LOCKED;
  ++self->epoch;
  self->error_q32 = 0;
  self->variance_q16 = 0;
  track->seen = 0;
}

static void note_error(servo* self, int64_t error_q32) {
  const uint64_t error_q8 = magnitude_i64(error_q32) >> 24;  // at most the window: 2^14 ticks
  self->error_q32 = error_q32;
  self->variance_q16 += (error_q8 * error_q8) / 16u;
  self->variance_q16 -= self->variance_q16 / 16u;
}

void servo_edge(servo* self, uint64_t tick) {
  if (self->state == SYNC_LOCK_FREE) return;
  ++self->edges;
  if (servo_holds(self)) {
    int64_t error_q32;
    timeline_roll(&self->held.line, tick);
    const int64_t edges = nearest(&self->held.line, tick, &error_q32);
    if (magnitude_i64(error_q32 / ((int64_t)1 << 32)) <= window_ticks(self, tick - self->held.last_edge)) {
      if (self->state == SYNC_LOCK_HOLDOVER && self->held.seen > (uint32_t)kKeptOnReturn)
        self->held.seen = kKeptOnReturn;
      correct(self, &self->held, tick, edges, error_q32);
      note_error(self, error_q32);
      self->state = SYNC_LOCK_LOCKED;
      self->candidate.seen = 0;
      return;
    }
    ++self->refused;
  }
  consider(self, tick);
}

void servo_advance(servo* self, uint64_t now) {
  if (!servo_holds(self)) return;
  timeline_roll(&self->held.line, now);
  const uint64_t patience = (uint64_t)kMissedEdges * self->held.line.period + self->held.line.period / 2u;
  if (now > self->held.last_edge && now - self->held.last_edge > patience) self->state = SYNC_LOCK_HOLDOVER;
}

int32_t servo_error_ns(const servo* self) {
  if (!servo_holds(self)) return 0;
  return (int32_t)((self->error_q32 >> 16) * 1000000 / (int64_t)self->tick_hz * 1000 / 65536);
}

uint32_t servo_rms_ns(const servo* self) {
  if (!servo_holds(self)) return 0;
  const uint64_t rms_q8 = root_u64(self->variance_q16);
  return (uint32_t)(rms_q8 * 1000000000u / self->tick_hz / 256u);
}

int32_t servo_frequency_ppb(const servo* self) {
  if (!servo_holds(self)) return 0;
  const int64_t period_q12 = (int64_t)(timeline_period_q32(&self->held.line) >> 20);
  const int64_t slower_q12 = period_q12 - (int64_t)(self->nominal_q32 >> 20);
  return (int32_t)(-slower_q12 * 1000000000 / period_q12);
}
