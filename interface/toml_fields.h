// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <toml++/toml.h>
#include <initializer_list>
#include <set>
#include <span>
#include <string>
#include <string_view>

#include "interface/json_fields.h"

namespace lightwell {

// One table of a TOML file. Every getter checks presence, type and range, and throws FieldFailure with one line that names
// file, line, field, value and what is allowed.
class TomlFields {
 public:
  // path: of this table inside the file, "" for its root
  TomlFields(const toml::table& table, std::string file, std::string path = "");

  [[nodiscard]] bool has(std::string_view key);
  [[nodiscard]] double number(std::string_view key, double lowest, double highest, std::string_view allowed);
  [[nodiscard]] double number_or(std::string_view key, double otherwise, double lowest, double highest,
                                 std::string_view allowed);
  [[nodiscard]] std::string text(std::string_view key);
  [[nodiscard]] std::string text_or(std::string_view key, const std::string& otherwise);
  // Which of these words it is, by its place in the list.
  [[nodiscard]] std::size_t word(std::string_view key, std::initializer_list<const char*> words);
  void numbers(std::string_view key, std::span<double> values, double lowest, double highest,
               std::string_view allowed);
  [[nodiscard]] TomlFields table(std::string_view key);
  [[nodiscard]] std::vector<TomlFields> tables(std::string_view key);  // [[key]] …
  // Fails at the first key that nothing has asked for.
  void expect_no_more() const;
  [[noreturn]] void fail(std::string_view key, const std::string& what) const;

 private:
  [[nodiscard]] const toml::node& get(std::string_view key);
  [[nodiscard]] double number_of(const toml::node& node, std::string_view key, double lowest, double highest,
                                 std::string_view allowed) const;
  const toml::table* table_;
  std::string file_, path_;
  std::set<std::string, std::less<>> asked_;
};

}  // namespace lightwell
