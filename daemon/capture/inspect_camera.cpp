// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/capture/inspect_camera.h"

#include <arv.h>

#include <memory>

#include "daemon/capture/glib_error.h"
#include "daemon/capture/gvcp.h"

namespace lightwell {
namespace {

CameraCapabilities read(ArvCamera* camera) {
  // What a camera lacks stays 0 or empty: cameras differ, and the list is for a person.
  CameraCapabilities c;
  gint x = 0, y = 0;
  arv_camera_get_region(camera, &x, &y, &c.width, &c.height, nullptr);
  arv_camera_get_sensor_size(camera, &c.sensor_width, &c.sensor_height, nullptr);
  if (const char* format = arv_camera_get_pixel_format_as_string(camera, nullptr)) c.pixel_format = format;
  guint count = 0;
  const char** formats = arv_camera_dup_available_pixel_formats_as_strings(camera, &count, nullptr);
  for (guint i = 0; formats != nullptr && i < count; ++i) c.pixel_formats.emplace_back(formats[i]);
  g_free(formats);
  if (arv_camera_is_frame_rate_available(camera, nullptr)) {
    c.rate_hz = arv_camera_get_frame_rate(camera, nullptr);
    arv_camera_get_frame_rate_bounds(camera, &c.rate_min_hz, &c.rate_max_hz, nullptr);
  }
  if (arv_camera_is_exposure_time_available(camera, nullptr))
    c.exposure_us = arv_camera_get_exposure_time(camera, nullptr);
  return c;
}

}  // namespace

Result<CameraCapabilities> inspect_camera(const std::string& address) {
  const auto privilege = gvcp_read_register(address, kGvcpControlPrivilege, std::chrono::milliseconds(500));
  if (!privilege) return Error{ErrorKind::failed, "camera at " + address + " does not answer"};
  if (*privilege != 0)
    return Error{ErrorKind::failed, "camera at " + address + " is in use by another program"};
  GlibError error;
  const std::unique_ptr<ArvCamera, decltype(&g_object_unref)> camera(
      arv_camera_new(address.c_str(), error.out()), g_object_unref);
  if (camera == nullptr || error)
    return Error{ErrorKind::failed, "camera at " + address + " cannot be opened: " + error.text()};
  return read(camera.get());
}

}  // namespace lightwell
