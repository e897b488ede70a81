// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lighting/lat_long_image.h"
#include "lighting/result.h"
#include "lighting/vector.h"

// Known light for the simulated camera to look at: whatever it shows, the exact sum over the hemisphere is
// known too.
namespace lightwell::simulator {

// A lamp or the sun: a disc of even radiance. Wholly above the horizon, or cut by it (see
// part_above_horizon).
struct DiscLight {
  Vec3d direction = Vec3d::UnitY();  // unit, world
  double angular_radius_rad = 0;
  Rgbd illuminance = Rgbd::Zero();  // lux facing it: radiance × solid angle of the whole disc
};

// Evenly spread directions over a disc, each standing for an equal part of its solid angle (sunflower
// arrangement).
std::vector<Vec3d> disc_samples(const DiscLight& light, int count);
// 0 to 1, of the disc's solid angle.
double part_above_horizon(const DiscLight& light);

// An image that a scene is mixed from.
struct Layer {
  LatLongImage image;
  bool smooth =
      false;  // changes little from pixel to pixel: may be interpolated; else each pixel's energy is placed
};

// Σ radiance × solid angle down to a zenith angle, exact for the image as pixels of even radiance.
Rgbd cap_illuminance(const LatLongImage& image, double theta_max_rad);
inline Rgbd hemisphere_illuminance(const LatLongImage& image) {
  return cap_illuminance(image, kPi / 2);
}

// The mean of a scene over one exposure: Σ weight × layer + discs.
struct SceneMoment {
  struct Part {
    std::int64_t layer = 0;
    double weight = 0;
    friend bool operator==(const Part&, const Part&) = default;
  };
  std::vector<Part> parts;
  std::vector<DiscLight> lights;
  std::optional<Vec3d> position_m;  // of the probe in the scene's room, where it moves
};

class Scene {
 public:
  virtual ~Scene() = default;
  // Scene time in seconds from 0; end > begin.
  [[nodiscard]] virtual SceneMoment at(double begin_s, double end_s) const = 0;
  // Pure: the same id gives the same layer.
  [[nodiscard]] virtual Layer layer(std::int64_t id) const = 0;
  // Layers that are used again and again, to be made before the first frame; others are made when they come.
  [[nodiscard]] virtual std::vector<std::int64_t> lasting_layers() const = 0;
  // No radiance that the scene shows lies above, cd/m²: what the sensor's range is chosen for.
  [[nodiscard]] virtual double brightest_cd_m2() const = 0;
  // Exposure that shows what the scene is for, microseconds.
  [[nodiscard]] virtual double default_exposure_us() const { return 10000; }
};

// day | studio | flicker | walk | static | stage
std::span<const std::string_view> scenario_names();
// Whether make_scenario takes the name for a scenario, be it well written or not.
bool names_scenario(std::string_view name);
// "stage@X,Y,Z" is the stage from that place, metres; "stage" from its middle. Fails with usage for any other name,
// naming the allowed ones.
Result<std::shared_ptr<const Scene>> make_scenario(const std::string& name);

// Environment images shown in turn, each for hold_s seconds, then from the beginning. messages: one line for
// every image that had to be repaired.
Result<std::shared_ptr<const Scene>> make_environment_scene(const std::vector<std::filesystem::path>& files,
                                                            double hold_s,
                                                            std::vector<std::string>& messages);
std::shared_ptr<const Scene> make_image_scene(std::vector<LatLongImage> images, double hold_s);

// The generated scenes, one file each.
std::shared_ptr<const Scene> make_day_scene();
std::shared_ptr<const Scene> make_studio_scene(bool moving);
std::shared_ptr<const Scene> make_flicker_scene();
std::shared_ptr<const Scene> make_walk_scene();
// position_m: inside the room of daemon/simulator/walk_stage.h, above the ground
std::shared_ptr<const Scene> make_stage_scene(const Vec3d& position_m);

}  // namespace lightwell::simulator
