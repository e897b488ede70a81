// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/shown_lamps.h"

#include <algorithm>
#include <array>
#include <map>

#include "interface/luminaire_file.h"
#include "render/enclosing_mesh.h"
#include "render/lamp_detail.h"
#include "render/lamp_sources.h"

namespace lightwell::render {
namespace {

Result<std::size_t> node_named(const LuminaireOptions& lamp, const Scene& scene) {
  const auto& nodes = scene.rig.nodes;
  const auto found =
      std::find_if(nodes.begin(), nodes.end(), [&](const RigNode& node) { return node.name == lamp.node; });
  if (found == nodes.end())
    return Error{ErrorKind::usage, "--luminaire-node " + lamp.node + ": no node of the scene has the name"};
  return static_cast<std::size_t>(found - nodes.begin());
}

// A node's place and turn without its scale; nullopt: one that is scaled to nothing has no axes.
std::optional<Eigen::Isometry3d> rigid(const Mat4f& world_from_node) {
  const Eigen::Matrix4d m = world_from_node.cast<double>();
  const Vec3d z = m.col(2).head<3>().normalized();
  const Vec3d along = m.col(0).head<3>();
  const Vec3d x = (along - along.dot(z) * z).normalized();
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() << x, z.cross(x), z;
  pose.translation() = m.col(3).head<3>();
  if (!pose.matrix().allFinite() || !(x.norm() > 0.5) || !(z.norm() > 0.5)) return std::nullopt;
  return pose;
}

bool on_a_moving_branch(const Rig& rig, std::size_t node) {
  for (int n = static_cast<int>(node); n >= 0; n = rig.nodes[static_cast<std::size_t>(n)].parent)
    if (std::any_of(rig.tracks.begin(), rig.tracks.end(),
                    [&](const Track& track) { return track.node == static_cast<std::size_t>(n); }))
      return true;
  return false;
}

}  // namespace

Result<ShownLamps> ShownLamps::open(const std::vector<LuminaireOptions>& lamps, const Scene& scene) {
  ShownLamps shown;
  std::map<std::filesystem::path, std::shared_ptr<const Luminaire>> read;
  for (const LuminaireOptions& lamp : lamps) {
    std::shared_ptr<const Luminaire>& there = read[lamp.file];
    if (!there) {
      auto luminaire = read_luminaire(lamp.file);
      if (!luminaire) return luminaire.error();
      there = std::make_shared<const Luminaire>(std::move(luminaire).value());
    }
    std::optional<std::size_t> node;
    if (!lamp.node.empty()) {
      const auto found = node_named(lamp, scene);
      if (!found) return found.error();
      node = *found;
      const auto named = std::count_if(scene.rig.nodes.begin(), scene.rig.nodes.end(),
                                       [&](const RigNode& other) { return other.name == lamp.node; });
      if (named > 1)
        shown.remarks_.push_back("--luminaire-node " + lamp.node + ": " + std::to_string(named) +
                                 " nodes have the name, the first carries " + lamp.file.string());
      shown.move_ = shown.move_ || on_a_moving_branch(scene.rig, *node);
    }
    shown.lamps_.push_back({there, lamp.pose, lamp.scale});
    shown.from_parent_.push_back(lamp.pose);
    shown.nodes_.push_back(node);
  }
  return shown;
}

std::span<const PlacedLamp> ShownLamps::place(const Pose& pose) {
  for (std::size_t i = 0; i < lamps_.size(); ++i) {
    if (!nodes_[i]) continue;
    if (const auto node = rigid(pose.world_from_node[*nodes_[i]])) {
      lamps_[i].world_from_lamp = *node * from_parent_[i];
      continue;
    }
    if (!without_axes_)
      remarks_.emplace_back("--luminaire-node: the node of lamp " + std::to_string(i + 1) +
                            " is scaled to 0, which has no axes: the lamp stays where it was last, or at "
                            "its pose in the world");
    without_axes_ = true;
  }
  return lamps_;
}

float white_floor_cd_m2(std::span<const PlacedLamp> lamps, const Vec3d& place) {
  double sum = 0;
  for (const PlacedLamp& lamp : lamps) {
    const Eigen::Isometry3d lamp_from_world = lamp.world_from_lamp.inverse();
    sum += lamp.dimming * luminance(illuminance(*lamp.lamp, lamp_from_world * place,
                                                lamp_from_world.linear() * Vec3d::UnitY()));
  }
  return static_cast<float>(sum / kPi);
}

std::vector<std::string> remarks_on_lamps(const std::vector<LuminaireOptions>& options,
                                          std::span<const PlacedLamp> lamps, const Scene& scene) {
  std::vector<std::string> remarks;
  const Receivers receivers(scene);
  for (std::size_t i = 0; i < lamps.size(); ++i) {
    const PlacedLamp& lamp = lamps[i];
    if (!(lamp.dimming > 0)) continue;
    if (lamp.lamp->near && least_group(*lamp.lamp->near) > 1) {
      const std::array<int, 2>& positions = lamp.lamp->near->intensity.planes.positions;
      remarks.push_back(options[i].file.string() + ": " + std::to_string(positions[0]) + "x" +
                        std::to_string(positions[1]) + " positions are drawn as " +
                        std::to_string(source_count(*lamp.lamp->near, least_group(*lamp.lamp->near))) +
                        ": neighbours together");
    }
    const Eigen::Isometry3d lamp_from_world = lamp.world_from_lamp.inverse();
    const auto lit = [&](const Receivers::Place& place) {
      const Vec3d point = lamp_from_world * place.point.cast<double>();
      const Vec3d normal = lamp_from_world.linear() * place.normal.cast<double>();
      return (illuminance(*lamp.lamp, point, normal) > 0).any() ||
             (illuminance(*lamp.lamp, point, Vec3d(-normal)) > 0).any();
    };
    const auto places = receivers.places();
    const std::string file = options[i].file.string();
    if (!(luminous_flux(*lamp.lamp).maxCoeff() > 0))
      remarks.push_back(file + ": the lamp is dark");
    else if (enclosing_mesh(scene, lamp.world_from_lamp.translation()))
      remarks.push_back(file + ": it stands inside a mesh of the scene, which hides its light");
    else if (std::none_of(places.begin(), places.end(), lit))
      remarks.push_back(file + ": from where it stands it lights none of the " +
                        std::to_string(places.size()) + " places of the scene that were looked at");
  }
  return remarks;
}

}  // namespace lightwell::render
