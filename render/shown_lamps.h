// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "render/options.h"
#include "render/placed_lamp.h"
#include "render/scene.h"

namespace lightwell::render {

// The lamps of --luminaire where they stand in a scene: in the world, or on nodes that may move.
class ShownLamps {
 public:
  // usage: no node has the name; else what read_luminaire says
  static Result<ShownLamps> open(const std::vector<LuminaireOptions>& lamps, const Scene& scene);
  ShownLamps() = default;

  [[nodiscard]] bool empty() const { return lamps_.empty(); }
  // True where one stands on a node that may move.
  [[nodiscard]] bool move() const { return move_; }
  // Where they stand when the nodes are so.
  std::span<const PlacedLamp> place(const Pose& pose);
  [[nodiscard]] std::span<const PlacedLamp> lamps() const { return lamps_; }
  // On nodes that are not what was meant, a sentence each: of those of open() and of the places until now.
  [[nodiscard]] std::span<const std::string> remarks() const { return remarks_; }

 private:
  std::vector<PlacedLamp> lamps_;
  std::vector<Eigen::Isometry3d> from_parent_;     // the node, or the world
  std::vector<std::optional<std::size_t>> nodes_;  // of the rig
  std::vector<std::string> remarks_;
  bool without_axes_ = false;  // a node was, which is said
  bool move_ = false;
};

// Luminance of a white horizontal surface at a place under lamps, as white_floor_cd_m2 of lights. World.
float white_floor_cd_m2(std::span<const PlacedLamp> lamps, const Vec3d& place);
// Lamps that were seen to light nothing of the scene from where they stand, are inside of a mesh, or have more positions than
// are drawn, a sentence each.
std::vector<std::string> remarks_on_lamps(const std::vector<LuminaireOptions>& options,
                                          std::span<const PlacedLamp> lamps, const Scene& scene);

}  // namespace lightwell::render
