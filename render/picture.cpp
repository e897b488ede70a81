// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/picture.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <string_view>

#include "interface/atomic_file.h"

namespace lightwell::render {
namespace {

// Encodes in memory, so that only a whole file ever reaches the disk.
Status write(const std::filesystem::path& file, const char* format, const OIIO::ImageSpec& spec,
             const void* pixels) {
  std::vector<unsigned char> bytes;
  OIIO::Filesystem::IOVecOutput memory(bytes);
  const auto output = OIIO::ImageOutput::create(format, &memory);
  const auto failure = [&] {
    return Error{ErrorKind::failed,
                 file.string() + ": cannot encode: " + (output ? output->geterror() : OIIO::geterror())};
  };
  if (!output || !output->open(file.string(), spec) || !output->write_image(spec.format, pixels) ||
      !output->close())
    return failure();
  return write_file_atomically(file, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

}  // namespace

Status write_exr(const std::filesystem::path& file, const RadiancePicture& picture) {
  OIIO::ImageSpec spec(picture.width, picture.height, 4, OIIO::TypeDesc::FLOAT);
  spec.channelnames = {"R", "G", "B", "A"};
  spec.alpha_channel = 3;
  spec.attribute("compression", "zip");
  const float rec709[8] = {0.64f, 0.33f, 0.30f, 0.60f, 0.15f, 0.06f, 0.3127f, 0.3290f};
  spec.attribute("chromaticities", OIIO::TypeDesc("float[8]"), rec709);
  return write(file, "openexr", spec, picture.rgba.data());
}

Status write_png(const std::filesystem::path& file, const DisplayPicture& picture) {
  OIIO::ImageSpec spec(picture.width, picture.height, 4, OIIO::TypeDesc::UINT8);
  spec.channelnames = {"R", "G", "B", "A"};
  spec.alpha_channel = 3;
  spec.attribute("oiio:ColorSpace", "sRGB");
  spec.attribute("oiio:UnassociatedAlpha", 1);
  return write(file, "png", spec, picture.rgba.data());
}

}  // namespace lightwell::render
