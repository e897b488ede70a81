// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/environment_io.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <new>
#include <span>

#include "interface/atomic_file.h"
#include "interface/exr_file.h"
#include "interface/radiance_hdr.h"

namespace lightwell {
namespace {

constexpr std::int64_t kPixelLimit = std::int64_t{1}
                                     << 28;  // a sphere at under an arc minute; 3 GB in memory
constexpr std::size_t kFileLimit = std::size_t{4} << 30;

Error bad(const std::string& name, const std::string& what) {
  return {ErrorKind::bad_input, name + ": " + what};
}

EnvironmentImage repair(LatLongImage image, NotFinite not_finite) {
  EnvironmentImage result;
  for (Rgb& pixel : image.pixels)
    for (int c = 0; c < 3; ++c) {
      if (!std::isfinite(pixel[c])) {
        ++result.not_finite;
        if (not_finite == NotFinite::zero) pixel[c] = 0;
      } else if (pixel[c] < 0) {
        ++result.negative;
        pixel[c] = 0;
      }
    }
  result.image = std::move(image);
  return result;
}

}  // namespace

std::string EnvironmentImage::remark(const std::filesystem::path& file) const {
  std::string what;
  if (not_finite > 0) what += std::to_string(not_finite) + " values are NaN or infinite";
  if (negative > 0) what += (what.empty() ? "" : ", ") + std::to_string(negative) + " values are negative";
  if (!what.empty()) what += "; read as 0";
  if (converted)
    what = "converted from the file's chromaticities to Rec. 709" + (what.empty() ? "" : "; " + what);
  // Odd sizes miss 2:1 by a pixel or two and mean no harm.
  if (std::abs(image.width - 2 * image.height) > std::max(2, image.width / 50))
    what = std::to_string(image.width) + "x" + std::to_string(image.height) +
           " is not 2:1; read as a latitude–longitude image all the same" + (what.empty() ? "" : "; ") + what;
  return what.empty() ? what : file.string() + ": " + what;
}

Result<EnvironmentImage> environment_from_bytes(std::string_view bytes, const std::string& name,
                                                NotFinite not_finite) {
  try {
    bool converted = false;
    Result<LatLongImage> image = is_exr(bytes) ? read_exr(bytes, name, kPixelLimit, &converted)
                                 : is_radiance_hdr(bytes)
                                     ? read_radiance_hdr(bytes, name, kPixelLimit, &converted)
                                     : bad(name, "is neither an OpenEXR nor a Radiance HDR image");
    if (!image) return image.error();
    EnvironmentImage environment = repair(std::move(image).value(), not_finite);
    environment.converted = converted;
    return environment;
  } catch (const std::bad_alloc&) {
    return Error{ErrorKind::failed, name + ": not enough memory for the image"};
  } catch (const std::exception&) {
    return bad(name, "damaged image");
  }
}

Result<EnvironmentImage> read_environment(const std::filesystem::path& file, NotFinite not_finite) {
  auto bytes = read_text_file(file, kFileLimit);
  if (!bytes) return bytes.error();
  if (bytes->empty()) return bad(file.string(), "is empty, expected an OpenEXR or Radiance HDR image");
  return environment_from_bytes(*bytes, file.string(), not_finite);
}

Result<std::string> environment_to_exr(const LatLongImage& image) {
  static_assert(sizeof(Rgb) == 3 * sizeof(float));
  const float* samples = image.pixels.empty() ? nullptr : image.pixels.front().data();
  return exr_from_floats(image.width, image.height, "RGB", std::span(samples, 3 * image.pixels.size()),
                         ExrContent::lat_long_environment);
}

Status write_environment(const std::filesystem::path& file, const LatLongImage& image) {
  const auto bytes = environment_to_exr(image);
  if (!bytes) return Error{bytes.error().kind, file.string() + ": " + bytes.error().message};
  return write_file_atomically(file, *bytes);
}

}  // namespace lightwell
