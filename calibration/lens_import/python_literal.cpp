// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>

#include "calibration/lens_import/document.h"

namespace lightwell::calibration {
namespace {

using nlohmann::json;

struct SyntaxError {
  std::size_t at;
  std::string what;
};

class PythonReader {
 public:
  explicit PythonReader(std::string_view text) : text_(text) {}

  json read() {
    json value = any(0);
    skip_blank();
    if (at_ != text_.size()) fail("more text after the value");
    return value;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw SyntaxError{at_, what}; }
  [[nodiscard]] char peek() const { return at_ < text_.size() ? text_[at_] : '\0'; }

  void skip_blank() {
    while (at_ < text_.size()) {
      if (text_[at_] == '#')
        at_ = std::min(text_.find('\n', at_), text_.size());
      else if (std::string_view(" \t\r\n").find(text_[at_]) != std::string_view::npos)
        ++at_;
      else
        return;
    }
  }

  json any(int depth) {
    constexpr int kDeepest = 32;
    if (depth > kDeepest) fail("too deep");
    skip_blank();
    const char c = peek();
    if (c == '{') return dictionary(depth);
    if (c == '[') return list(']', depth);
    if (c == '(') return list(')', depth);
    if (c == '\'' || c == '"') return text();
    if (c == 'b' && at_ + 1 < text_.size() && (text_[at_ + 1] == '\'' || text_[at_ + 1] == '"')) {
      bytes();
      return nullptr;
    }
    return word();
  }

  json dictionary(int depth) {
    json map = json::object();
    ++at_;
    for (skip_blank(); peek() != '}'; skip_blank()) {
      const json key = any(depth + 1);
      if (!key.is_string()) fail("a key is not a text");
      skip_blank();
      if (peek() != ':') fail("expected ':'");
      ++at_;
      map[key.get<std::string>()] = any(depth + 1);
      comma_or('}');
    }
    ++at_;
    return map;
  }

  json list(char end, int depth) {
    json out = json::array();
    ++at_;
    for (skip_blank(); peek() != end; skip_blank()) {
      out.push_back(any(depth + 1));
      comma_or(end);
    }
    ++at_;
    return out;
  }

  void comma_or(char end) {
    skip_blank();
    if (peek() == ',')
      ++at_;
    else if (peek() != end)
      fail(std::string("expected ',' or '") + end + "'");
  }

  // Neighbouring texts are one.
  std::string text() {
    std::string out;
    while (peek() == '\'' || peek() == '"') {
      const char quote = text_[at_++];
      while (peek() != quote) {
        if (at_ >= text_.size() || peek() == '\n') fail("a text does not end");
        if (peek() == '\\') ++at_;  // what follows stands for itself
        if (at_ < text_.size()) out += text_[at_++];
      }
      ++at_;
      skip_blank();
    }
    return out;
  }

  void bytes() {
    while (peek() == 'b') {
      ++at_;
      (void)text();
    }
  }

  json word() {
    const std::size_t start = at_;
    while (at_ < text_.size() && std::string_view(" \t\r\n,:]})#").find(text_[at_]) == std::string_view::npos)
      ++at_;
    const std::string_view word = text_.substr(start, at_ - start);
    if (word == "None") return nullptr;
    if (word == "True" || word == "False") return word == "True";
    double value = 0;
    const std::size_t sign = !word.empty() && word[0] == '+' ? 1 : 0;
    const auto [end, error] = std::from_chars(word.data() + sign, word.data() + word.size(), value);
    if (!word.empty() && error == std::errc() && end == word.data() + word.size())
      return std::isfinite(value) ? json(value) : json(std::string(word));
    at_ = start;
    fail(word.empty() ? "a value is missing" : "expected a number, a text or a list");
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

}  // namespace

Result<json> parse_python_literal(const std::string& text, const std::string& file) {
  try {
    return PythonReader(text).read();
  } catch (const SyntaxError& error) {
    const auto line =
        1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(error.at), '\n');
    return Error{ErrorKind::bad_input, file + ": line " + std::to_string(line) + ": " + error.what};
  }
}

}  // namespace lightwell::calibration
