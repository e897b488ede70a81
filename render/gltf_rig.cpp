// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/gltf_rig.h"

#include <algorithm>
#include <cmath>

#include "render/gltf_accessor.h"

namespace lightwell::render::gltf {
namespace {

std::vector<Vec3f> vectors(const std::vector<float>& values) {
  std::vector<Vec3f> result(values.size() / 3);
  for (std::size_t i = 0; i < result.size(); ++i) result[i] = Eigen::Map<const Vec3f>(&values[3 * i]);
  return result;
}

Interpolation interpolation(const std::string& name, const std::string& what) {
  if (name == "LINEAR") return Interpolation::linear;
  if (name == "STEP") return Interpolation::step;
  if (name == "CUBICSPLINE") return Interpolation::cubic_spline;
  throw BadScene{what + ": interpolation '" + name + "' must be LINEAR, STEP or CUBICSPLINE"};
}

void check_times(const std::vector<float>& times_s, const std::string& what) {
  for (std::size_t i = 0; i < times_s.size(); ++i)
    if (!(times_s[i] >= 0) || (i > 0 && !(times_s[i] > times_s[i - 1])))
      throw BadScene{what + ": time " + std::to_string(i) + " is " + std::to_string(times_s[i]) +
                     " s, times must rise from 0 on"};
}

// Shape of the values that a path has; nothing: a path that is none of glTF's.
std::optional<std::pair<Track::Property, std::size_t>> property_of(const std::string& path,
                                                                   std::size_t weights) {
  if (path == "translation") return std::pair(Track::Property::translation, std::size_t{3});
  if (path == "rotation") return std::pair(Track::Property::rotation, std::size_t{4});
  if (path == "scale") return std::pair(Track::Property::scale, std::size_t{3});
  if (path == "weights") return std::pair(Track::Property::weights, weights);
  return std::nullopt;
}

void check_values(const Track& track, const std::string& what) {
  const std::size_t stride = track.width * (track.interpolation == Interpolation::cubic_spline ? 3 : 1);
  const std::size_t expected = track.times_s.size() * stride;
  if (track.values.size() != expected)
    throw BadScene{what + ": " + std::to_string(track.values.size()) + " numbers for " +
                   std::to_string(track.times_s.size()) + " times, must be " + std::to_string(expected)};
  if (track.property != Track::Property::rotation) return;
  const std::size_t value = stride == track.width ? 0 : track.width;
  for (std::size_t key = 0; key < track.times_s.size(); ++key) {
    const auto* q = &track.values[key * stride + value];
    if (q[0] == 0 && q[1] == 0 && q[2] == 0 && q[3] == 0)
      throw BadScene{what + ": rotation " + std::to_string(key) + " is 0, must be a unit quaternion"};
  }
}

}  // namespace

RigNode read_node(const tinygltf::Node& node, const std::string& what) {
  const auto check = [&](const std::vector<double>& v, std::size_t n, const char* key) {
    if (!v.empty() && v.size() != n)
      throw BadScene{what + ": " + key + " must be " + std::to_string(n) + " numbers"};
  };
  check(node.matrix, 16, "matrix");
  check(node.translation, 3, "translation");
  check(node.rotation, 4, "rotation");
  check(node.scale, 3, "scale");
  RigNode result;
  result.name = node.name;
  if (!node.matrix.empty()) {
    result.matrix = Eigen::Map<const Eigen::Matrix4d>(node.matrix.data()).cast<float>();
  } else {
    if (!node.translation.empty()) result.translation = Eigen::Map<const Vec3d>(node.translation.data());
    if (!node.scale.empty()) result.scale = Eigen::Map<const Vec3d>(node.scale.data());
    if (!node.rotation.empty()) {
      const Eigen::Quaterniond q(node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2]);
      if (!(q.norm() > 0)) throw BadScene{what + ": rotation must be a unit quaternion"};
      result.rotation = q.normalized();
    }
  }
  for (const double w : node.weights) result.weights.push_back(number(w, what + ": weights", -1e6, 1e6));
  return result;
}

void read_animation(const tinygltf::Model& model, std::size_t index, const RigPlaces& places,
                    const std::vector<std::size_t>& weight_counts, Rig& rig) {
  const tinygltf::Animation& source = model.animations[index];
  for (std::size_t c = 0; c < source.channels.size(); ++c) {
    const tinygltf::AnimationChannel& channel = source.channels[c];
    const std::string what = "animation " + std::to_string(index) + " channel " + std::to_string(c);
    const std::size_t node = index_in(model.nodes.size(), channel.target_node, what + ": node");
    if (places[node] < 0) continue;
    Track track;
    track.node = static_cast<std::size_t>(places[node]);
    const auto property = property_of(channel.target_path, weight_counts[track.node]);
    if (!property)
      throw BadScene{what + ": path '" + channel.target_path +
                     "' must be translation, rotation, scale or weights"};
    std::tie(track.property, track.width) = *property;
    if (track.property == Track::Property::weights && track.width == 0)
      throw BadScene{what + ": its node has no morph targets"};
    if (track.property != Track::Property::weights && rig.nodes[track.node].matrix)
      throw BadScene{what + ": its node has a matrix; animated ones have translation, rotation and scale"};
    const tinygltf::AnimationSampler& sampler =
        source.samplers[index_in(source.samplers.size(), channel.sampler, what + ": sampler")];
    track.interpolation = interpolation(sampler.interpolation, what);
    track.times_s = take(read_floats(model, sampler.input, 1, what + " input"));
    check_times(track.times_s, what);
    const int components = track.property == Track::Property::weights ? 1 : static_cast<int>(track.width);
    track.values = take(read_floats(model, sampler.output, components, what + " output"));
    check_values(track, what);
    rig.length_s = std::max(rig.length_s, static_cast<double>(track.times_s.back()));
    rig.tracks.push_back(std::move(track));
  }
}

