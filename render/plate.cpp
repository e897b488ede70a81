// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/plate.h"

#include <png.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <new>

#include "interface/atomic_file.h"
#include "interface/exr_file.h"
#include "interface/jpeg.h"
#include "interface/numbered_sequence.h"

namespace lightwell::render {
namespace {

constexpr std::size_t kPixelLimit = std::size_t{1} << 28;
constexpr std::size_t kFileLimit = std::size_t{4} << 30;

Error bad(const std::string& name, const std::string& what) {
  return {ErrorKind::bad_input, name + ": " + what};
}

Plate plate_from_codes(int width, int height, const std::vector<std::uint8_t>& rgb) {
  std::array<float, 256> linear{};
  for (std::size_t code = 0; code < linear.size(); ++code)
    linear[code] = linear_from_srgb(static_cast<float>(code) / 255);
  Plate plate{width, height, {}, true, ""};
  plate.pixels.reserve(rgb.size() / 3);
  for (std::size_t i = 0; i + 2 < rgb.size(); i += 3)
    plate.pixels.emplace_back(linear[rgb[i]], linear[rgb[i + 1]], linear[rgb[i + 2]]);
  return plate;
}

Result<Plate> read_png(std::string_view bytes, const std::string& name) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  const auto failure = [&](const std::string& what) {
    png_image_free(&image);
    return bad(name, what);
  };
  if (png_image_begin_read_from_memory(&image, bytes.data(), bytes.size()) == 0)
    return failure("is no PNG picture: its header is damaged");
  const std::size_t pixels = std::size_t{image.width} * image.height;
  if (pixels > kPixelLimit) return failure("has " + std::to_string(pixels) + " pixels, allowed 2^28");
  const bool sixteen_bits = (image.format & PNG_FORMAT_FLAG_LINEAR) != 0;
  const int width = static_cast<int>(image.width);
  const int height = static_cast<int>(image.height);
  const png_color black{0, 0, 0};
  if (!sixteen_bits) {
    image.format = PNG_FORMAT_RGB;
    std::vector<std::uint8_t> rgb(pixels * 3);
    if (png_image_finish_read(&image, &black, rgb.data(), 0, nullptr) == 0)
      return failure("is a damaged PNG picture: cut, or changed in the middle");
    return plate_from_codes(width, height, rgb);
  }
  image.format = PNG_FORMAT_LINEAR_RGB;
  image.flags |= PNG_IMAGE_FLAG_16BIT_sRGB;  // where the file does not say otherwise
  std::vector<std::uint16_t> rgb(pixels * 3);
  if (png_image_finish_read(&image, nullptr, rgb.data(), 0, nullptr) == 0)
    return failure("is a damaged PNG picture: cut, or changed in the middle");
  Plate plate{width, height, {}, true, ""};
  plate.pixels.reserve(pixels);
  for (std::size_t i = 0; i < rgb.size(); i += 3)
    plate.pixels.emplace_back(
        Rgb(static_cast<float>(rgb[i]), static_cast<float>(rgb[i + 1]), static_cast<float>(rgb[i + 2])) /
        65535);
  return plate;
}

Result<Plate> read_linear(std::string_view bytes, const std::string& name) {
  bool converted = false;
  auto image = read_exr(bytes, name, static_cast<std::int64_t>(kPixelLimit), &converted);
  if (!image) return image.error();
  std::size_t repaired = 0;
  for (Rgb& pixel : image->pixels)
    for (int c = 0; c < 3; ++c)
      if (!std::isfinite(pixel[c]) || pixel[c] < 0) {
        pixel[c] = 0;
        ++repaired;
      }
  std::string remark;
  if (repaired > 0)
    remark = name + ": " + std::to_string(repaired) + " values are NaN, infinite or negative; read as 0";
  return Plate{image->width, image->height, std::move(image->pixels), false, std::move(remark)};
}

}  // namespace

float linear_from_srgb(float code) {
  return code <= 0.04045f ? code / 12.92f : std::pow((code + 0.055f) / 1.055f, 2.4f);
}

Result<Plate> plate_from_bytes(std::string_view bytes, const std::string& name) {
  try {
    if (is_exr(bytes)) return read_linear(bytes, name);
    if (bytes.starts_with("\x89PNG")) return read_png(bytes, name);
    if (!bytes.starts_with("\xFF\xD8")) return bad(name, "is no OpenEXR, PNG or JPEG picture");
    auto picture = decode_jpeg(bytes, name);
    if (!picture) return picture.error();
    return plate_from_codes(picture->width, picture->height, picture->rgb);
  } catch (const std::bad_alloc&) {
    return Error{ErrorKind::failed, name + ": not enough memory for the picture"};
  }
}

Result<Plate> read_plate(const std::filesystem::path& file) {
  const auto bytes = read_text_file(file, kFileLimit);
  if (!bytes) return bytes.error();
  return plate_from_bytes(*bytes, file.string());
}

Result<PlateSource> PlateSource::open(const std::string& pattern, std::optional<bool> graded) {
  PlateSource source;
  source.graded_ = graded;
  if (is_numbered_sequence(pattern)) {
    auto files = sequence_files(pattern);
    if (!files) return files.error();
    source.files_ = std::move(files).value();
  } else {
    source.files_ = {pattern};
  }
  if (const auto first = source.update(0); !first) return first.error();
  return source;
}

Result<bool> PlateSource::update(int frame) {
  const int wanted = std::min(frame, static_cast<int>(files_.size()) - 1);
  if (wanted == shown_) return false;
  auto plate = read_plate(files_[static_cast<std::size_t>(wanted)]);
  if (!plate) return plate.error();
  plate_ = std::move(plate).value();
  plate_.display_referred = graded_.value_or(plate_.display_referred);
  shown_ = wanted;
  return true;
}

}  // namespace lightwell::render
