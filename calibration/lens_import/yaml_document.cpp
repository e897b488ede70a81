// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <yaml-cpp/yaml.h>

#include <charconv>
#include <cmath>

#include "calibration/lens_import/document.h"

namespace lightwell::calibration {
namespace {

using nlohmann::json;

json scalar(const YAML::Node& node) {
  const std::string& text = node.Scalar();
  if (node.Tag() == "!") return text;  // quoted
  const std::size_t sign = !text.empty() && text[0] == '+' ? 1 : 0;
  double value = 0;
  const auto [end, error] = std::from_chars(text.data() + sign, text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return text;
  return value;
}

// Nodes are shared by aliases: a small file can stand for an endless one, so they are counted.
json value_of(const YAML::Node& node, std::size_t& left) {
  if (left-- == 0) throw YAML::Exception(node.Mark(), "more than a million values");
  switch (node.Type()) {
    case YAML::NodeType::Scalar:
      return scalar(node);
    case YAML::NodeType::Sequence: {
      json list = json::array();
      for (const auto& item : node) list.push_back(value_of(item, left));
      return list;
    }
    case YAML::NodeType::Map: {
      json map = json::object();
      for (const auto& item : node) {
        if (!item.first.IsScalar()) throw YAML::Exception(item.first.Mark(), "a key is not a text");
        map[item.first.Scalar()] = value_of(item.second, left);
      }
      return map;
    }
    default:
      return nullptr;
  }
}

}  // namespace

Result<json> parse_yaml(const std::string& text, const std::string& file) {
  std::string plain = text;
  // OpenCV's first line is not YAML; it becomes a comment, so that lines keep their numbers.
  if (plain.rfind("%YAML:", 0) == 0) plain[0] = '#';
  try {
    const YAML::Node root = YAML::Load(plain);
    std::size_t left = 1000000;
    return value_of(root, left);
  } catch (const YAML::Exception& e) {
    const std::string line = e.mark.is_null() ? "" : "line " + std::to_string(e.mark.line + 1) + ": ";
    return Error{ErrorKind::bad_input, file + ": " + line + "is not YAML: " + e.msg};
  }
}

}  // namespace lightwell::calibration
