// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/radiance_hdr.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <optional>
#include <vector>

#include "lighting/chromaticities.h"

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

struct Header {
  int width = 0;
  int height = 0;
  Eigen::Array3d multiplier = Eigen::Array3d::Ones();  // of R, G, B since the radiance was measured
  std::optional<Eigen::Matrix3d> to_rec709;            // where the colours are of another space
};

// Numbers with spaces around them; none: other text.
template <std::size_t count>
std::optional<std::array<double, count>> finite_numbers(std::string_view text) {
  const auto skip_spaces = [&] {
    text.remove_prefix(std::min(text.find_first_not_of(" \t\r"), text.size()));
  };
  std::array<double, count> numbers{};
  for (double& number : numbers) {
    skip_spaces();
    if (text.starts_with('+')) text.remove_prefix(1);
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc() || !std::isfinite(number)) return std::nullopt;
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  }
  skip_spaces();
  return text.empty() ? std::optional(numbers) : std::nullopt;
}

template <std::size_t count>
std::optional<std::array<double, count>> positive_numbers(std::string_view text) {
  const auto numbers = finite_numbers<count>(text);
  return numbers && std::ranges::all_of(*numbers, [](double number) { return number > 0; }) ? numbers
                                                                                            : std::nullopt;
}

// PRIMARIES= x y of red, green, blue and white, from the last such line. False where it is none or no colour space.
bool take_primaries(std::optional<Eigen::Matrix3d>& to_rec709, std::string_view line) {
  constexpr std::string_view kPrimaries = "PRIMARIES=";
  if (!line.starts_with(kPrimaries)) return true;
  const auto xy = finite_numbers<8>(line.substr(kPrimaries.size()));
  if (!xy) return false;
  const auto& n = *xy;
  if (std::ranges::all_of(n, [](double value) { return value == 0; })) return true;  // Photoshop's "unknown"
  const Chromaticities space{{n[0], n[1]}, {n[2], n[3]}, {n[4], n[5]}, {n[6], n[7]}};
  to_rec709 = rec709_from(space);
  if (!to_rec709) return false;
  if (is_rec709(space)) to_rec709.reset();
  return true;
}

// False where the line is an EXPOSURE or COLORCORR without its numbers. Each multiplies those before it. source:
// Radiance file formats, "Picture File Format"
bool multiply(Eigen::Array3d& multiplier, std::string_view line) {
  constexpr std::string_view kExposure = "EXPOSURE=";
  constexpr std::string_view kColour = "COLORCORR=";
  if (line.starts_with(kExposure)) {
    const auto exposure = positive_numbers<1>(line.substr(kExposure.size()));
    if (exposure) multiplier *= (*exposure)[0];
    return exposure.has_value();
  }
  if (line.starts_with(kColour)) {
    const auto colour = positive_numbers<3>(line.substr(kColour.size()));
    if (colour) multiplier *= Eigen::Array3d(colour->data());
    return colour.has_value();
  }
  return true;
}

// The header's lines up to the empty one, then the resolution line.
Result<Header> read_header(Reader& reader, const std::string& name) {
  const auto bad = [&](const std::string& what) { return Error{ErrorKind::bad_input, name + ": " + what}; };
  Header header;
  for (;;) {
    const auto line = reader.line();
    if (!line) return bad("damaged Radiance HDR header");
    if (line->empty()) break;
    if (line->starts_with("FORMAT=") && !line->starts_with("FORMAT=32-bit_rle_rgbe"))
      return bad("Radiance HDR " + std::string(*line) + ", expected FORMAT=32-bit_rle_rgbe");
    if (!multiply(header.multiplier, *line))
      return bad("Radiance HDR " + std::string(line->substr(0, 100)) + ", expected " +
                 (line->starts_with("E") ? "a number" : "three numbers") + " above 0");
    if (!take_primaries(header.to_rec709, *line))
      return bad("Radiance HDR " + std::string(line->substr(0, 100)) +
                 ", expected x and y of red, green, blue and white of a colour space");
  }
  if (!(header.multiplier > 0).all() || !header.multiplier.isFinite().all())
    return bad("Radiance HDR EXPOSURE and COLORCORR lines multiply to no number above 0");
  const auto line = reader.line();
  char tail = 0;
  if (!line || line->size() > 100 ||
      std::sscanf(std::string(*line).c_str(), "-Y %9d +X %9d%c", &header.height, &header.width, &tail) < 2)
    return bad("Radiance HDR resolution line, expected -Y HEIGHT +X WIDTH");
  return header;
}

}  // namespace

bool is_radiance_hdr(std::string_view bytes) {
  return bytes.starts_with("#?");
}

Result<LatLongImage> read_radiance_hdr(std::string_view bytes, const std::string& name,
                                       std::int64_t pixel_limit, bool* converted) {
  Reader reader(bytes);
  const auto header = read_header(reader, name);
  if (!header) return header.error();
  if (header->width < 1 || header->height < 1 || std::int64_t{header->width} * header->height > pixel_limit)
    return Error{ErrorKind::bad_input, name + ": image size " + std::to_string(header->width) + "x" +
                                           std::to_string(header->height) + ", allowed 1x1 to " +
                                           std::to_string(pixel_limit) + " pixels"};
  LatLongImage image{header->width, header->height, {}};
  const Eigen::Array3f scale = (1 / header->multiplier).cast<float>();
  std::vector<Rgbe> row;
  for (int y = 0; y < header->height; ++y) {
    row.assign(static_cast<std::size_t>(header->width), Rgbe{});
    if (!read_row(reader, row))
      return Error{ErrorKind::bad_input, name + ": truncated or damaged image data in row " +
                                             std::to_string(y) + " of " + std::to_string(header->height)};
    for (const Rgbe& pixel : row) image.pixels.push_back(radiance(pixel) * scale);
  }
  if (header->to_rec709) convert_colours(image.pixels, *header->to_rec709);
  if (converted != nullptr) *converted = header->to_rec709.has_value();
  return image;
}

}  // namespace lightwell