Skin read_skin(const tinygltf::Model& model, std::size_t index, const RigPlaces& places) {
  const tinygltf::Skin& source = model.skins[index];
  const std::string what = "skin " + std::to_string(index);
  if (source.joints.empty() || source.joints.size() > 65536)
    throw BadScene{what + ": " + std::to_string(source.joints.size()) + " joints, must be 1 to 65536"};
  Skin skin;
  for (const int joint : source.joints) {
    const int place = places[index_in(model.nodes.size(), joint, what + ": joint")];
    if (place < 0) throw BadScene{what + ": joint " + std::to_string(joint) + " is not in the scene"};
    skin.joints.push_back(static_cast<std::size_t>(place));
  }
  skin.joint_from_mesh.assign(skin.joints.size(), Mat4f::Identity());
  if (source.inverseBindMatrices < 0) return skin;
  const auto matrices =
      take(read_floats(model, source.inverseBindMatrices, 16, what + " inverseBindMatrices"));
  if (matrices.size() < 16 * skin.joints.size())
    throw BadScene{what + ": " + std::to_string(matrices.size() / 16) + " inverseBindMatrices for " +
                   std::to_string(skin.joints.size()) + " joints"};
  for (std::size_t j = 0; j < skin.joints.size(); ++j)
    skin.joint_from_mesh[j] = Eigen::Map<const Mat4f>(&matrices[16 * j]);
  return skin;
}

void read_influences(const tinygltf::Model& model, const tinygltf::Primitive& source, std::size_t joint_count,
                     const std::string& what, Shape& shape) {
  const std::size_t count = shape.positions.size();
  std::vector<std::vector<float>> joints;
  std::vector<std::vector<float>> weights;
  for (int set = 0; set < 2; ++set) {
    const std::string number = std::to_string(set);
    const auto joint = source.attributes.find("JOINTS_" + number);
    const auto weight = source.attributes.find("WEIGHTS_" + number);
    if (joint == source.attributes.end() && weight == source.attributes.end()) break;
    if (joint == source.attributes.end() || weight == source.attributes.end())
      throw BadScene{what + ": JOINTS_" + number + " and WEIGHTS_" + number + " come together"};
    joints.push_back(take(read_floats(model, joint->second, 4, what + " JOINTS_" + number)));
    weights.push_back(take(read_floats(model, weight->second, 4, what + " WEIGHTS_" + number)));
    if (joints.back().size() != 4 * count || weights.back().size() != 4 * count)
      throw BadScene{what + ": JOINTS_" + number + ", WEIGHTS_" + number + " and POSITION differ in count"};
  }
  if (joints.empty()) throw BadScene{what + " has a skin and no JOINTS_0"};
  shape.influences = 4 * joints.size();
  shape.joints.resize(count * shape.influences);
  shape.joint_weights.resize(count * shape.influences);
  for (std::size_t i = 0; i < count; ++i) {
    double sum = 0;
    for (std::size_t k = 0; k < shape.influences; ++k) {
      const float joint = joints[k / 4][4 * i + k % 4];
      const float weight = weights[k / 4][4 * i + k % 4];
      if (!(joint >= 0 && joint < static_cast<float>(joint_count)))
        throw BadScene{what + ": vertex " + std::to_string(i) + " hangs on joint " +
                       std::to_string(static_cast<long>(joint)) + ", the skin has " +
                       std::to_string(joint_count)};
      if (!(weight >= 0))
        throw BadScene{what + ": vertex " + std::to_string(i) + " has the weight " + std::to_string(weight) +
                       ", must be 0 or more"};
      shape.joints[i * shape.influences + k] = static_cast<std::uint16_t>(joint);
      shape.joint_weights[i * shape.influences + k] = weight;
      sum += static_cast<double>(weight);
    }
    // Weights that do not sum to 1 would scale the mesh; without any, the first joint has the vertex.
    for (std::size_t k = 0; k < shape.influences; ++k) {
      float& weight = shape.joint_weights[i * shape.influences + k];
      weight = sum > 0 ? static_cast<float>(weight / sum) : k == 0 ? 1.0f : 0.0f;
    }
  }
}

std::vector<MorphTarget> read_targets(const tinygltf::Model& model, const tinygltf::Primitive& source,
                                      std::size_t vertex_count, const std::string& what) {
  std::vector<MorphTarget> targets;
  for (std::size_t t = 0; t < source.targets.size(); ++t) {
    const auto read = [&](const char* name) {
      const auto found = source.targets[t].find(name);
      if (found == source.targets[t].end()) return std::vector<Vec3f>();
      const std::string full = what + " target " + std::to_string(t) + " " + name;
      auto values = vectors(take(read_floats(model, found->second, 3, full)));
      if (values.size() != vertex_count) throw BadScene{full + " and POSITION differ in count"};
      return values;
    };
    targets.push_back({read("POSITION"), read("NORMAL")});
  }
  return targets;
}

}  // namespace lightwell::render::gltf
