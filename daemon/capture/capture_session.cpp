// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/capture/capture_session.h"

namespace lightwell {

Status CaptureSession::set_exposure_us(double) {
  return Error{ErrorKind::failed, "it cannot change while frames come"};
}

std::optional<CaptureFault> refuse_trigger(const CaptureOptions& options, SessionSettings& settings) {
  if (options.trigger.empty() || options.trigger == "off") return std::nullopt;
  if (options.trigger != "any")
    return CaptureFault{
        SourceState::opening,
        "trigger = \"" + options.trigger +
            "\": no trigger can be set here; leave it empty, or see whether a control does it"};
  settings.remark += (settings.remark.empty() ? "" : "; ") + std::string("no trigger can be set");
  return std::nullopt;
}

}  // namespace lightwell
