// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/timecode.h"

enum {
  kBits = 80,
  kSlowestBitHz = 23 * kBits / 2,  // half the speed of 24 frames a second, rounded down
  kFastestBitHz = 30 * kBits * 2
};
// Bits 64 to 79 as they arrive: 0011 1111 1111 1101.
static const uint64_t kSync = 0x3FFDu;

static void lose(timecode* self) {
  self->bit = 0;
  self->half = false;
  self->count = 0;
}

void timecode_init(timecode* self, uint32_t tick_hz) {
  const timecode nothing = {0};
  *self = nothing;
  self->shortest = tick_hz / kFastestBitHz;
  self->longest = tick_hz / kSlowestBitHz;
}

// Bit number n of the word, 0 the first that was sent.
static unsigned bit_at(const timecode* self, unsigned n) {
  const unsigned place = (unsigned)kBits - 1u - n;
  return (unsigned)(self->bits[place / 64u] >> (place % 64u)) & 1u;
}

static unsigned field(const timecode* self, unsigned first, unsigned count) {
  unsigned value = 0;
  for (unsigned i = 0; i < count; ++i) value |= bit_at(self, first + i) << i;
  return value;
}

// False where no clock shows such digits.
static bool read_word(const timecode* self, timecode_word* word) {
  const unsigned digits[8] = {field(self, 0, 4),  field(self, 8, 2),  field(self, 16, 4), field(self, 24, 3),
                              field(self, 32, 4), field(self, 40, 3), field(self, 48, 4), field(self, 56, 2)};
  for (unsigned i = 0; i < 8u; i += 2u)
    if (digits[i] > 9u) return false;
  word->frames = (uint8_t)(digits[1] * 10u + digits[0]);
  word->seconds = (uint8_t)(digits[3] * 10u + digits[2]);
  word->minutes = (uint8_t)(digits[5] * 10u + digits[4]);
  word->hours = (uint8_t)(digits[7] * 10u + digits[6]);
  word->drop_frame = bit_at(self, 10) != 0u;
  word->colour_frame = bit_at(self, 11) != 0u;
  word->user_bits = 0;
  for (unsigned i = 0; i < 8u; ++i) word->user_bits |= (uint32_t)field(self, 4u + 8u * i, 4) << (4u * i);
  return word->frames < 30u && word->seconds < 60u && word->minutes < 60u && word->hours < 24u;
}

static bool even_ones(const timecode* self) {
  uint64_t fold = self->bits[0] ^ (self->bits[1] & 0xFFFFu);
  for (unsigned shift = 32; shift > 0u; shift /= 2u) fold ^= fold >> shift;
  return (fold & 1u) == 0u;
}

static uint32_t seconds_of_day(const timecode_word* word) {
  return (word->hours * 60u + word->minutes) * 60u + word->seconds;
}

static bool follows(const timecode_word* before, const timecode_word* word) {
  const uint32_t second = seconds_of_day(before);
  if (seconds_of_day(word) == second) return word->frames == before->frames + 1u;
  // A second begins with frame 0, a minute of drop frame with 2.
  return seconds_of_day(word) == (second + 1u) % 86400u && before->frames >= 23u &&
         (word->frames == 0u || (word->frames == 2u && word->drop_frame && word->seconds == 0u));
}

static bool end_word(timecode* self, uint64_t start, timecode_word* word) {
  const timecode_word before = self->before_word;
  const bool chained = self->chained;
  word->start = start;
  self->chained = even_ones(self) && read_word(self, word);
  if (!self->chained) {
    ++self->damaged;
    return false;
  }
  self->before_word = *word;
  if (!chained || !follows(&before, word)) return false;
  ++self->words;
  return true;
}

static bool take_bit(timecode* self, unsigned bit, uint64_t end, timecode_word* word) {
  self->bits[1] = (self->bits[1] << 1) | (self->bits[0] >> 63);
  self->bits[0] = (self->bits[0] << 1) | bit;
  if (self->count <= (unsigned)kBits) ++self->count;
  if (self->count < 16u || (self->bits[0] & 0xFFFFu) != kSync) return false;
  const bool whole = self->count == (unsigned)kBits && self->begun != 0u;
  const uint64_t start = self->begun;
  self->begun = end;
  self->count = 0;
  if (!whole) {
    self->chained = false;
    return false;
  }
  return end_word(self, start, word);
}

// A 1 has an edge in its middle, a 0 has none.
bool timecode_edge(timecode* self, uint64_t tick, timecode_word* word) {
  const uint64_t since = tick - self->last_edge;
  self->last_edge = tick;
  if (since < self->shortest / 4u || since > self->longest) {
    lose(self);
    self->begun = 0;
    return false;
  }
  const uint32_t length = (uint32_t)since;
  if (self->bit == 0u) {  // two that differ by half or more: the longer is a 0
    const uint32_t before = self->before;
    self->before = length;
    if (before == 0u) return false;
    if (length > before + before / 2u)
      self->bit = length;
    else if (before > length + length / 2u)
      self->bit = before;
    self->half = self->bit == before && self->bit != 0u;  // this edge ended the first half of a 1
    self->begun = 0;
    return false;
  }
  const bool is_half = length < self->bit * 3u / 4u;
  if (is_half && !self->half) {
    self->half = true;
    self->before = length;
    return false;
  }
  if (!is_half && self->half) {  // half a 1 and then none: edges were lost
    lose(self);
    self->before = length;
    self->begun = 0;
    return false;
  }
  const uint32_t whole = self->half ? self->before + length : length;
  self->bit = self->bit - self->bit / 8u + whole / 8u;  // follows a tape's speed
  if (self->bit < self->shortest || self->bit > self->longest) {
    lose(self);
    self->begun = 0;
    return false;
  }
  const unsigned value = self->half ? 1u : 0u;
  self->half = false;
  return take_bit(self, value, tick, word);
}
