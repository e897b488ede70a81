// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "daemon/capture/capture_source.h"

namespace lightwell {

// address: the IPv4 address of a GigE Vision camera, or "VENDOR-SERIAL" of a USB3 Vision camera (or of a GigE Vision
// camera, by broadcast); checked by start.
std::unique_ptr<CaptureSource> make_aravis_source(const std::string& address, const CaptureOptions& options);

}  // namespace lightwell
