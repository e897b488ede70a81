// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/update.h"

// The record, from the start of the trailer.
enum {
  kMagicAt = 0,
  kSizeAt = 4,
  kVersionAt = 8,  // three bytes and a zero
  kGenerationAt = 12,
  kSignatureAt = 16,
  kCrcAt = kSignatureAt + SYNC_SIGNATURE_BYTES,
  kRecord = kCrcAt + 4,
  kWholeAt = kRecord,
  kTriedAt = kWholeAt + 4,
  kConfirmedAt = kTriedAt + 4,
  kUsed = kConfirmedAt + 4
};
// Words that a torn write hardly makes: half their bits are left at one.
static const uint32_t kMagic = 0x4C575549u;
static const uint32_t kWhole = 0x5AA53CC3u;
static const uint32_t kTried = 0xA55AC33Cu;
static const uint32_t kConfirmed = 0x3CC35AA5u;
static const uint32_t kNothing = 0xFFFFFFFFu;

typedef struct {
  uint32_t size, generation;
  uint8_t version[3];
  uint8_t signature[SYNC_SIGNATURE_BYTES];
  bool tried, confirmed;
} image_record;

static uint32_t get(const uint8_t* at) {
  return (uint32_t)at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
}

static void put(uint8_t* at, uint32_t value) {
  for (unsigned i = 0; i < 4u; ++i) at[i] = (uint8_t)(value >> (8u * i));
}

bool update_verify_none(void* context, uint32_t region, uint32_t size, const uint8_t version[3],
                        const uint8_t signature[SYNC_SIGNATURE_BYTES]) {
  (void)context;
  (void)region;
  (void)size;
  (void)version;
  (void)signature;
  return false;
}

static bool read_record(const flash* memory, uint32_t region, uint32_t region_size, image_record* record) {
  uint8_t bytes[kUsed];
  memory->read(memory->context, region, region_size - (uint32_t)UPDATE_TRAILER, bytes, kUsed);
  record->size = get(bytes + kSizeAt);
  if (get(bytes + kMagicAt) != kMagic || get(bytes + kWholeAt) != kWhole ||
      get(bytes + kCrcAt) != flash_crc32(0, bytes, kCrcAt) ||
      record->size > region_size - (uint32_t)UPDATE_TRAILER)
    return false;
  record->generation = get(bytes + kGenerationAt);
  for (unsigned i = 0; i < 3u; ++i) record->version[i] = bytes[(unsigned)kVersionAt + i];
  for (unsigned i = 0; i < (unsigned)SYNC_SIGNATURE_BYTES; ++i)
    record->signature[i] = bytes[(unsigned)kSignatureAt + i];
  record->tried = get(bytes + kTriedAt) != kNothing;  // a torn mark is a mark
  record->confirmed = get(bytes + kConfirmedAt) == kConfirmed;
  return true;
}

static bool write_word(const flash* memory, uint32_t region, uint32_t offset, uint32_t word) {
  uint8_t bytes[4];
  put(bytes, word);
  return memory->write(memory->context, region, offset, bytes, sizeof bytes);
}

void update_init(update* self, const flash* memory, const update_verifier* verifier, uint32_t region_size,
                 uint32_t running) {
  const update fresh = {
      .memory = memory, .verifier = verifier, .region_size = region_size, .running = running};
  *self = fresh;
}

static uint32_t target(const update* self) {
  return self->running == (uint32_t)FLASH_IMAGE_A ? FLASH_IMAGE_B : FLASH_IMAGE_A;
}

uint8_t update_begin(update* self, const sync_update_begin* request) {
  if (request->size == 0u || request->size > self->region_size - (uint32_t)UPDATE_TRAILER)
    return SYNC_FAULT_RANGE;
  self->step = SYNC_UPDATE_NONE;
  self->unverified = false;
  if (!self->memory->erase(self->memory->context, target(self))) return SYNC_FAULT_FLASH;
  self->size = request->size;
  self->next = 0;
  for (unsigned i = 0; i < 3u; ++i) self->version[i] = request->version[i];
  self->step = SYNC_UPDATE_RECEIVING;
  return 0;
}

