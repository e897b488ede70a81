// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// Linear timecode (SMPTE ST 12-1) out of the times of its signal's edges: biphase mark, 80 bits a frame, from a crawl to
// twice its speed, forwards. No heap; one call an edge. A word counts where its polarity bit is right (an even number of
// ones) and it names the frame after the word before it: a lost edge can turn a bit and leave the rest in order.

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
  uint64_t start;  // tick at which the frame that it names begins: the edge before bit 0
  uint8_t hours, minutes, seconds, frames;
  bool drop_frame, colour_frame;
  uint32_t user_bits;
} timecode_word;

typedef struct {
  uint32_t shortest, longest;  // ticks a bit may last
  uint32_t bit;                // ticks a bit lasts, followed; 0: not yet known
  bool half;                   // one half of a 1 has come
  uint32_t before;             // its length
  uint64_t last_edge;
  uint64_t bits[2];           // the last 80, the newest lowest
  unsigned count;             // bits since the edges were lost
  uint64_t begun;             // edge at which the next word begins; valid after a sync word
  timecode_word before_word;  // the word that ended where this one begins
  bool chained;               // it is valid
  uint32_t words, damaged;
} timecode;

// tick_hz: of the edges' times.
void timecode_init(timecode* self, uint32_t tick_hz);

// Any edge, rising or falling. True: it ended a word with valid digits, which is in *word.
bool timecode_edge(timecode* self, uint64_t tick, timecode_word* word);

#ifdef __cplusplus
}
#endif
