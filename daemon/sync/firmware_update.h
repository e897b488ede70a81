// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "daemon/sync/sync_link.h"
#include "interface/firmware_file.h"
#include "interface/sync_protocol.h"

namespace lightwell {

// Writes the image for the slot that does not run, block by block; the board verifies its signature and starts it when it
// starts next (firmware/core/update.h). Until then, and whatever is cut on the way, it runs what it ran.
// progress: share that is done, 0 to 1; may be empty. Returns what the board said of itself before.
// bad_input: the file has no image for that slot. failed: the board cannot be updated, refuses (recording, signature,
// flash), is silent or gone.
Result<sync_hello> update_firmware(SyncLink& link, const FirmwareFile& firmware,
                                   const std::function<void(double)>& progress);

}  // namespace lightwell
