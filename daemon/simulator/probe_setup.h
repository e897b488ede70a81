// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "daemon/simulator/probe_model.h"
#include "daemon/simulator/scene.h"
#include "lighting/result.h"

namespace lightwell::simulator {

// What a user asks of a simulated probe; 0 or empty: the default.
struct ProbeOptions {
  std::string scenario = "day";
  std::vector<std::filesystem::path> environments;  // instead of the scenario, where there are any
  double hold_s = 5;                                // seconds that each environment is shown
  int width = 640, height = 480;
  std::string pixel_format = "Mono12";
  double rate_hz = 30;
  double exposure_us = 0;          // 0: the scene's own, at most 4/5 of the frame period
  std::filesystem::path response;  // instead of the default sensor; read out at the format's bits
  std::filesystem::path lens;      // instead of the default lens; its image_size must be width × height
  double noise_codes = 1;          // of 12 bits
  std::uint64_t seed = 1;
};

// A scene and the camera that looks at it.
struct ProbeSetup {
  std::shared_ptr<const Scene> scene;
  ProbeModel model;
  double rate_hz = 0;
  double exposure_us = 0;
  std::vector<std::string> messages;  // lines for the user: images that had to be repaired
};

// usage: a value out of range; bad_input: a file that cannot be read or does not fit.
Result<ProbeSetup> set_up_probe(const ProbeOptions& options);

}  // namespace lightwell::simulator
