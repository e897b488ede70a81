// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include "calibration/lens_import/source_formats.h"

namespace lightwell::calibration {
namespace {

struct Row {
  std::size_t line = 0;
  std::vector<double> numbers;
};

[[noreturn]] void refuse(const std::string& file, const Row& row, const std::string& what) {
  throw FieldFailure{{ErrorKind::bad_input, file + ": line " + std::to_string(row.line) + ": " + what}};
}

// Rows of numbers; blank lines and those that begin with # are not counted.
std::vector<Row> rows_of(const std::string& text, const std::string& file) {
  std::vector<Row> rows;
  std::istringstream lines(text);
  std::string line;
  for (std::size_t n = 1; std::getline(lines, line); ++n) {
    std::istringstream words(line);
    std::string word;
    Row row{n, {}};
    while (words >> word && word[0] != '#') {
      const std::size_t sign = word[0] == '+' ? 1 : 0;
      double value = 0;
      const auto [end, error] = std::from_chars(word.data() + sign, word.data() + word.size(), value);
      if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(value))
        refuse(file, row, "\"" + word.substr(0, 40) + "\": allowed a finite number");
      row.numbers.push_back(value);
    }
    if (!row.numbers.empty()) rows.push_back(std::move(row));
  }
  return rows;
}

// "n c0 c1 …" with n numbers after the first.
std::vector<double> polynomial(const std::string& file, const Row& row, const char* which) {
  constexpr std::size_t kMost = 64;
  const double count = row.numbers[0];
  const std::size_t there = row.numbers.size() - 1;
  if (count != static_cast<double>(there) || there < 1 || there > kMost) {
    std::ostringstream says;
    says << which << " says " << count << " coefficients and has " << there << ": allowed as many, 1 to "
         << kMost;
    refuse(file, row, says.str());
  }
  return {row.numbers.begin() + 1, row.numbers.end()};
}

}  // namespace

SourceLens ocamcalib_lens(const std::string& text, const std::string& file) {
  const std::vector<Row> rows = rows_of(text, file);
  constexpr const char* kRows[] = {"the direct polynomial", "the inverse polynomial",
                                   "the centre: row, column", "the affine parameters c, d, e",
                                   "the image size: height, width"};
  if (rows.size() != 5)
    throw FieldFailure{
        {ErrorKind::bad_input,
         file + ": has " + std::to_string(rows.size()) + " rows of numbers: " +
             (rows.size() < 5 ? kRows[rows.size()] + std::string(" is missing") : "allowed 5")}};
  OcamModel model;
  model.polynomial = polynomial(file, rows[0], kRows[0]);
  (void)polynomial(file, rows[1], kRows[1]);  // an approximation of the first, which is taken itself
  constexpr std::size_t kCounts[] = {0, 0, 2, 3, 2};
  for (std::size_t i = 2; i < 5; ++i)
    if (rows[i].numbers.size() != kCounts[i])
      refuse(file, rows[i],
             std::string(kRows[i]) + ": has " + std::to_string(rows[i].numbers.size()) +
                 " numbers, allowed " + std::to_string(kCounts[i]));
  if (!(model.polynomial[0] < 0 && model.polynomial[0] > -1e6))
    refuse(file, rows[0],
           std::string(kRows[0]) + ": its first coefficient is " + std::to_string(model.polynomial[0]) +
               ", allowed below 0, above -1e6 pixels");
  model.center_row_column = {rows[2].numbers[0], rows[2].numbers[1]};
  for (const double v : rows[2].numbers)
    if (!(std::abs(v) < 1e6)) refuse(file, rows[2], std::string(kRows[2]) + ": allowed -1e6 to 1e6 pixels");
  model.c = rows[3].numbers[0];
  model.d = rows[3].numbers[1];
  model.e = rows[3].numbers[2];
  if (!(model.c > 0.1 && model.c < 10 && std::abs(model.d) < 1 && std::abs(model.e) < 1))
    refuse(file, rows[3], std::string(kRows[3]) + ": allowed c from 0.1 to 10, d and e from -1 to 1");
  SourceLens out;
  out.format = LensFormat::ocamcalib;
  out.model = "polynomial of degree " + std::to_string(model.polynomial.size() - 1);
  for (std::size_t i = 0; i < 2; ++i) {
    const double side = rows[4].numbers[1 - i];
    if (side != std::floor(side) || side < 1 || side > 16384)
      refuse(file, rows[4], std::string(kRows[4]) + ": allowed whole numbers from 1 to 16384");
    out.image_size[i] = static_cast<int>(side);
  }
  model.largest_rho = 2 * std::hypot(out.image_size[0], out.image_size[1]);
  out.project = ocam(std::move(model));
  return out;
}

}  // namespace lightwell::calibration
