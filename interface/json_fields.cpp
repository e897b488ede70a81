// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/json_fields.h"

#include <algorithm>
#include <cmath>

namespace lightwell {
namespace {

// A value as it stands in the file, short enough for one line.
std::string shown(const nlohmann::json& value) {
  constexpr std::size_t kLongest = 40;
  if (value.is_array()) return "an array of " + std::to_string(value.size());
  if (value.is_object()) return "an object";
  std::string text = value.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
  if (text.size() > kLongest) text = text.substr(0, kLongest) + "...";
  return text;
}

// Of a byte, counted from 1.
std::size_t line_of(std::string_view text, std::size_t byte) {
  const std::string_view before = text.substr(0, byte > 0 ? byte - 1 : 0);
  return 1 + static_cast<std::size_t>(std::count(before.begin(), before.end(), '\n'));
}

// What stands from a byte, counted from 1, to the end of its line, short and printable.
std::string shown_at(std::string_view text, std::size_t byte) {
  constexpr std::size_t kLongest = 20;
  std::string_view rest = text.substr(byte > 0 ? byte - 1 : 0);
  rest = rest.substr(0, std::min({rest.find_first_of("\r\n"), rest.size(), kLongest}));
  if (rest.empty()) return "the line's end";
  std::string out(rest);
  std::replace_if(
      out.begin(), out.end(), [](unsigned char c) { return c < ' ' || c > '~'; }, '?');
  return "'" + out + "'";
}

}  // namespace

JsonFields::JsonFields(const nlohmann::json& object, std::string file, std::string path)
    : object_(object), file_(std::move(file)), path_(std::move(path)) {
  if (object.is_object()) return;
  const std::string where = path_.empty() ? "" : path_ + " ";
  throw FieldFailure{
      {ErrorKind::bad_input, file_ + ": " + where + "is " + shown(object) + ", expected an object"}};
}

bool JsonFields::has(std::string_view key) const {
  return object_.contains(key);
}

bool JsonFields::is_number(std::string_view key) const {
  return has(key) && get(key).is_number();
}

bool JsonFields::is_object(std::string_view key) const {
  return has(key) && get(key).is_object();
}

bool JsonFields::holds_lists(std::string_view key) const {
  return has(key) && get(key).is_array() && !get(key).empty() && get(key)[0].is_array();
}

void JsonFields::fail(std::string_view key, std::string_view what) const {
  const std::string field = path_.empty() ? std::string(key) : path_ + "." + std::string(key);
  throw FieldFailure{{ErrorKind::bad_input, file_ + ": " + field + " " + std::string(what)}};
}

const nlohmann::json& JsonFields::get(std::string_view key) const {
  const auto found = object_.find(key);
  if (found == object_.end()) fail(key, "is missing");
  return *found;
}

JsonFields JsonFields::object(std::string_view key) const {
  return {get(key), file_, path_.empty() ? std::string(key) : path_ + "." + std::string(key)};
}

std::vector<JsonFields> JsonFields::objects(std::string_view key) const {
  const nlohmann::json& value = get(key);
  if (!value.is_array()) fail(key, "is " + shown(value) + ", expected an array of objects");
  const std::string path = path_.empty() ? std::string(key) : path_ + "." + std::string(key);
  std::vector<JsonFields> list;
  list.reserve(value.size());
  for (std::size_t i = 0; i < value.size(); ++i)
    list.emplace_back(value[i], file_, path + "[" + std::to_string(i) + "]");
  return list;
}

double JsonFields::number(std::string_view key) const {
  const nlohmann::json& value = get(key);
  if (!value.is_number() || !std::isfinite(value.get<double>()))
    fail(key, "= " + shown(value) + ": allowed a finite number");
  return value.get<double>();
}

int JsonFields::integer(std::string_view key, int lowest, int highest) const {
  return static_cast<int>(whole(key, lowest, highest));
}

std::int64_t JsonFields::whole(std::string_view key, std::int64_t lowest, std::int64_t highest) const {
  const double value = number(key);
  if (value != std::floor(value) || value < static_cast<double>(lowest) ||
      value > static_cast<double>(highest))
    fail(key, "= " + shown(get(key)) + ": allowed a whole number from " + std::to_string(lowest) + " to " +
                  std::to_string(highest));
  return static_cast<std::int64_t>(value);
}

std::string JsonFields::text(std::string_view key) const {
  const nlohmann::json& value = get(key);
  if (!value.is_string()) fail(key, "= " + shown(value) + ": allowed a text");
  return value.get<std::string>();
}

void JsonFields::require_schema(std::string_view schema) const {
  if (text("schema") != schema)
    fail("schema", "= " + shown(get("schema")) + ": allowed \"" + std::string(schema) + "\"");
}

void JsonFields::require_schema(std::string_view name, int newest) const {
  const std::string found = text("schema");
  std::string allowed;
  for (int version = 1; version <= newest; ++version) {
    const std::string schema = std::string(name) + "/" + std::to_string(version);
    if (found == schema) return;
    allowed += (version > 1 ? ", \"" : "\"") + schema + "\"";
  }
  fail("schema", "= " + shown(get("schema")) + ": allowed " + allowed);
}

const nlohmann::json& JsonFields::array_of(std::string_view key, std::size_t count) const {
  const nlohmann::json& value = get(key);
  if (!value.is_array() || value.size() != count)
    fail(key, "is " + shown(value) + ", expected an array of " + std::to_string(count) + " numbers");
  return value;
}

double JsonFields::element(const nlohmann::json& array, std::string_view key, std::size_t i) const {
  const nlohmann::json& value = array[i];
  if (!value.is_number() || !std::isfinite(value.get<double>()))
    fail(std::string(key) + "[" + std::to_string(i) + "]", "= " + shown(value) + ": allowed a finite number");
  return value.get<double>();
}

void JsonFields::numbers(std::string_view key, std::span<double> values, double lowest,
                         double highest) const {
  const nlohmann::json& array = array_of(key, values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = element(array, key, i);
    if (values[i] >= lowest && values[i] <= highest) continue;
    const nlohmann::json range = {lowest, highest};
    fail(std::string(key) + "[" + std::to_string(i) + "]",
         "= " + shown(array[i]) + ": allowed " + range[0].dump() + " to " + range[1].dump());
  }
}

std::vector<double> JsonFields::numbers_in(const nlohmann::json& array, std::string_view key) const {
  if (!array.is_array()) fail(key, "is " + shown(array) + ", expected an array of numbers");
  std::vector<double> list(array.size());
  for (std::size_t i = 0; i < list.size(); ++i) list[i] = element(array, key, i);
  return list;
}

std::vector<double> JsonFields::number_list(std::string_view key) const {
  return numbers_in(get(key), key);
}

std::vector<std::vector<double>> JsonFields::lists(std::string_view key) const {
  const nlohmann::json& value = get(key);
  if (!value.is_array()) fail(key, "is " + shown(value) + ", expected an array of arrays");
  std::vector<std::vector<double>> out;
  for (std::size_t i = 0; i < value.size(); ++i)
    out.push_back(numbers_in(value[i], std::string(key) + "[" + std::to_string(i) + "]"));
  return out;
}

Result<nlohmann::json> parse_json(const std::string& text, const std::string& file) {
  const auto bad = [&](const std::string& what) { return Error{ErrorKind::bad_input, file + ": " + what}; };
  if (text.find_first_not_of(" \t\r\n") == std::string::npos) return bad("is empty, expected JSON");
  try {
    return nlohmann::json::parse(text);
  } catch (const nlohmann::json::parse_error& e) {
    // The library's own words are about its parser; the place is what helps.
    if (e.byte > text.size())
      return bad("line " + std::to_string(line_of(text, text.size())) + ": is not JSON: ends too early");
    return bad("line " + std::to_string(line_of(text, e.byte)) + ": is not JSON from " +
               shown_at(text, e.byte) + " on");
  } catch (const nlohmann::json::out_of_range& e) {
    // It ends with the number between quotes.
    const std::string_view words = e.what();
    const std::size_t end = words.rfind('\''), start = end == 0 ? end : words.rfind('\'', end - 1);
    const bool quoted = end != std::string_view::npos && start != std::string_view::npos && start < end;
    const std::string number = quoted ? std::string(words.substr(start + 1, end - start - 1)) : "a number";
    return bad("holds " + number + ": allowed numbers up to 1.8e308");
  }
}

}  // namespace lightwell
