// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lighting/result.h"

namespace lightwell {

// A CSV file with a line of column names, as RFC 4180 has it: fields in quotes may hold commas, line ends and doubled
// quotes. A byte order mark, empty lines and lines that begin with # are skipped, blanks around a field are not part of
// it. Every error is bad_input and names file, line and column.
class CsvTable {
 public:
  // Unreadable, no header, a column twice, semicolons or tabs for commas, a quote that does not end, or a line with more
  // or fewer fields than the header: an error.
  static Result<CsvTable> read(const std::filesystem::path& file);
  static Result<CsvTable> parse(std::string_view text, std::string file);

  [[nodiscard]] std::size_t rows() const { return rows_.size(); }
  [[nodiscard]] bool has(std::string_view column) const { return index_of(column).has_value(); }
  // "patches.csv: line 7", for errors.
  [[nodiscard]] std::string place(std::size_t row) const;
  [[nodiscard]] int line(std::size_t row) const { return rows_[row].line; }

  // A number from lowest to highest, finite and not denormal; allowed: the range in words.
  [[nodiscard]] Result<double> number(std::size_t row, std::string_view column, double lowest, double highest,
                                      std::string_view allowed) const;
  // 0, or from a thousand-millionth to 1e12 cd/m²: darker than any night, brighter than the sun's middle.
  [[nodiscard]] Result<double> luminance(std::size_t row, std::string_view column) const;
  // Empty where there is no such column.
  [[nodiscard]] std::string text(std::size_t row, std::string_view column) const;
  // bad_input that names the first of these columns that is missing.
  [[nodiscard]] Status require(std::initializer_list<std::string_view> columns) const;

 private:
  struct Row {
    int line = 0;
    std::vector<std::string> fields;
  };
  [[nodiscard]] std::optional<std::size_t> index_of(std::string_view column) const;
  [[nodiscard]] Status check_columns() const;
  std::string file_;
  std::vector<std::string> columns_;
  std::vector<Row> rows_;
};

}  // namespace lightwell
