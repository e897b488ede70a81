// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/screenshot.h"

#include <cstdio>
#include <string>

namespace lightwell::render {

Result<std::string> write_screenshot(const std::filesystem::path& folder, const DisplayPicture& display,
                                     const RadiancePicture& radiance) {
  for (int number = 1; number < 10000; ++number) {
    char name[32];
    std::snprintf(name, sizeof name, "lightwell-%04d", number);
    const std::string png = std::string(name) + ".png";
    const std::string exr = std::string(name) + ".exr";
    std::error_code ignored;
    if (std::filesystem::exists(folder / png, ignored) || std::filesystem::exists(folder / exr, ignored))
      continue;
    if (Status s = write_png(folder / png, display); !s) return s.error();
    if (Status s = write_exr(folder / exr, radiance); !s) return s.error();
    return png + " and " + exr;
  }
  return Error{ErrorKind::failed, "no screenshot: lightwell-0001 to lightwell-9999 are all there"};
}

}  // namespace lightwell::render
