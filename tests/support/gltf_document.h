// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "interface/base64.h"

namespace lightwell::test {

using nlohmann::json;

// A file with one mesh of raw bytes; change its JSON before reading.
struct Document {
  std::vector<unsigned char> bytes;
  json root = {{"asset", {{"version", "2.0"}}},
               {"scenes", json::array({{{"nodes", json::array({0})}}})},
               {"nodes", json::array({{{"mesh", 0}}})},
               {"meshes", json::array({{{"primitives", json::array({{{"attributes", json::object()}}})}}})},
               {"bufferViews", json::array()},
               {"accessors", json::array()}};

  template <class T>
  int add(const std::vector<T>& values, const char* type, int component_type, std::size_t components) {
    while (bytes.size() % 4 != 0) bytes.push_back(0);
    const auto* begin = reinterpret_cast<const unsigned char*>(values.data());
    root["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", bytes.size()}, {"byteLength", values.size() * sizeof(T)}});
    bytes.insert(bytes.end(), begin, begin + values.size() * sizeof(T));
    root["accessors"].push_back({{"bufferView", root["bufferViews"].size() - 1},
                                 {"componentType", component_type},
                                 {"count", values.size() / components},
                                 {"type", type}});
    return static_cast<int>(root["accessors"].size()) - 1;
  }
  json& primitive() { return root["meshes"][0]["primitives"][0]; }
  std::string text() {
    root["buffers"] = json::array({{{"byteLength", bytes.size()},
                                    {"uri", "data:application/octet-stream;base64," +
                                                base64_encode(std::as_bytes(std::span(bytes)))}}});
    return root.dump();
  }
};

// Triangle (0,0,0) (1,0,0) (0,1,0), which faces +Z.
inline Document triangle() {
  Document d;
  d.primitive()["attributes"]["POSITION"] = d.add<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3", 5126, 3);
  return d;
}

// Adds an animation's channel for a node: values over times.
inline void animate(Document& d, int node, const char* path, const std::vector<float>& times_s,
                    const std::vector<float>& values, const char* type, std::size_t components,
                    const char* interpolation = "LINEAR") {
  json& root = d.root;
  if (!root.contains("animations"))
    root["animations"] = json::array({{{"channels", json::array()}, {"samplers", json::array()}}});
  json& animation = root["animations"][0];
  const int input = d.add<float>(times_s, "SCALAR", 5126, 1);
  const int output = d.add<float>(values, type, 5126, components);
  animation["samplers"].push_back({{"input", input}, {"output", output}, {"interpolation", interpolation}});
  animation["channels"].push_back(
      {{"sampler", animation["samplers"].size() - 1}, {"target", {{"node", node}, {"path", path}}}});
}

}  // namespace lightwell::test
