// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <net/if.h>

#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/command.h"
#include "daemon/capture/gvcp.h"
#include "daemon/capture/inspect_camera.h"
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
  auto list = nlohmann::json::array();
  for (const GvcpDevice& device : devices) {
    const auto camera = inspect_camera(device.address);
    if (options.json)
      list.push_back(as_json(device, camera));
    else
      print(device, camera);
  }
  // A device may say anything of itself, in any encoding.
  constexpr auto kReplace = nlohmann::json::error_handler_t::replace;
  if (options.json)
    std::printf("%s\n", nlohmann::json{{"devices", list}}.dump(2, ' ', false, kReplace).c_str());
  if (devices.empty()) std::fprintf(stderr, "lightwell: no GigE Vision device found\n");
  return 0;
}

}  // namespace

Command add_devices(CLI::App& app) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      app.add_subcommand("devices", "Cameras that answer on the network, and what they can do");
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
