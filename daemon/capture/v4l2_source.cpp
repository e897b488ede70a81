// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/capture/v4l2_source.h"

#include "daemon/capture/v4l2_session.h"
#include "daemon/capture/watched_source.h"

namespace lightwell {

std::unique_ptr<CaptureSource> make_v4l2_source(const std::string& path, const CaptureOptions& options,
                                                V4l2Calls& calls) {
  Status usable;
  if (!path.starts_with('/'))
    usable = Error{ErrorKind::usage, "source v4l2:" + path + ": a path such as v4l2:/dev/video0 is expected"};
  return std::make_unique<WatchedSource>(
      "v4l2", path, [=, &calls] { return std::make_unique<V4l2Session>(path, calls, options); }, usable);
}

}  // namespace lightwell
