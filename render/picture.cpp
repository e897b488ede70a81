// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/picture.h"

#include <png.h>

#include <string>

#include "interface/atomic_file.h"
#include "interface/exr_file.h"

namespace lightwell::render {
namespace {

// nullptr, or why not. Holds nothing that a jump out of libpng would leave behind.
const char* encode_png(const DisplayPicture& picture, png_bytepp rows, std::string& bytes) {
  static const char* const kNoMemory = "not enough memory";
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png != nullptr ? png_create_info_struct(png) : nullptr;
  if (info == nullptr || setjmp(png_jmpbuf(png)) != 0) {
    png_destroy_write_struct(&png, &info);
    return kNoMemory;
  }
  png_set_write_fn(
      png, &bytes,
      [](png_structp p, png_bytep data, std::size_t size) {
        static_cast<std::string*>(png_get_io_ptr(p))->append(reinterpret_cast<const char*>(data), size);
      },
      nullptr);
  png_set_compression_level(png, 1);  // one a frame: speed before size
  png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_FILTER_NONE);
  png_set_IHDR(png, info, static_cast<png_uint_32>(picture.width), static_cast<png_uint_32>(picture.height),
               8, PNG_COLOR_TYPE_RGB_ALPHA, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  constexpr double kRec709Exponent = 0.51;  // nearest power to BT.709's curve; PNG's gAMA takes no other form
  if (picture.display == Display::srgb)
    png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
  else
    png_set_gAMA(png, info, picture.display == Display::linear ? 1.0 : kRec709Exponent);
  png_write_info(png, info);
  png_write_image(png, rows);
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  return nullptr;
}

}  // namespace

// Both encode in memory, so that only a whole file ever reaches the disk.
Status write_exr(const std::filesystem::path& file, const RadiancePicture& picture) {
  const auto bytes =
      exr_from_floats(picture.width, picture.height, "RGBA", picture.rgba, ExrContent::picture);
  if (!bytes) return Error{bytes.error().kind, file.string() + ": " + bytes.error().message};
  return write_file_atomically(file, *bytes);
}

Status write_png(const std::filesystem::path& file, const DisplayPicture& picture) {
  const auto fail = [&](const char* why) {
    return Error{ErrorKind::failed, file.string() + ": cannot encode as PNG: " + why};
  };
  std::vector<png_bytep> rows;
  const auto stride = static_cast<std::size_t>(picture.width) * 4;
  for (int y = 0; y < picture.height; ++y)
    rows.push_back(const_cast<png_bytep>(picture.rgba.data() + static_cast<std::size_t>(y) * stride));
  std::string bytes;
  if (const char* why = encode_png(picture, rows.data(), bytes); why != nullptr) return fail(why);
  return write_file_atomically(file, bytes);
}

}  // namespace lightwell::render
