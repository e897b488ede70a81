// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "daemon/simulator/prepared_frames.h"
#include "daemon/simulator/probe_setup.h"
#include "lighting/result.h"

namespace lightwell::simulator {

struct GigeCameraOptions {
  std::string address = "127.0.0.1";
  double loss = 0;  // part of the packets that are not sent, 0 to 1
};

// The simulated probe on the wire: GigE Vision over Aravis's fake camera, with our GenICam description. The
// sensor's size is fixed; a client that asks for another region is refused where it checks ranges, and gets
// whole frames where it does not.
class GigeCamera {
 public:
  // sent: called in order on a thread of the camera's for every frame that left.
  // usage: the address is not IPv4; failed: it is not this machine's, or a camera is there already.
  static Result<std::unique_ptr<GigeCamera>> start(const GigeCameraOptions& options, const ProbeSetup& setup,
                                                   std::function<void(const SentFrame&)> sent);
  virtual ~GigeCamera() = default;
  // Frames that left so far.
  [[nodiscard]] virtual std::uint64_t frames() const = 0;
  // Off the wire; returns when every frame that left has been told to `sent`.
  virtual void stop() = 0;
};

}  // namespace lightwell::simulator
