// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// Radiance HDR pictures: header and runs.
#include "interface/radiance_hdr.h"
#include "tests/fuzz/memory_file.h"

using namespace lightwell;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::int64_t kMostPixels = 1 << 16;
  bool converted = false;
  const auto image =
      read_radiance_hdr({reinterpret_cast<const char*>(data), size}, "a.hdr", kMostPixels, &converted);
  if (!image)
    fuzz::expect_one_line(image.error(), "a.hdr");
  else
    verify_bug(image->pixels.size() ==
                   static_cast<std::size_t>(image->width) * static_cast<std::size_t>(image->height),
               "another number of pixels");
  return 0;
}
