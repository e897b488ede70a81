// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "interface/environment_io.h"
#include "tests/support/child_process.h"
#include "tests/support/temporary_folder.h"

namespace lightwell::test {

// A folder of its own with a small sky in it, and the built command.
class CommandTest : public testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(write_environment(path("sky.exr"), sky(48, 24))); }

  [[nodiscard]] std::string path(const std::string& name) const { return (folder_.path() / name).string(); }

  static ProcessResult lightwell(const std::vector<std::string>& arguments) {
    return run_process(LIGHTWELL_BIN_DIR "/lightwell", arguments);
  }

  // A gradient above a darker ground, and a sun at azimuth `sun_deg`, 40° high.
  static LatLongImage sky(int width, int height, double sun_deg = 30) {
    LatLongImage image{width, height, {}};
    const Vec3d sun = direction_from_spherical({50 * kPi / 180, sun_deg * kPi / 180});
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const Vec3d d = direction_from_lat_long((x + 0.5) / width, (y + 0.5) / height);
        const auto up = static_cast<float>(std::max(0.0, d.y()));
        image.pixels.emplace_back(0.2f + up, 0.3f + 1.2f * up, 0.3f + 2 * up);
        if (d.dot(sun) > std::cos(8 * kPi / 180)) image.pixels.back() += Rgb(500, 450, 400);
      }
    return image;
  }

 private:
  TemporaryFolder folder_;
};

}  // namespace lightwell::test
