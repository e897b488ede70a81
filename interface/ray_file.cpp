// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/ray_file.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <optional>

#include "interface/atomic_file.h"

namespace lightwell {
namespace {

constexpr double kMillimetre_m = 1e-3;
constexpr std::size_t kTextCharacters = 1000;  // of each of nine texts, UTF-32
constexpr std::size_t kLargestFile = std::size_t{4} << 30;

// Little-endian fields in their order; after the end everything reads as nothing, which the caller asks for once.
class Fields {
 public:
  explicit Fields(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  template <class T>
  T take() {
    T value{};
    if (!need(sizeof(T))) return value;
    std::array<std::uint8_t, sizeof(T)> raw;
    std::memcpy(raw.data(), bytes_.data() + at_, sizeof(T));
    if constexpr (std::endian::native == std::endian::big) std::reverse(raw.begin(), raw.end());
    std::memcpy(&value, raw.data(), sizeof(T));
    at_ += sizeof(T);
    return value;
  }
  void skip(std::uint64_t count) {
    if (need(count)) at_ += static_cast<std::size_t>(count);
  }
  [[nodiscard]] bool short_of() const { return short_; }
  [[nodiscard]] std::size_t left() const { return bytes_.size() - at_; }

 private:
  bool need(std::uint64_t count) {
    if (count > bytes_.size() - at_) short_ = true;
    return !short_;
  }
  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = 0;
  bool short_ = false;
};

std::string latin_of(Fields& fields) {
  std::string text;
  bool ended = false;
  for (std::size_t i = 0; i < kTextCharacters; ++i) {
    const auto letter = fields.take<std::uint32_t>();
    ended = ended || letter == 0;
    if (!ended) text += letter >= ' ' && letter < 127 ? static_cast<char>(letter) : '?';
  }
  return text;
}

struct Header {
  double luminous_flux_lm = 0, radiant_flux_w = 0;  // 0: not said
  std::uint64_t rays = 0;
  std::uint64_t items = 0;                         // of a ray, floats
  std::optional<std::uint64_t> radiant, luminous;  // which of them
  std::string name;
};

std::optional<bool> flag(Fields& fields) {
  const auto value = fields.take<std::int32_t>();
  if (value != 0 && value != 1) return std::nullopt;
  return value == 1;
}

// TM-25-13, section 4.7.
Result<Header> read_header(Fields& fields, const std::string& file) {
  const auto bad = [&](const std::string& what) { return Error{ErrorKind::bad_input, file + ": " + what}; };
  const auto cut = [&](const char* where) {
    return bad(std::string("ends inside ") + where + ": the file is cut short");
  };
  std::array<char, 4> magic{};
  for (char& letter : magic) letter = fields.take<char>();
  if (std::string(magic.data(), 4) != "TM25") return bad("does not begin with TM25: not a ray file of TM-25");
  const auto version = fields.take<std::int32_t>();
  if (!fields.short_of() && version != 2013)
    return bad("version is " + std::to_string(version) + ", allowed: 2013");
  fields.skip(4);  // measured or simulated
  Header header;
  const auto positive = [](float flux) {
    return std::isfinite(flux) && flux > 0 ? static_cast<double>(flux) : 0.0;
  };
  header.luminous_flux_lm = positive(fields.take<float>());
  header.radiant_flux_w = positive(fields.take<float>());
  header.rays = fields.take<std::uint64_t>();
  fields.skip(28 + 5 * 4);  // date, where rays start, spectrum: kind, wavelength, range
  const auto tables = fields.take<std::int32_t>();
  const auto more_items = fields.take<std::int32_t>();
  const auto text_bytes = fields.take<std::int32_t>();
  fields.skip(168);
  if (fields.short_of()) return cut("the header");
  constexpr std::int32_t kMost = 1 << 20;
  const auto in_range = [&](const char* what, std::int32_t value) -> Status {
    if (value >= 0 && value <= kMost) return {};
    return bad(std::string(what) + " is " + std::to_string(value) + ", allowed: 0 to " +
               std::to_string(kMost));
  };
  if (const Status good = in_range("number of spectral tables", tables); !good) return good.error();
  if (const Status good = in_range("number of additional items", more_items); !good) return good.error();
  if (const Status good = in_range("size of the additional text", text_bytes); !good) return good.error();
  std::array<bool, 8>
      flags{};  // position, direction, radiant flux, wavelength, luminous flux, Stokes, tristimulus, spectrum
  for (bool& value : flags) {
    const auto read = flag(fields);
    if (!read) return bad("a data flag is neither 0 nor 1");
    value = *read;
  }
  if (!fields.short_of() && (!flags[0] || !flags[1])) return bad("rays have no position or no direction");
  constexpr std::array<std::uint64_t, 8> kItems = {3, 3, 1, 1, 1, 3, 2, 1};
  for (std::size_t i = 0; i < flags.size(); ++i) {
    if (!flags[i]) continue;
    if (i == 2) header.radiant = header.items;
    if (i == 4) header.luminous = header.items;
    header.items += kItems[i];
  }
  if (!fields.short_of() && !header.radiant && !header.luminous) return bad("rays have no flux");
  header.items += static_cast<std::uint64_t>(more_items);
  header.name = latin_of(fields);
  for (int text = 1; text < 9; ++text) fields.skip(kTextCharacters * 4);
  std::uint64_t table_bytes = 0;
  for (std::int32_t i = 0; i < tables && !fields.short_of(); ++i) {
    const auto pairs = fields.take<std::int32_t>();
    if (pairs < 0) return bad("a spectral table has " + std::to_string(pairs) + " pairs, allowed: 0 or more");
    fields.skip(8 * static_cast<std::uint64_t>(pairs));
    table_bytes += 4 + 8 * static_cast<std::uint64_t>(pairs);
  }
  fields.skip((32 - table_bytes % 32) % 32);
  fields.skip(512 * static_cast<std::uint64_t>(more_items));
  fields.skip(static_cast<std::uint64_t>(text_bytes));
  if (fields.short_of()) return cut("the header");
  return header;
}

}  // namespace

Result<RayFile> parse_tm25(std::span<const std::uint8_t> bytes, const std::string& file) {
  Fields fields(bytes);
  const auto header = read_header(fields, file);
  if (!header) return header.error();
  const auto bad = [&](const std::string& what) { return Error{ErrorKind::bad_input, file + ": " + what}; };
  const std::uint64_t there = fields.left() / (header->items * sizeof(float));
  if (header->rays == 0) return bad("number of rays is 0, allowed: 1 or more");
  if (there < header->rays)
    return bad("has " + std::to_string(there) + " rays where its header says " +
               std::to_string(header->rays) + ": the file is cut short");
  RayFile out;
  out.name = header->name;
  out.stated_flux_lm = header->luminous_flux_lm;
  const std::uint64_t flux_item = header->luminous ? *header->luminous : *header->radiant;
  std::vector<double> item(header->items);
  out.rays.reserve(header->rays);
  std::size_t dark = 0;
  double sum = 0;
  for (std::uint64_t i = 0; i < header->rays; ++i) {
    for (double& value : item) value = static_cast<double>(fields.take<float>());
    const Vec3d direction(item[3], -item[4], -item[5]);
    const auto wrong = [&](const char* what) { return bad("ray " + std::to_string(i + 1) + ": " + what); };
    for (std::size_t k = 0; k < 3; ++k)
      if (!(std::abs(item[k]) <= 1e6)) return wrong("a position is no number up to 1e6 mm");
    if (!(std::abs(direction.norm() - 1) <= 1e-2)) return wrong("its direction is no unit vector");
    const double flux = item[flux_item];
    if (!std::isfinite(flux) || flux < 0)
      return wrong("its flux is negative or no number, allowed: 0 or more");
    if (flux == 0) {
      ++dark;
      continue;
    }
    sum += flux;
    out.rays.push_back({Vec3d(item[0], -item[1], -item[2]) * kMillimetre_m, direction.normalized(), flux});
  }
  if (out.rays.empty()) return bad("no ray has any flux");
  if (dark > 0) out.remarks.push_back(std::to_string(dark) + " rays have no flux");
  if (!header->luminous) {
    if (header->luminous_flux_lm > 0)
      for (LampRay& ray : out.rays) ray.flux_lm *= header->luminous_flux_lm / sum;
    else
      out.remarks.emplace_back("no luminous flux is said: watts count as lumens");
  }
  return out;
}

Result<RayFile> read_tm25(const std::filesystem::path& file) {
  const auto text = read_text_file(file, kLargestFile);
  if (!text) return text.error();
  return parse_tm25({reinterpret_cast<const std::uint8_t*>(text->data()), text->size()}, file.string());
}

}  // namespace lightwell
