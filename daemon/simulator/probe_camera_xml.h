// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace lightwell::simulator {

// The camera's GenICam description, daemon/simulator/probe_camera.xml, inside the program.
extern const std::string_view kProbeCameraXml;

}  // namespace lightwell::simulator
