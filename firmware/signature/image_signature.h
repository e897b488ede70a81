// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// An update's verifier: Ed25519 (RFC 8032) over the SHA-512 digest of update.h's signed bytes, so that an image need not be in
// memory as a whole. scripts/firmware-sign is the other side.

#include "firmware/core/flash.h"
#include "firmware/core/update.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { IMAGE_SIGNATURE_KEY = 32 };

typedef struct {
  const flash* memory;
  const uint8_t* public_key;  // IMAGE_SIGNATURE_KEY bytes
} image_signer;

// update_verifier.verify; context is an image_signer.
bool image_signature_verify(void* context, uint32_t region, uint32_t size, const uint8_t version[3],
                            const uint8_t signature[SYNC_SIGNATURE_BYTES]);

#ifdef __cplusplus
}
#endif
