// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <arv.h>

#include <memory>
#include <optional>
#include <string>

#include "daemon/capture/capture_session.h"

// The questions and orders of a session to a camera of GenICam, through Aravis. Every call waits for the camera's answer:
// milliseconds, up to 2.5 s a feature where the camera is dead. For one thread at a time.

namespace lightwell {

struct GObjectUnref {
  void operator()(void* object) const { g_object_unref(object); }
};
using CameraHandle = std::unique_ptr<ArvCamera, GObjectUnref>;

// "192.168.1.20": of the form of an IPv4 address, and one.
bool is_ipv4_address(const std::string& address);

// address: IPv4 of a GigE Vision camera, which is asked directly; or "VENDOR-SERIAL" of a USB3 Vision camera or a GigE
// Vision camera, which is looked for on every bus (a second). Requires control, and stops a camera that still streams
// for a client that has died.
std::optional<CaptureFault> open_camera(const std::string& address, CameraHandle& camera);

// Sets what was asked for and reads back what was granted. What is refused is named, with the camera's own words.
std::optional<CaptureFault> configure_camera(ArvCamera* camera, const CaptureOptions& options,
                                             SessionSettings& settings);

// Ends automatic exposure first. failed: refused, with the range that the camera allows.
Status set_exposure(ArvCamera* camera, double exposure_us);

// What may change while frames come.
struct CameraValues {
  double exposure_us = 0;
  double gain_db = 0;
  float temperature_c = 0;  // NaN where the camera has none
  std::string ptp;          // of IEEE 1588 in the camera's word ("Slave"); empty: off, or it has none
};
// nullopt: the camera does not answer.
std::optional<CameraValues> read_values(ArvCamera* camera);

}  // namespace lightwell
