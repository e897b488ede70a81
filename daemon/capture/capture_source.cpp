// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/capture/capture_source.h"

namespace lightwell {

const char* name(SourceState state) {
  switch (state) {
    case SourceState::no_device:
      return "no device";
    case SourceState::opening:
      return "opening";
    case SourceState::no_signal:
      return "no signal";
    case SourceState::streaming:
      return "streaming";
    case SourceState::stalled:
      return "stalled";
    case SourceState::wrong_format:
      return "wrong format";
    case SourceState::ended:
      return "ended";
  }
  return "unknown";
}

}  // namespace lightwell
