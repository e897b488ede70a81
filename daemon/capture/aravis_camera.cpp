// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/capture/aravis_camera.h"

#include <arpa/inet.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "daemon/capture/aravis_trigger.h"
#include "daemon/capture/glib_error.h"
#include "daemon/capture/gvcp.h"
#include "daemon/capture/network_path.h"
#include "daemon/capture/socket_buffer.h"

namespace lightwell {
namespace {

using namespace std::chrono_literals;

constexpr auto kRegisterTimeout = 300ms;
constexpr auto kRetryRefused = 500ms;  // opening a camera is some hundred questions

CaptureFault fault(std::string message) {
  return {SourceState::opening, std::move(message), kRetryRefused};
}

CaptureFault not_taken(const std::string& what, const GlibError& error) {
  return fault("does not take " + what + ": " + error.text());
}

CaptureFault not_told(const std::string& what, const GlibError& error) {
  return fault("does not tell its " + what + ": " + error.text());
}

void add_remark(SessionSettings& settings, const std::string& words) {
  settings.remark += (settings.remark.empty() ? "" : "; ") + words;
}

std::string supported_formats() {
  std::string list;
  for (int i = 0; i <= static_cast<int>(PixelFormat::bayer_rg16); ++i) {
    if (i > 0) list += ", ";
    list += name(static_cast<PixelFormat>(i));
  }
  return list;
}

// Aravis would look for the address on every bus and interface.
CameraHandle camera_at(const std::string& address, GlibError& error) {
  using Address = std::unique_ptr<GInetAddress, GObjectUnref>;
  const Address there(g_inet_address_new_from_string(address.c_str()));
  const Address here(g_inet_address_new_from_string(path_to(address).local_address.c_str()));
  if (there == nullptr || here == nullptr) return nullptr;
  const std::unique_ptr<ArvDevice, GObjectUnref> device(
      arv_gv_device_new(here.get(), there.get(), error.out()));
  if (device == nullptr || error) return nullptr;
  return CameraHandle(arv_camera_new_with_device(device.get(), error.out()));
}

std::optional<CaptureFault> set_picture(ArvCamera* camera, const CaptureOptions& options) {
  GlibError error;
  if (!options.pixel_format.empty()) {
    arv_camera_set_pixel_format_from_string(camera, options.pixel_format.c_str(), error.out());
    if (error) return not_taken("PixelFormat " + options.pixel_format, error);
  }
  if (options.width > 0 || options.height > 0) {
    // From the sensor's corner, so that pixel coordinates stay those of the lens calibration.
    arv_camera_set_region(camera, 0, 0, options.width > 0 ? options.width : -1,
                          options.height > 0 ? options.height : -1, error.out());
    if (error) return not_taken(fmt::format("Width {}, Height {}", options.width, options.height), error);
  }
  return std::nullopt;
}

void write_exposure(ArvCamera* camera, double exposure_us, GlibError& error) {
  if (arv_camera_is_exposure_auto_available(camera, nullptr))
    arv_camera_set_exposure_time_auto(camera, ARV_AUTO_OFF, error.out());
  if (!error) arv_camera_set_exposure_time(camera, exposure_us, error.out());
}

std::optional<CaptureFault> set_timing(ArvCamera* camera, const CaptureOptions& options,
                                       SessionSettings& settings) {
  GlibError error;
  if (options.rate_hz > 0) {  // also ends triggering, and so comes before it
    arv_camera_set_frame_rate(camera, options.rate_hz, error.out());
    if (error) return not_taken(fmt::format("frame rate {:g} Hz", options.rate_hz), error);
  }
  if (options.exposure_us > 0) {
    write_exposure(camera, options.exposure_us, error);
    if (error) return not_taken(fmt::format("exposure {:g} µs", options.exposure_us), error);
  }
  if (options.ptp) {
    const char* enable = arv_camera_is_feature_available(camera, "PtpEnable", nullptr)     ? "PtpEnable"
                         : arv_camera_is_feature_available(camera, "GevIEEE1588", nullptr) ? "GevIEEE1588"
                                                                                           : nullptr;
    if (enable != nullptr) arv_camera_set_boolean(camera, enable, TRUE, error.out());
    if (error) return not_taken(enable, error);
    if (enable == nullptr) add_remark(settings, "has no PTP");
  }
  return set_trigger(camera, options, settings);
}

std::optional<CaptureFault> set_packets(ArvCamera* camera, const CaptureOptions& options,
                                        SessionSettings& settings) {
  if (!arv_camera_is_gv_device(camera)) return std::nullopt;
  GlibError error;
  arv_camera_gv_set_packet_size_adjustment(camera, ARV_GV_PACKET_SIZE_ADJUSTMENT_NEVER);
  GSocketAddress* device = arv_gv_device_get_device_address(ARV_GV_DEVICE(arv_camera_get_device(camera)));
  char* address = g_inet_address_to_string(g_inet_socket_address_get_address(G_INET_SOCKET_ADDRESS(device)));
  const int mtu = path_to(address).mtu;
  g_free(address);
  const int packet = mtu > 0 ? std::min(options.packet_size, mtu) : options.packet_size;
  arv_camera_gv_set_packet_size(camera, packet, error.out());
  if (error) return not_taken(fmt::format("packets of {} bytes", packet), error);
  const guint granted = arv_camera_gv_get_packet_size(camera, error.out());
  if (error) return not_told("packet size", error);
  add_remark(settings, fmt::format("packets of {} bytes", granted));
  return std::nullopt;
}

std::optional<CaptureFault> read_format(ArvCamera* camera, SessionSettings& settings) {
  GlibError error;
  const char* format = arv_camera_get_pixel_format_as_string(camera, error.out());
  if (error || format == nullptr) return not_told("PixelFormat", error);
  const auto known = pixel_format_from_name(format);
  if (!known)
    return fault(std::string("sends PixelFormat ") + format + ", which is not supported; " +
                 supported_formats() + " are");
  gint x = 0, y = 0, width = 0, height = 0;
  arv_camera_get_region(camera, &x, &y, &width, &height, error.out());
  if (error) return not_told("Width, Height", error);
  settings.format = {width, height, *known};
  return std::nullopt;
}

std::optional<CaptureFault> read_rate(ArvCamera* camera, const CaptureOptions& options,
                                      SessionSettings& settings) {
  GlibError error;
  if (arv_camera_is_frame_rate_available(camera, nullptr))
    settings.rate_hz = arv_camera_get_frame_rate(camera, error.out());
  if (error) return not_told("frame rate", error);
  // A rate off by more than a per cent was clamped, not rounded.
  if (options.rate_hz > 0 && std::abs(settings.rate_hz - options.rate_hz) > 0.01 * options.rate_hz)
    add_remark(settings,
               fmt::format("asked for {:g} Hz, the camera grants {:g}", options.rate_hz, settings.rate_hz));
  if (!settings.free_running && options.trigger_rate_hz > 0) settings.rate_hz = options.trigger_rate_hz;
  return std::nullopt;
}

}  // namespace

bool is_ipv4_address(const std::string& address) {
  in_addr parsed{};
  return ::inet_pton(AF_INET, address.c_str(), &parsed) == 1;
}

std::optional<CaptureFault> open_camera(const std::string& address, CameraHandle& camera) {
  const CaptureFault occupied =
      fault("serves another program: another program has control of the camera, and it can serve only one");
  GlibError error;
  if (is_ipv4_address(address)) {
    // To be refused control takes Aravis seconds, and one register tells.
    if (gvcp_read_register(address, kGvcpControlPrivilege, kRegisterTimeout).value_or(0) != 0)
      return occupied;
    camera = camera_at(address, error);
  } else {
    camera.reset(arv_camera_new(address.c_str(), error.out()));
  }
  if (camera == nullptr || error) {
    if (error.is(ARV_DEVICE_ERROR, ARV_DEVICE_ERROR_NOT_FOUND))
      return CaptureFault{SourceState::no_device, "is not there; check name, cable and power", kRetryRefused};
    return fault(std::string("cannot be opened: ") + error.text());
  }
  ArvDevice* device = arv_camera_get_device(camera.get());
  if (ARV_IS_GV_DEVICE(device) && !arv_gv_device_is_controller(ARV_GV_DEVICE(device))) return occupied;
  // Off by default, and then a value out of range is accepted without a word.
  arv_camera_set_range_check_policy(camera.get(), ARV_RANGE_CHECK_POLICY_ENABLE);
  arv_camera_set_access_check_policy(camera.get(), ARV_ACCESS_CHECK_POLICY_ENABLE);
  // A camera whose last client died still streams to it, and refuses new settings meanwhile.
  arv_camera_stop_acquisition(camera.get(), error.out());
  if (error) return not_taken("AcquisitionStop", error);
  return std::nullopt;
}

std::optional<CaptureFault> configure_camera(ArvCamera* camera, const CaptureOptions& options,
                                             SessionSettings& settings) {
  const auto text = [&](const char* (*get)(ArvCamera*, GError**)) {
    const char* value = get(camera, nullptr);
    return std::string(value != nullptr ? value : "?");
  };
  settings.name = text(arv_camera_get_vendor_name) + " " + text(arv_camera_get_model_name) + " (" +
                  text(arv_camera_get_device_serial_number) + ")";
  if (auto refused = set_picture(camera, options)) return refused;
  if (auto refused = set_timing(camera, options, settings)) return refused;
  if (auto refused = set_packets(camera, options, settings)) return refused;
  if (auto unknown = read_format(camera, settings)) return unknown;
  if (auto unknown = read_rate(camera, options, settings)) return unknown;
  if (!arv_camera_is_gv_device(camera) || has_packet_socket()) return std::nullopt;
  const std::string small =
      socket_buffer_remark(settings.format.bytes(), granted_socket_buffer(options.socket_buffer_bytes));
  if (!small.empty()) add_remark(settings, small);
  return std::nullopt;
}

Status set_exposure(ArvCamera* camera, double exposure_us) {
  GlibError error;
  write_exposure(camera, exposure_us, error);
  if (!error) return {};
  std::string words = error.text();
  double lowest = 0, highest = 0;
  GlibError range;
  arv_camera_get_exposure_time_bounds(camera, &lowest, &highest, range.out());
  if (!range) words += fmt::format("; allowed {:g} to {:g} µs", lowest, highest);
  return Error{ErrorKind::failed, words};
}

std::optional<CameraValues> read_values(ArvCamera* camera) {
  bool answered = true;
  // A camera that does not answer must not pass for one without the feature, and is not asked again.
  const auto read = [&](auto is_available, auto absent, auto get) {
    GlibError error;
    if (!answered) return absent;
    const bool available = is_available(error.out());
    auto value = available && !error ? get(error.out()) : absent;
    answered = !error;
    return value;
  };
  const auto has = [&](const char* feature) {
    return [=](GError** e) { return arv_camera_is_feature_available(camera, feature, e); };
  };
  CameraValues values;
  values.exposure_us = read([&](GError** e) { return arv_camera_is_exposure_time_available(camera, e); }, 0.0,
                            [&](GError** e) { return arv_camera_get_exposure_time(camera, e); });
  values.gain_db = read([&](GError** e) { return arv_camera_is_gain_available(camera, e); }, 0.0,
                        [&](GError** e) { return arv_camera_get_gain(camera, e); });
  values.temperature_c = static_cast<float>(
      read(has("DeviceTemperature"), std::numeric_limits<double>::quiet_NaN(),
           [&](GError** e) { return arv_camera_get_float(camera, "DeviceTemperature", e); }));
  // SFNC 2.3 and 1.5 have other names for the same.
  for (const auto& [enable, latch, status] :
       {std::array{"PtpEnable", "PtpDataSetLatch", "PtpStatus"},
        std::array{"GevIEEE1588", "GevIEEE1588DataSetLatch", "GevIEEE1588Status"}}) {
    const bool on = read(has(enable), false, [&, name = enable](GError** e) {
      return arv_camera_get_boolean(camera, name, e) != FALSE;
    });
    if (!on) continue;
    read(has(latch), true, [&, name = latch](GError** e) {
      arv_camera_execute_command(camera, name, e);
      return true;
    });
    values.ptp = read(has(status), std::string("on"), [&, name = status](GError** e) {
      const char* word = arv_camera_get_string(camera, name, e);
      return std::string(word != nullptr ? word : "on");
    });
    break;
  }
  if (!answered) return std::nullopt;
  return values;
}

}  // namespace lightwell
