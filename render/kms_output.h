// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <xf86drmMode.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "lighting/result.h"

namespace lightwell::render {

// What the kernel says of a graphics device's outputs.
struct KmsTable {
  struct Connector {
    std::uint32_t id = 0;
    bool connected = false;
    std::vector<drmModeModeInfo> modes;              // the kernel's best first
    std::vector<std::uint32_t> encoder_controllers;  // a mask of controllers each
  };
  std::vector<std::uint32_t> controllers;  // CRTCs
  std::vector<Connector> connectors;
};

struct KmsOutput {
  std::uint32_t connector = 0;
  std::uint32_t controller = 0;
  drmModeModeInfo mode{};
};

// The first connected screen that has a mode and a controller that can drive it; its preferred mode, else the first.
// failed: there is none, and why.
Result<KmsOutput> choose_output(const KmsTable& table);

// Graphics devices of a folder, by their numbers.
std::vector<std::filesystem::path> graphics_devices(const std::filesystem::path& folder);

}  // namespace lightwell::render
