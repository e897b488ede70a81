// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/toml_fields.h"

#include <cmath>
#include <cstdio>
#include <sstream>
#include <utility>

#include "interface/printable.h"

namespace lightwell {
namespace {

std::string shown(const toml::node& node) {
  if (node.is_table()) return "a table";
  if (node.is_array()) return "a list";
  std::ostringstream out;
  node.visit([&](const auto& value) {
    if constexpr (toml::is_value<decltype(value)>) out << value.get();
  });
  constexpr std::size_t kShown = 60;
  return out.str().substr(0, kShown);
}

}  // namespace

TomlFields::TomlFields(const toml::table& table, std::string file, std::string path)
    : table_(&table), file_(std::move(file)), path_(std::move(path)) {}

void TomlFields::fail(std::string_view key, const std::string& what) const {
  const toml::node* node = table_->get(key);
  const auto line = (node != nullptr ? node->source() : table_->source()).begin.line;
  throw FieldFailure{{ErrorKind::bad_input, file_ + (line > 0 ? ": line " + std::to_string(line) : "") +
                                                ": " + path_ + std::string(key) + " " + what}};
}

bool TomlFields::has(std::string_view key) {
  asked_.emplace(key);
  return table_->contains(key);
}

const toml::node& TomlFields::get(std::string_view key) {
  asked_.emplace(key);
  const toml::node* node = table_->get(key);
  if (node == nullptr) fail(key, "is missing");
  return *node;
}

double TomlFields::number_of(const toml::node& node, std::string_view key, double lowest, double highest,
                             std::string_view allowed) const {
  double value = std::nan("");
  if (const auto* d = node.as_floating_point()) value = d->get();
  if (const auto* i = node.as_integer()) value = static_cast<double>(i->get());
  if (!(value >= lowest && value <= highest))
    fail(key, "is " + shown(node) + ", allowed: " + std::string(allowed));
  return value;
}

double TomlFields::number(std::string_view key, double lowest, double highest, std::string_view allowed) {
  return number_of(get(key), key, lowest, highest, allowed);
}

double TomlFields::number_or(std::string_view key, double otherwise, double lowest, double highest,
                             std::string_view allowed) {
  return has(key) ? number(key, lowest, highest, allowed) : otherwise;
}

std::string TomlFields::text(std::string_view key) {
  const toml::node& node = get(key);
  const auto* value = node.as_string();
  if (value == nullptr) fail(key, "is " + shown(node) + ", allowed: a text in quotes");
  return value->get();
}

std::string TomlFields::text_or(std::string_view key, const std::string& otherwise) {
  return has(key) ? text(key) : otherwise;
}

std::size_t TomlFields::word(std::string_view key, std::initializer_list<const char*> words) {
  const std::string given = text(key);
  std::string allowed;
  std::size_t i = 0;
  for (const char* each : words) {
    if (given == each) return i;
    allowed += (i++ == 0 ? "" : ", ") + std::string(each);
  }
  fail(key, "is " + given.substr(0, 60) + ", allowed: " + allowed);
}

void TomlFields::numbers(std::string_view key, std::span<double> values, double lowest, double highest,
                         std::string_view allowed) {
  const auto* list = get(key).as_array();
  if (list == nullptr || list->size() != values.size())
    fail(key, "is no list of " + std::to_string(values.size()) + " numbers");
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = number_of((*list)[i], key, lowest, highest, allowed);
}

TomlFields TomlFields::table(std::string_view key) {
  const auto* table = get(key).as_table();
  if (table == nullptr) fail(key, "is no table, allowed: [" + path_ + std::string(key) + "]");
  return {*table, file_, path_ + std::string(key) + "."};
}

std::vector<TomlFields> TomlFields::tables(std::string_view key) {
  const auto* list = get(key).as_array();
  if (list == nullptr || !list->is_homogeneous(toml::node_type::table))
    fail(key, "is no list of tables, allowed: [[" + path_ + std::string(key) + "]] each");
  std::vector<TomlFields> out;
  for (std::size_t i = 0; i < list->size(); ++i)
    out.emplace_back(*(*list)[i].as_table(), file_,
                     path_ + std::string(key) + " " + std::to_string(i + 1) + ": ");
  return out;
}

void TomlFields::expect_no_more() const {
  for (const auto& [key, node] : *table_) {
    if (asked_.contains(key.str())) continue;
    std::string allowed;
    for (const std::string& name : asked_) allowed += (allowed.empty() ? "" : ", ") + name;
    fail(key.str(), "is not known, allowed: " + allowed);
  }
}

}  // namespace lightwell
