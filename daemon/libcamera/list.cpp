// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/libcamera/list.h"

#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "daemon/libcamera/camera.h"

namespace lightwell {
namespace {

void add_formats(libcamera::Camera& camera, libcamera::StreamRole role, std::set<std::string>& seen,
                 nlohmann::json& out) {
  const auto configuration = camera.generateConfiguration({role});
  if (configuration == nullptr || configuration->empty()) return;
  const libcamera::StreamFormats& formats = configuration->at(0).formats();
  for (const libcamera::PixelFormat& format : formats.pixelformats()) {
    if (!seen.insert(format.toString()).second) continue;
    nlohmann::json f = {{"name", format.toString()}, {"pixel_format", ""}, {"raw", false}};
    if (const auto ours = libcamera_format_of(format.fourcc(), format.modifier())) {
      f["pixel_format"] = name(ours->frame_format(16, 16).pixel_format);
      f["raw"] = !ours->processed;
    }
    auto sizes = nlohmann::json::array();
    for (const libcamera::Size& size : formats.sizes(format)) sizes.push_back(size.toString());
    f["sizes"] = sizes;
    out.push_back(std::move(f));
  }
}

}  // namespace

std::string list_cameras() {
  auto list = nlohmann::json::array();
  const auto manager = start_libcamera();
  if (manager == nullptr) return list.dump();
  for (const auto& camera : manager->cameras()) {
    auto formats = nlohmann::json::array();
    std::set<std::string> seen;
    add_formats(*camera, libcamera::StreamRole::Raw, seen, formats);
    add_formats(*camera, libcamera::StreamRole::Viewfinder, seen, formats);
    std::map<std::string, std::string> controls;
    for (const auto& [id, range] : camera->controls()) controls[id->name()] = range.toString();
    list.push_back({{"id", camera->id()},
                    {"model", camera->properties().get(libcamera::properties::Model).value_or("")},
                    {"formats", formats},
                    {"controls", controls}});
  }
  manager->stop();
  return list.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace lightwell
