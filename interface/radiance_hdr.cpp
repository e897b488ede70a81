// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/radiance_hdr.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <vector>

namespace lightwell {
namespace {

using Rgbe = std::array<std::uint8_t, 4>;

// The bytes not yet read; every read says whether there was enough.
class Reader {
 public:
  explicit Reader(std::string_view bytes) : bytes_(bytes) {}

  std::optional<std::string_view> line() {
    const auto end = bytes_.find('\n');
    if (end == std::string_view::npos || end > 4096) return std::nullopt;
    const auto text = bytes_.substr(0, end);
    bytes_.remove_prefix(end + 1);
    return text;
  }
  bool read(std::uint8_t& value) {
    if (bytes_.empty()) return false;
    value = static_cast<std::uint8_t>(bytes_.front());
    bytes_.remove_prefix(1);
    return true;
  }
  bool read(Rgbe& value) { return read(value[0]) && read(value[1]) && read(value[2]) && read(value[3]); }
  [[nodiscard]] std::optional<Rgbe> peek() const {
    Reader copy(bytes_);
    Rgbe value{};
    if (!copy.read(value)) return std::nullopt;
    return value;
  }
  [[nodiscard]] std::size_t left() const { return bytes_.size(); }

 private:
  std::string_view bytes_;
};

// Mantissa m of exponent e stands for (m + ½)/256 · 2^(e − 128) in Radiance's own tools, m/256 in all others
// and in what is measured against them; 0 is exactly black in both.
Rgb radiance(const Rgbe& p) {
  if (p[3] == 0) return Rgb::Zero();
  const float scale = std::ldexp(1.0f, static_cast<int>(p[3]) - (128 + 8));
  return Rgb(p[0], p[1], p[2]) * scale;
}

// Flat pixels with the old run marker: (1, 1, 1, n) repeats the last pixel n << shift times.
bool read_flat_row(Reader& reader, std::vector<Rgbe>& row) {
  std::size_t x = 0;
  int shift = 0;
  while (x < row.size()) {
    Rgbe value{};
    if (!reader.read(value)) return false;
    if (value[0] != 1 || value[1] != 1 || value[2] != 1) {
      row[x++] = value;
      shift = 0;
      continue;
    }
    if (x == 0 || shift > 24) return false;
    const std::size_t run = static_cast<std::size_t>(value[3]) << shift;
    if (run > row.size() - x) return false;
    for (std::size_t i = 0; i < run; ++i, ++x) row[x] = row[x - 1];
    shift += 8;
  }
  return true;
}

// Four planes, each of runs: n > 128 repeats the next byte n − 128 times, else n bytes follow.
bool read_coded_row(Reader& reader, std::vector<Rgbe>& row) {
  for (std::size_t plane = 0; plane < 4; ++plane) {
    std::size_t x = 0;
    while (x < row.size()) {
      std::uint8_t count = 0;
      std::uint8_t value = 0;
      if (!reader.read(count)) return false;
      const bool repeat = count > 128;
      const std::size_t n = repeat ? count - 128u : count;
      if (n == 0 || n > row.size() - x) return false;
      for (std::size_t i = 0; i < n; ++i) {
        if ((i == 0 || !repeat) && !reader.read(value)) return false;
        row[x++][plane] = value;
      }
    }
  }
  return true;
}

bool read_row(Reader& reader, std::vector<Rgbe>& row) {
  const auto start = reader.peek();
  if (!start) return false;
  const bool coded = row.size() >= 8 && row.size() < 32768 && (*start)[0] == 2 && (*start)[1] == 2 &&
                     static_cast<std::size_t>((*start)[2]) * 256 + (*start)[3] == row.size();
  if (!coded) return read_flat_row(reader, row);
  Rgbe marker{};
  return reader.read(marker) && read_coded_row(reader, row);
}

struct Size {
  int width = 0;
  int height = 0;
};

// The header's lines up to the empty one, then the resolution line.
Result<Size> read_header(Reader& reader, const std::string& name) {
  const auto bad = [&](const std::string& what) { return Error{ErrorKind::bad_input, name + ": " + what}; };
  for (;;) {
    const auto line = reader.line();
    if (!line) return bad("damaged Radiance HDR header");
    if (line->empty()) break;
    if (line->starts_with("FORMAT=") && !line->starts_with("FORMAT=32-bit_rle_rgbe"))
      return bad("Radiance HDR " + std::string(*line) + ", expected FORMAT=32-bit_rle_rgbe");
  }
  const auto line = reader.line();
  Size size;
  char tail = 0;
  if (!line || line->size() > 100 ||
      std::sscanf(std::string(*line).c_str(), "-Y %9d +X %9d%c", &size.height, &size.width, &tail) < 2)
    return bad("Radiance HDR resolution line, expected -Y HEIGHT +X WIDTH");
  return size;
}

}  // namespace

bool is_radiance_hdr(std::string_view bytes) {
  return bytes.starts_with("#?");
}

Result<LatLongImage> read_radiance_hdr(std::string_view bytes, const std::string& name,
                                       std::int64_t pixel_limit) {
  Reader reader(bytes);
  const auto size = read_header(reader, name);
  if (!size) return size.error();
  if (size->width < 1 || size->height < 1 || std::int64_t{size->width} * size->height > pixel_limit)
    return Error{ErrorKind::bad_input, name + ": image size " + std::to_string(size->width) + "x" +
                                           std::to_string(size->height) + ", allowed 1x1 to " +
                                           std::to_string(pixel_limit) + " pixels"};
  LatLongImage image{size->width, size->height, {}};
  std::vector<Rgbe> row;
  for (int y = 0; y < size->height; ++y) {
    row.assign(static_cast<std::size_t>(size->width), Rgbe{});
    if (!read_row(reader, row))
      return Error{ErrorKind::bad_input, name + ": truncated or damaged image data in row " +
                                             std::to_string(y) + " of " + std::to_string(size->height)};
    for (const Rgbe& pixel : row) image.pixels.push_back(radiance(pixel));
  }
  return image;
}

}  // namespace lightwell
