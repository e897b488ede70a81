// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>

#include "interface/dds_topics.h"
#include "lighting/lat_long_image.h"
#include "lighting/light_set.h"

namespace lightwell::render {

// Where the light of a frame comes from.
class LightSource {
 public:
  virtual ~LightSource() = default;
  // Brings the light of a frame; true where it differs from the one before. Live: waits at most this long.
  virtual Result<bool> update(int frame, std::chrono::milliseconds wait) = 0;
  // False: no light has arrived yet.
  [[nodiscard]] virtual bool ready() const { return true; }
  [[nodiscard]] const LightSet& lights() const { return lights_; }
  // Picture of the environment; nullptr: none.
  [[nodiscard]] virtual const LatLongImage* environment() const { return nullptr; }
  // Turn of that picture about +Y (azimuth λ comes to λ + angle).
  [[nodiscard]] virtual double environment_turn_rad() const { return 0; }
  // True where the lights may differ from frame to frame.
  [[nodiscard]] virtual bool changes() const { return false; }
  // Time since the light arrived, for live light.
  [[nodiscard]] virtual std::optional<std::chrono::nanoseconds> age() const { return std::nullopt; }

 protected:
  LightSet lights_;
};

// A light set that stays as it is. max_lights: fold to so many; 0: all.
std::unique_ptr<LightSource> fixed_lights(const LightSet& lights, int max_lights);

struct LiveOptions {
  DdsOptions dds;
  int max_lights = 72;
  bool with_environment = false;
};
// Light as it is published. Says on stderr, once each time, that it waits, that the light stopped (the last
// one is kept), that it came back. failed: the network.
Result<std::unique_ptr<LightSource>> live_lights(const LiveOptions& options);

// Nearest bins; what the map does not cover is black.
LatLongImage lat_long_from_polar(const PolarMap& map);

}  // namespace lightwell::render
