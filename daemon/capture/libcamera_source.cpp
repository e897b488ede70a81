// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/capture/libcamera_source.h"

#include "daemon/capture/libcamera_session.h"
#include "daemon/capture/watched_source.h"

namespace lightwell {

std::unique_ptr<CaptureSource> make_libcamera_source(const std::string& id, const CaptureOptions& options) {
  const auto search = std::make_shared<LibcameraSearch>();
  return std::make_unique<WatchedSource>(
      "libcamera", id, [=] { return std::make_unique<LibcameraSession>(search, id, options); });
}

}  // namespace lightwell
