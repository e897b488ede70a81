// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/environment_io.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <new>
#include <optional>
#include <vector>

#include "interface/atomic_file.h"
#include "interface/radiance_hdr.h"

namespace lightwell {
namespace {

constexpr std::int64_t kPixelLimit = std::int64_t{1}
                                     << 28;  // a sphere at under an arc minute; 3 GB in memory
constexpr std::size_t kFileLimit = std::size_t{4} << 30;
constexpr std::string_view kExrMagic = "\x76\x2f\x31\x01";

Error bad(const std::string& name, const std::string& what) {
  return {ErrorKind::bad_input, name + ": " + what};
}

std::string first_line(const std::string& text) {
  return text.substr(0, text.find('\n'));
}

// Indices of R, G, B among the file's channels; -1: dark. gray: all three the same one.
std::optional<std::array<int, 3>> colour_channels(const std::vector<std::string>& names) {
  const auto find = [&](const std::string& wanted) -> int {
    const auto matches = [&](const std::string& name) {
      return std::equal(name.begin(), name.end(), wanted.begin(), wanted.end(), [](char a, char b) {
        return std::toupper(static_cast<unsigned char>(a)) == std::toupper(static_cast<unsigned char>(b));
      });
    };
    const auto at = std::find_if(names.begin(), names.end(), matches);
    return at == names.end() ? -1 : static_cast<int>(at - names.begin());
  };
  // The plain channels first, then those of the first layer that has any ("rgba.R").
  std::vector<std::string> prefixes = {""};
  for (const std::string& name : names)
    if (const auto dot = name.rfind('.'); dot != std::string::npos)
      prefixes.push_back(name.substr(0, dot + 1));
  for (const std::string& prefix : prefixes) {
    const std::array<int, 3> rgb = {find(prefix + "R"), find(prefix + "G"), find(prefix + "B")};
    if (rgb != std::array<int, 3>{-1, -1, -1}) return rgb;
    if (const int y = find(prefix + "Y"); y >= 0) return std::array<int, 3>{y, y, y};
  }
  if (names.size() == 1 && find("A") < 0 && find("Z") < 0) return std::array<int, 3>{0, 0, 0};
  return std::nullopt;
}

// The part of the pixel data that a caller may ask for at once: some rows, or a row of tiles.
struct Rows {
  int begin;
  int end;
};

bool read_rows(OIIO::ImageInput& input, const OIIO::ImageSpec& spec, Rows rows, int channels, float* out) {
  if (spec.tile_width > 0)
    return input.read_tiles(0, 0, spec.x, spec.x + spec.width, rows.begin, rows.end, spec.z, spec.z + 1, 0,
                            channels, OIIO::TypeDesc::FLOAT, out);
  return input.read_scanlines(0, 0, rows.begin, rows.end, spec.z, 0, channels, OIIO::TypeDesc::FLOAT, out);
}

// Grows with what the file really holds: a header that promises more than there is costs nothing.
Result<LatLongImage> read_pixels(OIIO::ImageInput& input, const OIIO::ImageSpec& spec,
                                 const std::array<int, 3>& channels, const std::string& name) {
  LatLongImage image{spec.full_width, spec.full_height, {}};
  const auto stride = static_cast<std::size_t>(spec.nchannels);
  const auto columns = static_cast<std::size_t>(spec.width);
  const int step = spec.tile_height > 0 ? spec.tile_height : 64;
  std::vector<Rgb> data;
  std::vector<float> buffer;
  for (int y = spec.y; y < spec.y + spec.height; y += step) {
    const Rows rows{y, std::min(y + step, spec.y + spec.height)};
    const std::size_t pixels = columns * static_cast<std::size_t>(rows.end - rows.begin);
    buffer.assign(pixels * stride, 0.0f);
    if (!read_rows(input, spec, rows, spec.nchannels, buffer.data()))
      return bad(name, "truncated or damaged image data: " + first_line(input.geterror()));
    for (std::size_t p = 0; p < pixels; ++p) {
      Rgb value = Rgb::Zero();
      for (int c = 0; c < 3; ++c)
        if (const int from = channels[static_cast<std::size_t>(c)]; from >= 0)
          value[c] = buffer[p * stride + static_cast<std::size_t>(from)];
      data.push_back(value);
    }
  }
  // The data window may be smaller than the image, or reach beyond it.
  image.pixels.assign(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height),
                      Rgb::Zero());
  for (int y = 0; y < spec.height; ++y)
    for (int x = 0; x < spec.width; ++x) {
      const std::int64_t u = std::int64_t{x} + spec.x - spec.full_x;
      const std::int64_t v = std::int64_t{y} + spec.y - spec.full_y;
      if (u < 0 || v < 0 || u >= image.width || v >= image.height) continue;
      image.at(static_cast<int>(u), static_cast<int>(v)) =
          data[static_cast<std::size_t>(y) * columns + static_cast<std::size_t>(x)];
    }
  return image;
}

Result<LatLongImage> read_exr(std::string_view bytes, const std::string& name) {
  OIIO::Filesystem::IOMemReader memory(bytes.data(), bytes.size());
  const auto input = OIIO::ImageInput::create("openexr");
  if (!input) return Error{ErrorKind::failed, "OpenImageIO has no OpenEXR reader: " + OIIO::geterror()};
  OIIO::ImageSpec spec;
  if (!input->set_ioproxy(&memory) || !input->open("memory.exr", spec))
    return bad(name, "not a readable EXR image: " + first_line(input->geterror()));
  if (spec.deep) return bad(name, "deep image data, expected a flat latitude–longitude image");
  if (spec.get_string_attribute("textureformat") == "CubeFace Environment")
    return bad(name, "attribute envmap is cube, expected latitude–longitude");
  if (spec.full_width <= 0 || spec.full_height <= 0) {
    spec.full_width = spec.width;
    spec.full_height = spec.height;
  }
  const auto too_big = [](int w, int h) { return w <= 0 || h <= 0 || std::int64_t{w} * h > kPixelLimit; };
  if (too_big(spec.width, spec.height) || too_big(spec.full_width, spec.full_height) || spec.depth != 1)
    return bad(name, "image size " + std::to_string(spec.full_width) + "x" +
                         std::to_string(spec.full_height) + " with data " + std::to_string(spec.width) + "x" +
                         std::to_string(spec.height) + ", allowed 1x1 to 2^28 pixels");
  const auto channels = colour_channels(spec.channelnames);
  if (!channels) return bad(name, "no colour channels, expected R, G, B or Y");
  return read_pixels(*input, spec, *channels, name);
}

EnvironmentImage repair(LatLongImage image) {
  EnvironmentImage result;
  for (Rgb& pixel : image.pixels)
    for (int c = 0; c < 3; ++c) {
      if (!std::isfinite(pixel[c])) {
        ++result.not_finite;
        pixel[c] = 0;
      } else if (pixel[c] < 0) {
        ++result.negative;
        pixel[c] = 0;
      }
    }
  result.image = std::move(image);
  return result;
}

}  // namespace

