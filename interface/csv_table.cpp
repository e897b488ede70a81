// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/csv_table.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include "interface/atomic_file.h"

namespace lightwell {
namespace {

constexpr std::size_t kShown = 40;  // characters of a wrong field

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

struct Record {
  int line = 0;  // where it begins: quoted fields may go on over several
  std::vector<std::string> fields;
};

// Takes records off the text, RFC 4180: a field in quotes may hold commas, line ends, and quotes doubled. A line ends
// with LF, CR LF or CR.
class Records {
 public:
  explicit Records(std::string_view text) : text_(text) {}

  // Nothing at the end of the text; an error's message lacks the file.
  Result<std::optional<Record>> next() {
    for (; !text_.empty(); skip_line_end()) {
      const std::string_view line = trimmed(text_.substr(0, text_.find_first_of("\r\n")));
      if (!line.empty() && line.front() != '#') return record();
      text_.remove_prefix(std::min(text_.find_first_of("\r\n"), text_.size()));
    }
    return std::optional<Record>();
  }

 private:
  Result<std::optional<Record>> record() {
    Record out{line_, {}};
    for (;;) {
      text_.remove_prefix(std::min(text_.find_first_not_of(" \t"), text_.size()));
      const bool quoted = !text_.empty() && text_.front() == '"';
      auto field = quoted ? quoted_field() : plain_field();
      if (!field) return field.error();
      out.fields.push_back(*std::move(field));
      if (text_.empty() || text_.front() != ',') break;
      text_.remove_prefix(1);
    }
    skip_line_end();
    return std::optional(std::move(out));
  }

  Result<std::string> plain_field() {
    const auto end = std::min(text_.find_first_of(",\r\n"), text_.size());
    const std::string_view field = trimmed(text_.substr(0, end));
    text_.remove_prefix(end);
    return std::string(field);
  }

  Result<std::string> quoted_field() {
    const int begins = line_;
    text_.remove_prefix(1);
    std::string out;
    for (;;) {
      const auto quote = text_.find('"');
      if (quote == std::string_view::npos)
        return bad(begins, "a quoted field does not end: allowed a quote after it");
      const std::string_view part = text_.substr(0, quote);
      line_ += static_cast<int>(std::count(part.begin(), part.end(), '\n'));
      out += part;
      text_.remove_prefix(quote + 1);
      if (text_.empty() || text_.front() != '"') break;
      out += '"';
      text_.remove_prefix(1);
    }
    text_.remove_prefix(std::min(text_.find_first_not_of(" \t"), text_.size()));
    if (!text_.empty() && std::string_view(",\r\n").find(text_.front()) == std::string_view::npos)
      return bad(line_, "text after a quoted field: allowed a comma or the line's end");
    return out;
  }

  void skip_line_end() {
    if (text_.empty()) return;
    text_.remove_prefix(text_.substr(0, 2) == "\r\n" ? 2 : 1);
    ++line_;
  }

  static Error bad(int line, const std::string& what) {
    return {ErrorKind::bad_input, "line " + std::to_string(line) + ": " + what};
  }

  std::string_view text_;
  int line_ = 1;
};

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
  const auto bad = [&](const std::string& what) {
    return Error{ErrorKind::bad_input, table.file_ + ": " + what};
  };
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);  // byte order mark of spreadsheets
  if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff"))
    return bad("is text in UTF-16: allowed UTF-8");
  Records records(text);
  for (;;) {
    auto record = records.next();
    if (!record) return bad(record.error().message);
    if (!*record) break;
    auto& [line, fields] = **record;
    const std::string place = "line " + std::to_string(line) + ": ";
    if (table.columns_.empty()) {
      table.columns_ = std::move(fields);
      if (const Status status = table.check_columns(); !status) return bad(place + status.error().message);
      continue;
    }
    if (fields.size() != table.columns_.size())
      return bad(place + std::to_string(fields.size()) + " fields: allowed " +
                 std::to_string(table.columns_.size()) + ", as in the header");
    table.rows_.push_back({line, std::move(fields)});
  }
  if (table.columns_.empty()) return bad("is empty: a line with column names comes first");
  return table;
}

Status CsvTable::check_columns() const {
  const auto bad = [](const std::string& what) { return Error{ErrorKind::bad_input, what}; };
  for (const auto& [separator, name] : {std::pair(';', "semicolons"), std::pair('\t', "tabs")})
    if (columns_.size() == 1 && columns_[0].find(separator) != std::string::npos)
      return bad("columns are separated by " + std::string(name) + ": allowed commas, and points in numbers");
  for (auto column = columns_.begin(); column != columns_.end(); ++column)
    if (!column->empty() && std::find(columns_.begin(), column, *column) != column)
      return bad("column " + printable(*column) + " stands there twice: allowed once");
  return {};
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
  const bool plus = field.starts_with('+') && !field.starts_with("+-");
  const char* begin = field.data() + (plus ? 1 : 0);
  const char* end = field.data() + field.size();
  double value = 0;
  const auto [stop, failure] = std::from_chars(begin, end, value);
  const bool denormal = std::fpclassify(value) == FP_SUBNORMAL;  // of which no quotient is finite
  if (failure != std::errc() || stop != end || !std::isfinite(value) || denormal || value < lowest ||
      value > highest)
    return Error{ErrorKind::bad_input, place(row) + ": " + std::string(column) + " = " +
                                           (field.empty() ? "nothing" : printable(field)) + ": allowed " +
                                           std::string(allowed)};
  return value;
}

Result<double> CsvTable::luminance(std::size_t row, std::string_view column) const {
  constexpr double kDarkest = 1e-9;
  constexpr const char* kAllowed = "0, or a number from 1e-9 to 1e12";
  auto value = number(row, column, 0, 1e12, kAllowed);
  if (value && *value > 0 && *value < kDarkest) return number(row, column, kDarkest, 1e12, kAllowed);
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

}  // namespace lightwell
