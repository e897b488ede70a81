// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/capture/aravis_source.h"

#include "daemon/capture/aravis_camera.h"
#include "daemon/capture/aravis_session.h"
#include "daemon/capture/watched_source.h"

namespace lightwell {
namespace {

// As Aravis names a camera that has no address: "Basler-21234567", "Fake_1".
bool is_camera_name(const std::string& address) {
  return address.find_first_of("-_") != std::string::npos;
}

}  // namespace

std::unique_ptr<CaptureSource> make_aravis_source(const std::string& address, const CaptureOptions& options) {
  Status refusal;
  if (!is_ipv4_address(address) && !is_camera_name(address))
    refusal =
        Error{ErrorKind::usage, "source aravis:" + address +
                                    ": an IPv4 address such as aravis:192.168.0.10 is expected, or "
                                    "VENDOR-SERIAL of a USB3 Vision camera such as aravis:Basler-21234567"};
  return std::make_unique<WatchedSource>(
      "aravis", address, [=] { return std::make_unique<AravisSession>(address, options); }, refusal);
}

}  // namespace lightwell
