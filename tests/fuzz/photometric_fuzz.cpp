// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// Files of photometric data, LM-63 and EULUMDAT: what reads has a flux and an intensity everywhere.
#include <cmath>
#include <string_view>

#include "interface/photometric_file.h"
#include "tests/fuzz/memory_file.h"

using namespace lightwell;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  for (const auto& file : {parse_ies(text, "lamp"), parse_eulumdat(text, "lamp")}) {
    if (!file) {
      fuzz::expect_one_line(file.error(), "lamp");
      continue;
    }
    verify_bug(luminous_flux(file->lamp) >= 0, "flux of a lamp");
    for (const Vec3d& d : {Vec3d(0, 0, -1), Vec3d(0.6, -0.8, 0), Vec3d(0, 0, 1)})
      verify_bug(intensity(file->lamp, d) >= 0, "intensity of a lamp");
  }
  return 0;
}
