// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "interface/dds_topics.h"
#include "lighting/decomposition/decompose.h"
#include "lighting/field/light_field.h"
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
  // Another number for another picture; 0: none yet.
  [[nodiscard]] virtual int environment_version() const { return 0; }
  // Light that differs from place to place, in place of lights(); nullptr: none.
  [[nodiscard]] virtual const LightField* field() const { return nullptr; }
  // Another number for another field; 0: none yet.
  [[nodiscard]] virtual int field_version() const { return 0; }
  // Time since the light arrived, for live light.
  [[nodiscard]] virtual std::optional<std::chrono::nanoseconds> age() const { return std::nullopt; }

 protected:
  LightSet lights_;
};

// A light set that stays as it is. max_lights: fold to so many; 0: all.
std::unique_ptr<LightSource> fixed_lights(const LightSet& lights, int max_lights);

// A light field that stays as it is. bad_input: the file.
Result<std::unique_ptr<LightSource>> field_light(const std::filesystem::path& file);

struct EnvironmentOptions {
  std::filesystem::path file;
  int lights = 72;
  Method method = Method::best;
  Coverage coverage = Coverage::hemisphere;
  double spin_deg = 0;  // more every frame
  int max_lights = 0;   // fold to so many; 0: all
};
// Lights made of an image; where it spins, anew for every frame. Says on stderr what had to be repaired.
// bad_input: the image.
Result<std::unique_ptr<LightSource>> environment_lights(const EnvironmentOptions& options);

struct LiveOptions {
  DdsOptions dds;
  int max_lights = 72;
  bool with_environment = false;
};
// Light as it is published. Says on stderr, once each time, that it waits, that the light stopped (the last
// one is kept), that it came back. failed: the network.
Result<std::unique_ptr<LightSource>> live_lights(const LiveOptions& options);

}  // namespace lightwell::render
