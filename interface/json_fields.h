// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lighting/result.h"

namespace lightwell {

// Thrown while a file's fields are read, caught where reading began.
struct FieldFailure {
  Error error;
};

// One object of a JSON file. Every getter checks presence, type and range, and throws FieldFailure with one
// line that names file, field, value and what is allowed.
class JsonFields {
 public:
  // path: of this object inside the file, "" for its root
  JsonFields(const nlohmann::json& object, std::string file, std::string path = "");

  [[nodiscard]] const std::string& file() const { return file_; }
  [[nodiscard]] bool has(std::string_view key) const;
  // What stands there, for files of other programs that write one thing in several ways; false where it is missing.
  [[nodiscard]] bool is_number(std::string_view key) const;
  [[nodiscard]] bool is_object(std::string_view key) const;
  [[nodiscard]] bool holds_lists(std::string_view key) const;  // an array whose first element is one
  [[nodiscard]] JsonFields object(std::string_view key) const;
  [[nodiscard]] std::vector<JsonFields> objects(std::string_view key) const;  // of an array, in order
  [[nodiscard]] double number(std::string_view key) const;                    // finite
  [[nodiscard]] int integer(std::string_view key, int lowest, int highest) const;
  // Exact up to 2^53.
  [[nodiscard]] std::int64_t whole(std::string_view key, std::int64_t lowest, std::int64_t highest) const;
  [[nodiscard]] std::string text(std::string_view key) const;
  void require_schema(std::string_view schema) const;
  // "schema": "NAME/1" to "NAME/newest".
  void require_schema(std::string_view name, int newest) const;
  // values.size() numbers, each finite and within the range
  void numbers(std::string_view key, std::span<double> values, double lowest = -kAny,
               double highest = kAny) const;
  [[nodiscard]] std::vector<double> number_list(std::string_view key) const;
  [[nodiscard]] std::vector<std::vector<double>> lists(std::string_view key) const;  // of numbers
  [[noreturn]] void fail(std::string_view key, std::string_view what) const;

 private:
  static constexpr double kAny = std::numeric_limits<double>::max();
  [[nodiscard]] const nlohmann::json& get(std::string_view key) const;
  [[nodiscard]] const nlohmann::json& array_of(std::string_view key, std::size_t count) const;
  [[nodiscard]] double element(const nlohmann::json& array, std::string_view key, std::size_t i) const;
  [[nodiscard]] std::vector<double> numbers_in(const nlohmann::json& array, std::string_view key) const;

  const nlohmann::json& object_;
  std::string file_;
  std::string path_;
};

// The text as a JSON value; bad_input with the place of the error.
Result<nlohmann::json> parse_json(const std::string& text, const std::string& file);

}  // namespace lightwell