uint8_t update_block(update* self, const sync_update_block* request) {
  if (self->step != SYNC_UPDATE_RECEIVING) return SYNC_FAULT_SEQUENCE;
  // The answer to the block before was lost: it is in flash.
  if (self->next > 0u && request->offset == self->next - (uint32_t)SYNC_UPDATE_BLOCK_BYTES) return 0;
  if (request->offset != self->next || self->next >= self->size) return SYNC_FAULT_SEQUENCE;
  const uint32_t room = self->region_size - (uint32_t)UPDATE_TRAILER - self->next;
  const uint32_t size = room < (uint32_t)SYNC_UPDATE_BLOCK_BYTES ? room : (uint32_t)SYNC_UPDATE_BLOCK_BYTES;
  if (!self->memory->write(self->memory->context, target(self), self->next, request->bytes, size)) {
    self->step = SYNC_UPDATE_NONE;
    return SYNC_FAULT_FLASH;
  }
  self->next += (uint32_t)SYNC_UPDATE_BLOCK_BYTES;
  return 0;
}

uint8_t update_finish(update* self, const sync_update_finish* request) {
  if (self->step != SYNC_UPDATE_RECEIVING || self->next < self->size) return SYNC_FAULT_SEQUENCE;
  self->step = SYNC_UPDATE_NONE;
  for (unsigned i = 0; i < (unsigned)SYNC_SIGNATURE_BYTES; ++i) self->signature[i] = request->signature[i];
  self->unverified = true;
  return 0;
}

// Apart from update_verify, whose frame lies under the verifier's.
__attribute__((noinline)) static uint8_t write_record(update* self) {
  image_record running;
  const bool known = read_record(self->memory, self->running, self->region_size, &running);
  uint8_t bytes[kRecord] = {0};
  put(bytes + kMagicAt, kMagic);
  put(bytes + kSizeAt, self->size);
  for (unsigned i = 0; i < 3u; ++i) bytes[(unsigned)kVersionAt + i] = self->version[i];
  put(bytes + kGenerationAt, known ? running.generation + 1u : 1u);
  for (unsigned i = 0; i < (unsigned)SYNC_SIGNATURE_BYTES; ++i)
    bytes[(unsigned)kSignatureAt + i] = self->signature[i];
  put(bytes + kCrcAt, flash_crc32(0, bytes, kCrcAt));
  const uint32_t trailer = self->region_size - (uint32_t)UPDATE_TRAILER;
  if (!self->memory->write(self->memory->context, target(self), trailer, bytes, kRecord) ||
      !write_word(self->memory, target(self), trailer + (uint32_t)kWholeAt, kWhole))
    return SYNC_FAULT_FLASH;
  self->step = SYNC_UPDATE_PENDING;
  return 0;
}

uint8_t update_verify(update* self) {
  self->unverified = false;
  if (!self->verifier->verify(self->verifier->context, target(self), self->size, self->version,
                              self->signature))
    return SYNC_FAULT_SIGNATURE;
  return write_record(self);
}

bool update_confirm(const update* self) {
  image_record record;
  // An image that was put there by a programmer has no record, and needs none.
  if (!read_record(self->memory, self->running, self->region_size, &record) || record.confirmed) return true;
  return write_word(self->memory, self->running,
                    self->region_size - (uint32_t)UPDATE_TRAILER + (uint32_t)kConfirmedAt, kConfirmed);
}

uint32_t update_choose(const flash* memory, const update_verifier* verifier, uint32_t region_size) {
  image_record records[2] = {{0}};
  bool whole[2];
  for (uint32_t i = 0; i < 2u; ++i)
    whole[i] = read_record(memory, (uint32_t)FLASH_IMAGE_A + i, region_size, &records[i]);
  const bool second_newer = (int32_t)(records[1].generation - records[0].generation) > 0;
  uint32_t first = whole[1] && (!whole[0] || second_newer) ? 1u : 0u;
  // Tried and not confirmed: the other one, if there is one. Where both failed so, the newer is tried again.
  if (whole[first] && records[first].tried && !records[first].confirmed && whole[1u - first] &&
      (records[1u - first].confirmed || !records[1u - first].tried))
    first = 1u - first;
  for (uint32_t i = 0; i < 2u; ++i) {
    const uint32_t chosen = i == 0u ? first : 1u - first;
    const uint32_t region = (uint32_t)FLASH_IMAGE_A + chosen;
    if (!whole[chosen] || !verifier->verify(verifier->context, region, records[chosen].size,
                                            records[chosen].version, records[chosen].signature))
      continue;
    // If the mark cannot be written the image runs all the same: to run is better than not.
    if (!records[chosen].tried)
      (void)write_word(memory, region, region_size - (uint32_t)UPDATE_TRAILER + (uint32_t)kTriedAt, kTried);
    return region;
  }
  return FLASH_REGIONS;
}
