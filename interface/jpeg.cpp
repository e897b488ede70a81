// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/jpeg.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <vector>

namespace lightwell {

Result<std::string> encode_jpeg(int width, int height, std::span<const std::uint8_t> rgb, int quality) {
  verify_bug(width > 0 && height > 0 &&
                 rgb.size() == static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 3,
             "JPEG of another size than its pixels");
  std::vector<unsigned char> bytes;
  OIIO::Filesystem::IOVecOutput memory(bytes);
  const auto output = OIIO::ImageOutput::create("jpeg");
  if (!output) return Error{ErrorKind::failed, "cannot write JPEG: " + OIIO::geterror()};
  OIIO::ImageSpec spec(width, height, 3, OIIO::TypeDesc::UINT8);
  spec.attribute("Compression", "jpeg:" + std::to_string(quality));
  if (!output->set_ioproxy(&memory) || !output->open("memory.jpg", spec) ||
      !output->write_image(OIIO::TypeDesc::UINT8, rgb.data()) || !output->close())
    return Error{ErrorKind::failed, "cannot write JPEG: " + output->geterror()};
  return std::string(bytes.begin(), bytes.end());
}

}  // namespace lightwell