std::string EnvironmentImage::repaired(const std::filesystem::path& file) const {
  std::string what;
  if (not_finite > 0) what += std::to_string(not_finite) + " values are NaN or infinite";
  if (negative > 0) what += (what.empty() ? "" : ", ") + std::to_string(negative) + " values are negative";
  return what.empty() ? what : file.string() + ": " + what + "; read as 0";
}

Result<EnvironmentImage> environment_from_bytes(std::string_view bytes, const std::string& name) {
  try {
    Result<LatLongImage> image = bytes.starts_with(kExrMagic) ? read_exr(bytes, name)
                                 : is_radiance_hdr(bytes)
                                     ? read_radiance_hdr(bytes, name, kPixelLimit)
                                     : bad(name, "is neither an OpenEXR nor a Radiance HDR image");
    if (!image) return image.error();
    return repair(std::move(image).value());
  } catch (const std::bad_alloc&) {
    return Error{ErrorKind::failed, name + ": not enough memory for the image"};
  } catch (const std::exception& error) {
    return bad(name, std::string("damaged image: ") + first_line(error.what()));
  }
}

Result<EnvironmentImage> read_environment(const std::filesystem::path& file) {
  auto bytes = read_text_file(file, kFileLimit);
  if (!bytes) return bytes.error();
  if (bytes->empty()) return bad(file.string(), "is empty, expected an OpenEXR or Radiance HDR image");
  return environment_from_bytes(*bytes, file.string());
}

Result<std::string> environment_to_exr(const LatLongImage& image) {
  const auto fail = [](const std::string& why) {
    return Error{ErrorKind::failed, "cannot write: " + first_line(why)};
  };
  std::vector<unsigned char> bytes;
  OIIO::Filesystem::IOVecOutput memory(bytes);
  const auto output = OIIO::ImageOutput::create("openexr");
  if (!output) return fail(OIIO::geterror());
  OIIO::ImageSpec spec(image.width, image.height, 3, OIIO::TypeDesc::FLOAT);
  spec.attribute("compression", "zip");
  spec.attribute("textureformat", "LatLong Environment");  // OpenImageIO's name for the envmap attribute
  spec.attribute("oiio:updirection", "y");
  if (!output->set_ioproxy(&memory) || !output->open("memory.exr", spec) ||
      !output->write_image(OIIO::TypeDesc::FLOAT, image.pixels.data()) || !output->close())
    return fail(output->geterror());
  return std::string(bytes.begin(), bytes.end());
}

Status write_environment(const std::filesystem::path& file, const LatLongImage& image) {
  const auto bytes = environment_to_exr(image);
  if (!bytes) return Error{bytes.error().kind, file.string() + ": " + bytes.error().message};
  return write_file_atomically(file, *bytes);
}

}  // namespace lightwell
