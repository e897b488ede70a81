// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
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

struct SyntaxError {
  std::size_t at;
  std::string what;
};

constexpr std::string_view kBlank = " \t\r\n";

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
  const std::size_t first = text.find_first_not_of(kBlank);
  if (first == std::string::npos) return nullptr;
  return text.substr(first, text.find_last_not_of(kBlank) + 1 - first);
}

class XmlReader {
 public:
  explicit XmlReader(std::string_view text) : text_(text) {}

  json read() {
    skip_to_element();
    if (name_after(at_) != "opencv_storage") fail("expected <opencv_storage>");
    return element(0).second;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw SyntaxError{std::min(at_, text_.size()), what};
  }

  // Past what begins here and ends with `end`.
  void skip_past(std::string_view end) {
    const std::size_t found = text_.find(end, at_);
    if (found == std::string_view::npos) fail("expected " + std::string(end));
    at_ = found + end.size();
  }

  [[nodiscard]] bool next_is(std::string_view what) const { return text_.substr(at_, what.size()) == what; }

  void skip_to_element() {
    for (;;) {
      at_ = std::min(text_.find_first_not_of(kBlank, at_), text_.size());
      if (next_is("<?"))
        skip_past("?>");
      else if (next_is("<!--"))
        skip_past("-->");
      else
        return;
    }
  }

  [[nodiscard]] std::string name_after(std::size_t bracket) const {
    if (bracket >= text_.size() || text_[bracket] != '<') return "";
    const std::size_t end = std::min(text_.find_first_of(" \t\r\n/>", bracket + 1), text_.size());
    return std::string(text_.substr(bracket + 1, end - bracket - 1));
  }

  // Name and value of the element that begins here; attributes say only what OpenCV wrote it from.
  std::pair<std::string, json> element(int depth) {
    constexpr int kDeepest = 32;
    if (depth > kDeepest) fail("too deep");
    const std::string name = name_after(at_);
    if (name.empty()) fail("expected an element");
    skip_past(">");
    if (text_[at_ - 2] == '/') return {name, nullptr};
    std::string text;
    json map = json::object(), list = json::array();
    for (;;) {
      const std::size_t bracket = std::min(text_.find('<', at_), text_.size());
      text += text_.substr(at_, bracket - at_);
      at_ = bracket;
      if (at_ == text_.size()) fail("<" + name + "> does not end");
      if (next_is("<!--")) {
        skip_past("-->");
        continue;
      }
      if (next_is("</")) break;
      auto [child, value] = element(depth + 1);
      if (child == "_")
        list.push_back(std::move(value));
      else
        map[child] = std::move(value);
    }
    if (text_.substr(at_ + 2, name.size()) != name) fail("<" + name + "> does not end");
    skip_past(">");
    if (!map.empty()) return {name, std::move(map)};
    if (!list.empty()) return {name, std::move(list)};
    return {name, value_of_text(text, name == "data")};
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

}  // namespace

Result<json> parse_opencv_xml(const std::string& text, const std::string& file) {
  try {
    return XmlReader(text).read();
  } catch (const SyntaxError& error) {
    const auto line =
        1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(error.at), '\n');
    return Error{ErrorKind::bad_input, file + ": line " + std::to_string(line) +
                                           ": is not XML of OpenCV's FileStorage: " + error.what};
  }
}

}  // namespace lightwell::calibration
