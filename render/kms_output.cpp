// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/kms_output.h"

#include <algorithm>

namespace lightwell::render {
namespace {

// 0: none.
std::uint32_t controller_for(const KmsTable& table, const KmsTable::Connector& connector) {
  for (const std::uint32_t mask : connector.encoder_controllers)
    for (std::size_t k = 0; k < table.controllers.size() && k < 32; ++k)
      if ((mask >> k & 1u) != 0) return table.controllers[k];
  return 0;
}

}  // namespace

Result<KmsOutput> choose_output(const KmsTable& table) {
  std::string why = "none is connected";
  for (const KmsTable::Connector& connector : table.connectors) {
    if (!connector.connected) continue;
    if (connector.modes.empty()) {
      why = "what is connected tells no mode";
      continue;
    }
    const std::uint32_t controller = controller_for(table, connector);
    if (controller == 0) {
      why = "no display controller can drive what is connected";
      continue;
    }
    const auto preferred =
        std::find_if(connector.modes.begin(), connector.modes.end(),
                     [](const drmModeModeInfo& mode) { return (mode.type & DRM_MODE_TYPE_PREFERRED) != 0; });
    return KmsOutput{connector.id, controller,
                     preferred != connector.modes.end() ? *preferred : connector.modes.front()};
  }
  return Error{ErrorKind::failed, why};
}

std::vector<std::filesystem::path> graphics_devices(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> devices;
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator(folder, none))
    if (entry.path().filename().string().starts_with("card")) devices.push_back(entry.path());
  std::sort(devices.begin(), devices.end(), [](const auto& a, const auto& b) {
    const auto size = [](const auto& path) { return path.native().size(); };
    return size(a) != size(b) ? size(a) < size(b) : a < b;
  });
  return devices;
}

}  // namespace lightwell::render
