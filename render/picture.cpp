// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/picture.h"

#include <png.h>

#include <string>

#include "interface/atomic_file.h"
#include "interface/exr_file.h"

namespace lightwell::render {

// Both encode in memory, so that only a whole file ever reaches the disk.
Status write_exr(const std::filesystem::path& file, const RadiancePicture& picture) {
  const auto bytes =
      exr_from_floats(picture.width, picture.height, "RGBA", picture.rgba, ExrContent::picture);
  if (!bytes) return Error{bytes.error().kind, file.string() + ": " + bytes.error().message};
  return write_file_atomically(file, *bytes);
}

Status write_png(const std::filesystem::path& file, const DisplayPicture& picture) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(picture.width);
  image.height = static_cast<png_uint_32>(picture.height);
  image.format = PNG_FORMAT_RGBA;     // eight bits, sRGB, straight alpha
  image.flags = PNG_IMAGE_FLAG_FAST;  // one a frame: speed before size
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
  std::string bytes(size, '\0');
  constexpr int kEightBits = 0;
  constexpr png_int_32 kTightRows = 0;
  if (png_image_write_to_memory(&image, bytes.data(), &size, kEightBits, picture.rgba.data(), kTightRows,
                                nullptr) == 0)
    return Error{ErrorKind::failed, file.string() + ": cannot encode as PNG: " + image.message};
  bytes.resize(size);
  return write_file_atomically(file, bytes);
}

}  // namespace lightwell::render
