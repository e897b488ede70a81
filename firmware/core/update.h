// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// Two images, of which one runs while the other is replaced; the same code writes them and, in the boot program, chooses.
//
// An image's region holds the image, and in its last UPDATE_TRAILER bytes a record: magic, size, version, generation,
// signature, CRC of these; then three words that are written later, one at a time: whole, tried, confirmed.
//   finish:  the image in flash is verified, then the record is written, then `whole`. Before that word the region does
//            not count; a word is written by one flash operation.
//   boot:    of the regions whose record is whole and whose image verifies, the newest runs, unless it was tried and never
//            confirmed. `tried` is written before it runs. Signatures are verified at every start: flash that has changed
//            since is not run either.
//   confirm: an image that has talked to its host for a while writes `confirmed`.
// So a power cut at any step leaves what ran before, and an image that starts but does not work is left at the next start.

#include "firmware/core/flash.h"
#include "interface/sync_protocol.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { UPDATE_TRAILER = 128 };

// Whether a region's first size bytes were signed by us for that region. The signed bytes and their order: image, then version
// (3 bytes), slot (1 byte, 0 or 1), size (u32).
typedef struct {
  void* context;
  bool (*verify)(void* context, uint32_t region, uint32_t size, const uint8_t version[3],
                 const uint8_t signature[SYNC_SIGNATURE_BYTES]);
} update_verifier;

// For a board without one: no image is ours.
bool update_verify_none(void* context, uint32_t region, uint32_t size, const uint8_t version[3],
                        const uint8_t signature[SYNC_SIGNATURE_BYTES]);

typedef struct {
  const flash* memory;
  const update_verifier* verifier;
  uint32_t region_size;  // of the smaller image region
  uint32_t running;      // FLASH_IMAGE_A or _B
  uint32_t size, next;
  uint8_t version[3];
  uint8_t signature[SYNC_SIGNATURE_BYTES];
  bool unverified;  // the image is here: update_verify is to be called
  sync_update_step step;
} update;

void update_init(update* self, const flash* memory, const update_verifier* verifier, uint32_t region_size,
                 uint32_t running);

// Each returns 0 or a sync_fault_code. Beginning anew at any time is allowed.
uint8_t update_begin(update* self, const sync_update_begin* request);
uint8_t update_block(update* self, const sync_update_block* request);
uint8_t update_finish(update* self, const sync_update_finish* request);

// The second half of finish, apart because a signature needs most of the stack: call it from the top of the loop while
// unverified is set. Returns as the others do.
uint8_t update_verify(update* self);

// The running image works. Writes nothing where that is known already. False: flash failed.
bool update_confirm(const update* self);

// For the boot program: the region to run, and marks it tried; FLASH_REGIONS: none may run.
uint32_t update_choose(const flash* memory, const update_verifier* verifier, uint32_t region_size);

#ifdef __cplusplus
}
#endif
