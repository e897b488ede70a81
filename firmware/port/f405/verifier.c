// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// Who may sign images: the key that the build was given.
#include "firmware/port/f405/port.h"
#include "firmware/signature/image_signature.h"

extern const uint8_t sync_public_key[IMAGE_SIGNATURE_KEY];

static image_signer signer = {.memory = &chip_flash, .public_key = sync_public_key};
static const update_verifier kVerifier = {.context = &signer, .verify = image_signature_verify};

const update_verifier* chip_verifier(void) {
  return &kVerifier;
}
