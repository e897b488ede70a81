// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/jpeg.h"

#include <turbojpeg.h>

#include <memory>

namespace lightwell {
namespace {

struct DestroyEncoder {
  void operator()(void* encoder) const { tjDestroy(encoder); }
};
struct FreeBytes {
  void operator()(unsigned char* bytes) const { tjFree(bytes); }
};

}  // namespace

Result<std::string> encode_jpeg(int width, int height, std::span<const std::uint8_t> rgb, int quality) {
  verify_bug(width > 0 && height > 0 &&
                 rgb.size() == static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 3,
             "JPEG of another size than its pixels");
  const std::unique_ptr<void, DestroyEncoder> encoder(tjInitCompress());
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

}  // namespace lightwell
