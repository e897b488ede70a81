// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfRgbaFile.h>
#include <OpenEXR/ImfStdIO.h>

#include <exception>

#include "bench/pictures/picture_error.h"
#include "interface/atomic_file.h"

namespace lightwell::pictures {

Status write_reference(const std::filesystem::path& file, const Reference& reference) {
  std::vector<Imf::Rgba> pixels;
  for (std::size_t i = 0; i < reference.radiance.size(); ++i) {
    const Rgb& c = reference.radiance[i];
    pixels.emplace_back(c[0], c[1], c[2], reference.mask[i]);
  }
  try {
    Imf::StdOSStream bytes;
    {
      Imf::Header header(reference.width, reference.height);
      header.compression() = Imf::PIZ_COMPRESSION;
      Imf::RgbaOutputFile out(bytes, header, Imf::WRITE_RGBA);
      out.setFrameBuffer(pixels.data(), 1, static_cast<std::size_t>(reference.width));
      out.writePixels(reference.height);
    }  // the line table is written at the end
    return write_file_atomically(file, bytes.str());
  } catch (const std::exception& e) {
    return Error{ErrorKind::failed, file.string() + ": " + e.what()};
  }
}

Result<Reference> read_reference(const std::filesystem::path& file) {
  try {
    Imf::RgbaInputFile in(file.c_str());
    const Imath::Box2i window = in.dataWindow();
    Reference reference;
    reference.width = window.max.x - window.min.x + 1;
    reference.height = window.max.y - window.min.y + 1;
    std::vector<Imf::Rgba> pixels(static_cast<std::size_t>(reference.width) *
                                  static_cast<std::size_t>(reference.height));
    in.setFrameBuffer(
        pixels.data() - window.min.x - static_cast<std::ptrdiff_t>(window.min.y) * reference.width, 1,
        static_cast<std::size_t>(reference.width));
    in.readPixels(window.min.y, window.max.y);
    for (const Imf::Rgba& p : pixels) {
      reference.radiance.emplace_back(p.r, p.g, p.b);
      reference.mask.push_back(p.a > 0.5f ? 1 : 0);
    }
    return reference;
  } catch (const std::exception& e) {
    return Error{ErrorKind::bad_input, e.what()};
  }
}

}  // namespace lightwell::pictures
