// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <yaml-cpp/yaml.h>

#include <charconv>
#include <cmath>

#include "calibration/lens_import/document.h"

namespace lightwell::calibration {
namespace {

using nlohmann::json;

// What this file says itself of a document.
struct Refusal : YAML::Exception {
  using YAML::Exception::Exception;
};

json scalar(const YAML::Node& node) {
  const std::string& text = node.Scalar();
  if (node.Tag() == "!") return text;  // quoted
  const std::size_t sign = !text.empty() && text[0] == '+' ? 1 : 0;
  double value = 0;
  const auto [end, error] = std::from_chars(text.data() + sign, text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return text;
  return value;
}

// Nodes are shared by aliases: a small file can stand for a huge one, or hold itself. Values, their texts and their
// depth are therefore counted.
class AliasedNodes {
 public:
  json value_of(const YAML::Node& node, int depth) {
    constexpr int kDeepest = 32;
    if (depth > kDeepest) throw Refusal(node.Mark(), "too deep");
    take(1, node.Mark());
    switch (node.Type()) {
      case YAML::NodeType::Scalar:
        take_text(node);
        return scalar(node);
      case YAML::NodeType::Sequence: {
        json list = json::array();
        for (const auto& item : node) list.push_back(value_of(item, depth + 1));
        return list;
      }
      case YAML::NodeType::Map: {
        json map = json::object();
        for (const auto& item : node) {
          if (!item.first.IsScalar()) throw Refusal(item.first.Mark(), "a key is not a text");
          take_text(item.first);
          map[item.first.Scalar()] = value_of(item.second, depth + 1);
        }
        return map;
      }
      default:
        return nullptr;
    }
  }

 private:
  void take(std::size_t values, const YAML::Mark& mark) {
    if (values > left_) throw Refusal(mark, "more than a million values");
    left_ -= values;
  }
  // A long text takes the room of many values.
  void take_text(const YAML::Node& node) { take(node.Scalar().size() / 64, node.Mark()); }

  std::size_t left_ = 1000000;
};

}  // namespace

Result<json> parse_yaml(const std::string& text, const std::string& file) {
  std::string plain = text;
  // OpenCV's first line is not YAML; it becomes a comment, so that lines keep their numbers.
  if (plain.rfind("%YAML:", 0) == 0) plain[0] = '#';
  try {
    return AliasedNodes().value_of(YAML::Load(plain), 0);
  } catch (const YAML::Exception& e) {
    const std::string line = e.mark.is_null() ? "" : "line " + std::to_string(e.mark.line + 1) + ": ";
    // The library's own words are about its parser; the place is what helps.
    const auto* own = dynamic_cast<const Refusal*>(&e);
    return Error{ErrorKind::bad_input, file + ": " + line + "is not YAML" + (own ? ": " + own->msg : "")};
  }
}

}  // namespace lightwell::calibration
