// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/capture/list_libcamera.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "daemon/capture/libcamera_process.h"

namespace lightwell {
namespace {

// What the program writes; empty where there is none, as in builds without libcamera.
std::string said(const std::string& program) {
  std::string text;
  if (::access(program.c_str(), X_OK) != 0) return text;
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(::popen(("'" + program + "' --list").c_str(), "re"),
                                                   ::pclose);
  std::array<char, 4096> block{};
  while (pipe != nullptr) {
    const std::size_t n = std::fread(block.data(), 1, block.size(), pipe.get());
    if (n == 0) break;
    text.append(block.data(), n);
  }
  return text;
}

}  // namespace

std::vector<LibcameraDescription> list_libcamera() {
  std::vector<LibcameraDescription> list;
  const auto cameras = nlohmann::json::parse(said(libcamera_program()), nullptr, false);
  if (!cameras.is_array()) return list;
  for (const auto& camera : cameras) {
    LibcameraDescription d;
    d.id = camera.value("id", "");
    d.model = camera.value("model", "");
    for (const auto& format : camera.value("formats", nlohmann::json::array()))
      d.formats.push_back({format.value("name", ""), format.value("pixel_format", ""),
                           format.value("raw", false), format.value("sizes", std::vector<std::string>())});
    const auto controls = camera.value("controls", nlohmann::json::object());
    for (const auto& [name, range] : controls.items())
      d.controls.emplace_back(name, range.get<std::string>());
    list.push_back(std::move(d));
  }
  std::sort(list.begin(), list.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
  return list;
}

}  // namespace lightwell
