// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/jpeg.h"

#include <turbojpeg.h>

#include <memory>

namespace lightwell {
namespace {

struct Destroy {
  void operator()(void* coder) const { tjDestroy(coder); }
};
struct FreeBytes {
  void operator()(unsigned char* bytes) const { tjFree(bytes); }
};

}  // namespace

Result<std::string> encode_jpeg(int width, int height, std::span<const std::uint8_t> rgb, int quality) {
  verify_bug(width > 0 && height > 0 &&
                 rgb.size() == static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 3,
             "JPEG of another size than its pixels");
  const std::unique_ptr<void, Destroy> encoder(tjInitCompress());
  if (!encoder) return Error{ErrorKind::failed, std::string("cannot write JPEG: ") + tjGetErrorStr2(nullptr)};
  unsigned char* data = nullptr;
  unsigned long size = 0;
  constexpr int kTightRows = 0;
  const int rc = tjCompress2(encoder.get(), rgb.data(), width, kTightRows, height, TJPF_RGB, &data, &size,
                             TJSAMP_420, quality, 0);
  const std::unique_ptr<unsigned char, FreeBytes> bytes(data);
  if (rc != 0)
    return Error{ErrorKind::failed, std::string("cannot write JPEG: ") + tjGetErrorStr2(encoder.get())};
  return std::string(reinterpret_cast<const char*>(data), size);
}

Result<JpegPicture> decode_jpeg(std::string_view bytes, const std::string& name) {
  constexpr std::int64_t kMostPixels = std::int64_t{1} << 28;
  const std::unique_ptr<void, Destroy> decoder(tjInitDecompress());
  if (!decoder) return Error{ErrorKind::failed, std::string("cannot read JPEG: ") + tjGetErrorStr2(nullptr)};
  const auto bad = [&] {
    return Error{ErrorKind::bad_input, name + ": is no whole JPEG picture: cut, damaged, or of another kind"};
  };
  const auto* data = reinterpret_cast<const unsigned char*>(bytes.data());
  int width = 0, height = 0, subsampling = 0, colours = 0;
  if (tjDecompressHeader3(decoder.get(), data, bytes.size(), &width, &height, &subsampling, &colours) != 0)
    return bad();
  if (std::int64_t{width} * height > kMostPixels)
    return Error{ErrorKind::bad_input, name + ": " + std::to_string(width) + "x" + std::to_string(height) +
                                           " pixels: allowed 2^28"};
  JpegPicture picture{width, height, {}};
  picture.rgb.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 3);
  constexpr int kTightRows = 0;
  if (tjDecompress2(decoder.get(), data, bytes.size(), picture.rgb.data(), picture.width, kTightRows,
                    picture.height, TJPF_RGB, TJFLAG_ACCURATEDCT) != 0)
    return bad();
  return picture;
}

}  // namespace lightwell
