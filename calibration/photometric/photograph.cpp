// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <libexif/exif-data.h>

#include <memory>

#include "calibration/photometric/brackets.h"
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

}  // namespace

Result<Photograph> read_photograph(const std::filesystem::path& file, double exposure_s, int shrink) {
  const auto bytes = read_text_file(file);
  if (!bytes) return bytes.error();
  auto picture = decode_jpeg(*bytes, file.string(), shrink);
  if (!picture) return picture.error();
  Photograph out;
  out.file = file.string();
  out.picture = *std::move(picture);
  const std::unique_ptr<ExifData, Release> exif(exif_data_new_from_data(
      reinterpret_cast<const unsigned char*>(bytes->data()), static_cast<unsigned>(bytes->size())));
  out.exposure_s = exposure_s > 0 ? exposure_s : exif_number(exif.get(), EXIF_TAG_EXPOSURE_TIME).value_or(0);
  if (!(out.exposure_s > 0))
    return Error{ErrorKind::bad_input,
                 out.file + ": has no exposure time in its EXIF data: give --exposures"};
  out.f_number = exif_number(exif.get(), EXIF_TAG_FNUMBER);
  out.iso = exif_number(exif.get(), EXIF_TAG_ISO_SPEED_RATINGS);
  return out;
}

}  // namespace lightwell::calibration
