// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "render/gltf_values.h"
#include "render/rig.h"

namespace lightwell::render::gltf {

// Which node of the rig a node of the file became; -1: none, it is not in the scene.
using RigPlaces = std::vector<int>;

// Its transform and weights; parent is not set.
RigNode read_node(const tinygltf::Node& node, const std::string& what);

// Tracks of an animation and its length; tracks of nodes that are not in the scene are left out.
// weight_counts: morph targets of each node of the rig's mesh
void read_animation(const tinygltf::Model& model, std::size_t index, const RigPlaces& places,
                    const std::vector<std::size_t>& weight_counts, Rig& rig);

Skin read_skin(const tinygltf::Model& model, std::size_t index, const RigPlaces& places);

// JOINTS_0, WEIGHTS_0 and the second four where they are there. joint_count: of the skin.
void read_influences(const tinygltf::Model& model, const tinygltf::Primitive& source, std::size_t joint_count,
                     const std::string& what, Shape& shape);

std::vector<MorphTarget> read_targets(const tinygltf::Model& model, const tinygltf::Primitive& source,
                                      std::size_t vertex_count, const std::string& what);

}  // namespace lightwell::render::gltf
