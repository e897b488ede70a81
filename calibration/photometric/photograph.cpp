// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/photometric/photograph.h"

#include <libexif/exif-data.h>

#include <algorithm>
#include <array>

#include "interface/atomic_file.h"

namespace lightwell::calibration {
namespace {

struct Release {
  void operator()(ExifData* data) const { exif_data_unref(data); }
};

std::optional<double> exif_number(ExifData* data, ExifTag tag) {
  if (data == nullptr) return std::nullopt;
  const ExifEntry* entry = exif_content_get_entry(data->ifd[EXIF_IFD_EXIF], tag);
  if (entry == nullptr || entry->data == nullptr || entry->components < 1) return std::nullopt;
  const ExifByteOrder order = exif_data_get_byte_order(data);
  if (entry->format == EXIF_FORMAT_RATIONAL && entry->size >= 8) {
    const ExifRational r = exif_get_rational(entry->data, order);
    if (r.denominator == 0 || r.numerator == 0) return std::nullopt;
    return static_cast<double>(r.numerator) / r.denominator;
  }
  if (entry->format == EXIF_FORMAT_SHORT && entry->size >= 2) return exif_get_short(entry->data, order);
  return std::nullopt;
}

// Mean codes of a square, rounded, and by how much a channel's differ in it.
struct Square {
  std::array<std::uint8_t, 3> mean{};
  int spread = 0;
};

Square square_of(const JpegPicture& full, int left, int top, int side) {
  const int right = std::min(left + side, full.width), bottom = std::min(top + side, full.height);
  std::array<int, 3> sum{}, low, high{};
  low.fill(255);
  for (int y = top; y < bottom; ++y) {
    const std::uint8_t* code =
        &full.rgb[3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(full.width) +
                       static_cast<std::size_t>(left))];
    for (int x = left; x < right; ++x)
      for (std::size_t c = 0; c < 3; ++c, ++code) {
        sum[c] += *code;
        low[c] = std::min<int>(low[c], *code);
        high[c] = std::max<int>(high[c], *code);
      }
  }
  const int count = (right - left) * (bottom - top);
  Square out;
  for (std::size_t c = 0; c < 3; ++c) {
    out.mean[c] = static_cast<std::uint8_t>((sum[c] + count / 2) / count);
    out.spread = std::max(out.spread, high[c] - low[c]);
  }
  return out;
}

// Even squares differ by noise and JPEG's rounding; in a noisy photograph most do, by about as much as the quietest
// quarter of those that are not black.
int most_spread_of_even(std::vector<int> spreads) {
  constexpr int kAlwaysEven = 12;  // codes
  if (spreads.empty()) return kAlwaysEven;
  const auto quartile = spreads.begin() + static_cast<std::ptrdiff_t>(spreads.size() / 4);
  std::nth_element(spreads.begin(), quartile, spreads.end());
  return std::max(kAlwaysEven, 2 * *quartile);
}

void shrink_into(Photograph& out, const JpegPicture& full, int side) {
  out.full_width = full.width;
  out.full_height = full.height;
  out.picture.width = (full.width + side - 1) / side;
  out.picture.height = (full.height + side - 1) / side;
  std::vector<int> spreads, lit;
  for (int y = 0; y < full.height; y += side)
    for (int x = 0; x < full.width; x += side) {
      const Square square = square_of(full, x, y, side);
      out.picture.rgb.insert(out.picture.rgb.end(), square.mean.begin(), square.mean.end());
      spreads.push_back(square.spread);
      if (square.spread > 0) lit.push_back(square.spread);
    }
  const int most = most_spread_of_even(std::move(lit));
  for (const int spread : spreads) out.uneven.push_back(spread > most ? 1 : 0);
}

}  // namespace

Result<Photograph> read_photograph(const std::filesystem::path& file, double exposure_s, int shrink) {
  auto bytes = read_text_file(file);
  if (!bytes) return bytes.error();
  const auto picture = decode_jpeg(*bytes, file.string());
  if (!picture) return picture.error();
  Photograph out;
  out.file = file.string();
  shrink_into(out, *picture, shrink);
  const std::unique_ptr<ExifData, Release> exif(exif_data_new_from_data(
      reinterpret_cast<const unsigned char*>(bytes->data()), static_cast<unsigned>(bytes->size())));
  out.exif_exposure_s = exif_number(exif.get(), EXIF_TAG_EXPOSURE_TIME);
  out.exposure_s = exposure_s > 0 ? exposure_s : out.exif_exposure_s.value_or(0);
  if (!(out.exposure_s > 0))
    return Error{ErrorKind::bad_input,
                 out.file + ": has no exposure time in its EXIF data: give --exposures"};
  out.f_number = exif_number(exif.get(), EXIF_TAG_FNUMBER);
  out.iso = exif_number(exif.get(), EXIF_TAG_ISO_SPEED_RATINGS);
  out.jpeg = std::make_shared<const std::string>(*std::move(bytes));
  return out;
}

}  // namespace lightwell::calibration
