// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <tinyxml2.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>
#include <string_view>

#include "calibration/lens_import/document.h"

// OpenCV's own reader ends with a segmentation fault on a file that is cut.
namespace lightwell::calibration {
namespace {

using nlohmann::json;
using tinyxml2::XMLElement;
using tinyxml2::XMLNode;

// Numbers stand in a row; what is none is a text.
json value_of_text(const std::string& text, bool always_list) {
  std::istringstream words(text);
  std::string word;
  json list = json::array();
  bool numbers = true;
  while (words >> word) {
    const std::size_t sign = word[0] == '+' ? 1 : 0;
    double value = 0;
    const auto [end, error] = std::from_chars(word.data() + sign, word.data() + word.size(), value);
    const bool number = error == std::errc() && end == word.data() + word.size() && std::isfinite(value);
    list.push_back(number ? json(value) : json(word));
    numbers = numbers && number;
  }
  if (always_list || (numbers && list.size() > 1)) return list;
  if (numbers && list.size() == 1) return list[0];
  constexpr std::string_view kBlank = " \t\r\n";
  const std::size_t first = text.find_first_not_of(kBlank);
  if (first == std::string::npos) return nullptr;
  return text.substr(first, text.find_last_not_of(kBlank) + 1 - first);
}

// Attributes say only what OpenCV wrote an element from. The parser bounds the depth.
json value_of(const XMLElement& element) {
  std::string text;
  json map = json::object(), list = json::array();
  for (const XMLNode* node = element.FirstChild(); node != nullptr; node = node->NextSibling()) {
    if (const tinyxml2::XMLText* part = node->ToText()) text += part->Value();
    const XMLElement* child = node->ToElement();
    if (child == nullptr) continue;
    if (std::string_view(child->Name()) == "_")
      list.push_back(value_of(*child));
    else
      map[child->Name()] = value_of(*child);
  }
  if (!map.empty()) return map;
  if (!list.empty()) return list;
  return value_of_text(text, std::string_view(element.Name()) == "data");
}

}  // namespace

Result<json> parse_opencv_xml(const std::string& text, const std::string& file) {
  const auto bad = [&](int line, const std::string& what) {
    return Error{ErrorKind::bad_input,
                 file + ": line " + std::to_string(line) + ": is not XML of OpenCV's FileStorage" + what};
  };
  tinyxml2::XMLDocument document;
  const tinyxml2::XMLError error = document.Parse(text.data(), text.size());
  if (error == tinyxml2::XML_ELEMENT_DEPTH_EXCEEDED) return bad(document.ErrorLineNum(), ": too deep");
  if (error != tinyxml2::XML_SUCCESS) return bad(std::max(document.ErrorLineNum(), 1), "");
  const XMLElement* root = document.RootElement();
  if (root == nullptr || std::string_view(root->Name()) != "opencv_storage")
    return bad(root == nullptr ? 1 : root->GetLineNum(), ": expected <opencv_storage>");
  return value_of(*root);
}

}  // namespace lightwell::calibration
