// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/photometric/csv_table.h"

#include <charconv>
#include <cmath>

#include "interface/atomic_file.h"

namespace lightwell::calibration {
namespace {

constexpr std::size_t kShown = 40;  // characters of a wrong field

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

std::vector<std::string> split(std::string_view line) {
  std::vector<std::string> fields;
  for (std::size_t begin = 0;;) {
    const auto comma = line.find(',', begin);
    std::string_view field = trimmed(line.substr(begin, comma - begin));
    if (field.size() >= 2 && field.front() == '"' && field.back() == '"')
      field = field.substr(1, field.size() - 2);
    fields.emplace_back(field);
    if (comma == std::string_view::npos) return fields;
    begin = comma + 1;
  }
}

std::string printable(std::string_view text) {
  std::string out;
  for (const char c : text.substr(0, kShown)) out += c < ' ' || c > '~' ? '?' : c;
  return out;
}

}  // namespace

Result<CsvTable> CsvTable::read(const std::filesystem::path& file) {
  const auto text = read_text_file(file);
  if (!text) return text.error();
  return parse(*text, file.string());
}

Result<CsvTable> CsvTable::parse(std::string_view text, std::string file) {
  CsvTable table;
  table.file_ = std::move(file);
  if (text.substr(0, 3) == "\xef\xbb\xbf") text.remove_prefix(3);  // byte order mark of spreadsheets
  int number = 0;
  while (!text.empty()) {
    ++number;
    const auto end = text.find('\n');
    const std::string_view line = trimmed(text.substr(0, end));
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    if (line.empty() || line.front() == '#') continue;
    std::vector<std::string> fields = split(line);
    if (table.columns_.empty()) {
      table.columns_ = std::move(fields);
      continue;
    }
    if (fields.size() != table.columns_.size())
      return Error{ErrorKind::bad_input, table.file_ + ": line " + std::to_string(number) + ": " +
                                             std::to_string(fields.size()) + " fields: allowed " +
                                             std::to_string(table.columns_.size()) + ", as in the header"};
    table.rows_.push_back({number, std::move(fields)});
  }
  if (table.columns_.empty())
    return Error{ErrorKind::bad_input, table.file_ + ": is empty: a line with column names comes first"};
  return table;
}

std::optional<std::size_t> CsvTable::index_of(std::string_view column) const {
  for (std::size_t i = 0; i < columns_.size(); ++i)
    if (columns_[i] == column) return i;
  return std::nullopt;
}

std::string CsvTable::place(std::size_t row) const {
  return file_ + ": line " + std::to_string(rows_[row].line);
}

Result<double> CsvTable::number(std::size_t row, std::string_view column, double lowest, double highest,
                                std::string_view allowed) const {
  const auto index = index_of(column);
  verify_bug(index.has_value(), "number: column was not required");
  const std::string& field = rows_[row].fields[*index];
  const char* begin = field.data() + (field.starts_with('+') ? 1 : 0);
  const char* end = field.data() + field.size();
  double value = 0;
  const auto [stop, failure] = std::from_chars(begin, end, value);
  if (failure != std::errc() || stop != end || !std::isfinite(value) || value < lowest || value > highest)
    return Error{ErrorKind::bad_input, place(row) + ": " + std::string(column) + " = " +
                                           (field.empty() ? "nothing" : printable(field)) + ": allowed " +
                                           std::string(allowed)};
  return value;
}

std::string CsvTable::text(std::size_t row, std::string_view column) const {
  const auto index = index_of(column);
  return index ? rows_[row].fields[*index] : std::string();
}

Status CsvTable::require(std::initializer_list<std::string_view> columns) const {
  for (const std::string_view column : columns)
    if (!has(column)) {
      std::string there;
      for (const std::string& c : columns_) there += (there.empty() ? "" : ", ") + printable(c);
      return Error{ErrorKind::bad_input,
                   file_ + ": column " + std::string(column) + " is missing; there are: " + there};
    }
  return {};
}

}  // namespace lightwell::calibration
