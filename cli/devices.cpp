// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <net/if.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/command.h"
#include "daemon/capture/gvcp.h"
#include "daemon/capture/inspect_camera.h"
#include "daemon/capture/list_libcamera.h"
#include "daemon/capture/list_usb3.h"
#include "daemon/capture/list_v4l2.h"
#include "daemon/capture/v4l2_format.h"
#include "interface/option_range.h"

namespace lightwell::cli {
namespace {

struct Options {
  std::vector<std::string> interfaces;
  double timeout_s = 0.5;
  bool json = false;
};

nlohmann::json as_json(const GvcpDevice& device, const Result<CameraCapabilities>& camera) {
  nlohmann::json out = {{"source", "aravis:" + device.address},
                        {"address", device.address},
                        {"manufacturer", device.manufacturer},
                        {"model", device.model},
                        {"version", device.version},
                        {"serial", device.serial},
                        {"user_name", device.user_name},
                        {"mac", device.mac}};
  if (!camera) {
    out["unavailable"] = camera.error().message;
    return out;
  }
  out.update({{"width", camera->width},
              {"height", camera->height},
              {"sensor_size", {camera->sensor_width, camera->sensor_height}},
              {"pixel_format", camera->pixel_format},
              {"pixel_formats", camera->pixel_formats},
              {"rate_hz", camera->rate_hz},
              {"rate_range_hz", {camera->rate_min_hz, camera->rate_max_hz}},
              {"exposure_us", camera->exposure_us}});
  return out;
}

void print(const GvcpDevice& device, const Result<CameraCapabilities>& camera) {
  std::printf("aravis:%s  %s %s, serial %s%s%s\n", device.address.c_str(), device.manufacturer.c_str(),
              device.model.c_str(), device.serial.c_str(), device.user_name.empty() ? "" : ", named ",
              device.user_name.c_str());
  if (!camera) {
    std::printf("    %s\n", camera.error().message.c_str());
    return;
  }
  std::printf("    %d×%d %s at %.4g Hz (%.4g to %.4g), sensor %d×%d, formats", camera->width, camera->height,
              camera->pixel_format.c_str(), camera->rate_hz, camera->rate_min_hz, camera->rate_max_hz,
              camera->sensor_width, camera->sensor_height);
  for (const std::string& format : camera->pixel_formats) std::printf(" %s", format.c_str());
  std::printf("\n");
}

nlohmann::json as_json(const Usb3Description& camera) {
  return {{"source", "aravis:" + camera.name},
          {"manufacturer", camera.vendor},
          {"model", camera.model},
          {"serial", camera.serial}};
}

void print(const Usb3Description& camera) {
  std::printf("aravis:%s  %s %s, serial %s, USB3 Vision\n", camera.name.c_str(), camera.vendor.c_str(),
              camera.model.c_str(), camera.serial.c_str());
}

// What a format becomes here; empty: nothing we read.
std::string pixel_format_of(std::uint32_t fourcc) {
  const auto known = v4l2_format_of(fourcc);
  return known ? std::string(name(known->becomes)) : std::string();
}

nlohmann::json as_json(const V4l2Control& control) {
  using Kind = V4l2Control::Kind;
  constexpr std::array kKinds = {"integer", "boolean", "menu", "integer menu", "button", "other"};
  nlohmann::json out = {{"name", control.name},
                        {"kind", kKinds.at(static_cast<std::size_t>(control.kind))},
                        {"hdr", control.is_hdr()},
                        {"read_only", control.read_only},
                        {"inactive", control.inactive}};
  if (control.kind != Kind::button && control.kind != Kind::other)
    out.update({{"value", control.value},
                {"default", control.standard},
                {"range", {control.minimum, control.maximum}},
                {"step", control.step}});
  for (const auto& [index, words] : control.choices)
    out["choices"].push_back({{"value", index}, {"name", words}});
  return out;
}

nlohmann::json as_json(const V4l2Description& device) {
  nlohmann::json out = {{"source", "v4l2:" + device.path}, {"path", device.path}};
  if (!device.unavailable.empty()) {
    out["unavailable"] = device.unavailable;
    return out;
  }
  auto formats = nlohmann::json::array(), controls = nlohmann::json::array();
  for (const V4l2FormatDescription& format : device.formats) {
    auto sizes = nlohmann::json::array();
    for (const V4l2Size& size : format.sizes)
      sizes.push_back({{"width", {size.width, size.largest_width}},
                       {"height", {size.height, size.largest_height}},
                       {"rate_range_hz", {size.rate_min_hz, size.rate_max_hz}}});
    formats.push_back({{"fourcc", fourcc_name(format.fourcc)},
                       {"description", format.description},
                       {"pixel_format", pixel_format_of(format.fourcc)},
                       {"sizes", sizes}});
  }
  for (const V4l2Control& control : device.controls) controls.push_back(as_json(control));
  out.update({{"card", device.card},
              {"driver", device.driver},
              {"bus", device.bus},
              {"missing_signal", device.missing_signal},
              {"width", device.layout.width},
              {"height", device.layout.height},
              {"fourcc", fourcc_name(device.layout.fourcc)},
              {"pixel_format", pixel_format_of(device.layout.fourcc)},
              {"rate_hz", device.rate_hz},
              {"formats", formats},
              {"controls", controls}});
  return out;
}

std::string text(const V4l2Size& size) {
  std::array<char, 96> out{};
  const bool range = size.width != size.largest_width || size.height != size.largest_height;
  int n = std::snprintf(out.data(), out.size(), "%d×%d", size.width, size.height);
  if (range)
    n += std::snprintf(&out.at(static_cast<std::size_t>(n)), out.size() - static_cast<std::size_t>(n),
                       " to %d×%d", size.largest_width, size.largest_height);
  if (size.rate_max_hz > 0)
    std::snprintf(&out.at(static_cast<std::size_t>(n)), out.size() - static_cast<std::size_t>(n),
                  " at %.4g to %.4g Hz", size.rate_min_hz, size.rate_max_hz);
  return out.data();
}

void print(const V4l2Description& device) {
  if (!device.unavailable.empty()) {
    std::printf("v4l2:%s  %s\n", device.path.c_str(), device.unavailable.c_str());
    return;
  }
  std::printf("v4l2:%s  %s, driver %s, %s\n", device.path.c_str(), device.card.c_str(), device.driver.c_str(),
              device.bus.c_str());
  if (!device.missing_signal.empty()) std::printf("    %s\n", device.missing_signal.c_str());
  if (device.layout.width > 0)
    std::printf("    %d×%d %s at %.4g Hz\n", device.layout.width, device.layout.height,
                fourcc_name(device.layout.fourcc).c_str(), device.rate_hz);
  for (const V4l2FormatDescription& format : device.formats) {
    const std::string becomes = pixel_format_of(format.fourcc);
    if (becomes.empty()) continue;
    std::printf("    format %s, read as %s:", fourcc_name(format.fourcc).c_str(), becomes.c_str());
    for (const V4l2Size& size : format.sizes)
      std::printf(" %s%s", text(size).c_str(), &size == &format.sizes.back() ? "" : ",");
    std::printf("\n");
  }
  for (const V4l2Control& control : device.controls) {
    if (control.kind == V4l2Control::Kind::other || control.kind == V4l2Control::Kind::button) continue;
    std::printf("    control %s = %lld (%lld to %lld)%s%s\n", control.name.c_str(),
                static_cast<long long>(control.value), static_cast<long long>(control.minimum),
                static_cast<long long>(control.maximum), control.is_hdr() ? ", HDR" : "",
                control.read_only ? ", read only" : "");
  }
}

nlohmann::json as_json(const LibcameraDescription& camera) {
  auto formats = nlohmann::json::array(), controls = nlohmann::json::array();
  for (const auto& format : camera.formats)
    formats.push_back({{"name", format.name},
                       {"pixel_format", format.pixel_format},
                       {"raw", format.raw},
                       {"sizes", format.sizes}});
  for (const auto& [name, range] : camera.controls) controls.push_back({{"name", name}, {"range", range}});
  return {{"source", "libcamera:" + camera.id},
          {"id", camera.id},
          {"model", camera.model},
          {"formats", formats},
          {"controls", controls}};
}

void print(const LibcameraDescription& camera) {
  std::printf("libcamera:%s  %s\n", camera.id.c_str(), camera.model.c_str());
  for (const auto& format : camera.formats) {
    if (format.pixel_format.empty()) continue;
    std::printf("    format %s%s, read as %s:", format.name.c_str(), format.raw ? "" : " (processed)",
                format.pixel_format.c_str());
    for (const std::string& size : format.sizes) std::printf(" %s", size.c_str());
    std::printf("\n");
  }
  for (const auto& [name, range] : camera.controls)
    std::printf("    control %s %s\n", name.c_str(), range.c_str());
}

int run(const Options& options) {
  for (const std::string& name : options.interfaces) {
    if (::if_nametoindex(name.c_str()) != 0) continue;
    std::fprintf(stderr, "lightwell: --interface %s: this machine has no network interface of that name\n",
                 name.c_str());
    return 2;
  }
  if (std::isnan(options.timeout_s)) {  // no bound of a range refuses it
    std::fprintf(stderr, "lightwell: --timeout nan: allowed 0.05 to 60 s\n");
    return 2;
  }
  const auto timeout = std::chrono::milliseconds(static_cast<long>(options.timeout_s * 1000));
  const auto devices = gvcp_discover(timeout, options.interfaces);
  // --interface asks about a network alone.
  const auto usb3 = options.interfaces.empty() ? list_usb3() : std::vector<Usb3Description>();
  const auto local = options.interfaces.empty() ? list_v4l2() : std::vector<V4l2Description>();
  const auto through_libcamera =
      options.interfaces.empty() ? list_libcamera() : std::vector<LibcameraDescription>();
  auto list = nlohmann::json::array();
  for (const GvcpDevice& device : devices) {
    const auto camera = inspect_camera(device.address);
    if (options.json)
      list.push_back(as_json(device, camera));
    else
      print(device, camera);
  }
  const auto tell = [&](const auto& found) {
    for (const auto& device : found) {
      if (options.json)
        list.push_back(as_json(device));
      else
        print(device);
    }
  };
  tell(usb3);
  tell(local);
  tell(through_libcamera);
  // A device may say anything of itself, in any encoding.
  constexpr auto kReplace = nlohmann::json::error_handler_t::replace;
  if (options.json)
    std::printf("%s\n", nlohmann::json{{"devices", list}}.dump(2, ' ', false, kReplace).c_str());
  if (devices.empty()) std::fprintf(stderr, "lightwell: no GigE Vision device found\n");
  if (devices.empty() && options.interfaces.empty() && usb3.empty() && local.empty() &&
      through_libcamera.empty())
    std::fprintf(stderr, "lightwell: no USB3 Vision, V4L2 or libcamera camera either\n");
  return 0;
}

}  // namespace

Command add_devices(CLI::App& app) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      app.add_subcommand("devices", "Cameras on the network and in this machine, and what they can do");
  command
      ->add_option("--interface", options->interfaces,
                   "Only on this network interface, for example lo; may be repeated")
      ->type_name("NAME");
  command->add_option("--timeout", options->timeout_s, "Seconds to wait for answers, 0.05 to 60")
      ->check(numbers_from(0.05, 60, "0.05 to 60 seconds"))
      ->capture_default_str();
  command->add_flag("--json", options->json, "Machine-readable result on stdout");
  command->footer("Example: lightwell devices --interface eth0");
  return {command, [options] { return run(*options); }};
}

}  // namespace lightwell::cli
