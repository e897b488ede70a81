// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "firmware/signature/image_signature.h"

#include "monocypher-ed25519.h"

enum { kDigest = 64, kChunk = 64, kSuffix = 8 };

// Apart from the check of the signature, which needs most of the stack.
__attribute__((noinline)) static void digest_image(const flash* memory, uint32_t region, uint32_t size,
                                                   const uint8_t version[3], uint8_t digest[kDigest]) {
  const uint8_t suffix[kSuffix] = {version[0],
                                   version[1],
                                   version[2],
                                   (uint8_t)(region - (uint32_t)FLASH_IMAGE_A),
                                   (uint8_t)size,
                                   (uint8_t)(size >> 8),
                                   (uint8_t)(size >> 16),
                                   (uint8_t)(size >> 24)};
  uint8_t chunk[kChunk];
  crypto_sha512_ctx hash;
  crypto_sha512_init(&hash);
  for (uint32_t at = 0; at < size; at += (uint32_t)kChunk) {
    const uint32_t count = size - at < (uint32_t)kChunk ? size - at : (uint32_t)kChunk;
    memory->read(memory->context, region, at, chunk, count);
    crypto_sha512_update(&hash, chunk, count);
  }
  crypto_sha512_update(&hash, suffix, sizeof suffix);
  crypto_sha512_final(&hash, digest);
}

bool image_signature_verify(void* context, uint32_t region, uint32_t size, const uint8_t version[3],
                            const uint8_t signature[SYNC_SIGNATURE_BYTES]) {
  const image_signer* signer = (const image_signer*)context;
  uint8_t digest[kDigest];
  digest_image(signer->memory, region, size, version, digest);
  return crypto_ed25519_check(signature, signer->public_key, digest, sizeof digest) == 0;
}
