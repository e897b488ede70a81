// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/session_text.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "render/screenshot.h"
#include "tests/support/temporary_folder.h"

namespace lightwell::render {
namespace {

using namespace std::chrono_literals;
using Lines = std::vector<std::string>;

TEST(SessionText, TellsWhatIsKnownAndNothingElse) {
  ViewNumbers n;
  n.fps = 24.96;
  n.frame_ms = 40.04;
  n.lights = 72;
  n.shadow_maps = 70;
  n.shadow_size = 256;
  n.ev100 = -0.26;
  EXPECT_EQ(title_text(n), "Lightwell – 25.0 fps – 72 lights");
  EXPECT_EQ(overlay_text(n),
            (Lines{"25.0 fps, 40.0 ms a frame", "72 lights, 70 shadow maps of 256", "EV -0.3", "h: keys"}));
  n.light_age = 1300ms;
  n.predicted_error = 0.0123;
  n.ev_by_hand = true;
  EXPECT_EQ(title_text(n), "Lightwell – 25.0 fps – 72 lights – light 1.3 s old");
  EXPECT_EQ(overlay_text(n),
            (Lines{"25.0 fps, 40.0 ms a frame", "72 lights, 70 shadow maps of 256", "light 1.3 s old",
                   "predicted error of shadows 0.012", "EV -0.3 by hand", "h: keys"}));
  n.light_arrived = false;
  EXPECT_EQ(title_text(n), "Lightwell – 25.0 fps – 72 lights – waiting for light");
}

TEST(Screenshot, TakesTheFirstNumberOfWhichNothingIsThere) {
  const test::TemporaryFolder folder;
  const DisplayPicture display{1, 1, {1, 2, 3, 255}};
  const RadiancePicture radiance{1, 1, {1, 2, 3, 1}};
  EXPECT_EQ(write_screenshot(folder.path(), display, radiance).value(),
            "lightwell-0001.png and lightwell-0001.exr");
  std::ofstream(folder.path() / "lightwell-0002.exr") << "mine";
  EXPECT_EQ(write_screenshot(folder.path(), display, radiance).value(),
            "lightwell-0003.png and lightwell-0003.exr");
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "lightwell-0003.png"));
  EXPECT_EQ(std::filesystem::file_size(folder.path() / "lightwell-0002.exr"), 4u);
  EXPECT_EQ(write_screenshot(folder.path() / "missing", display, radiance).error().kind, ErrorKind::failed);
}

}  // namespace
}  // namespace lightwell::render
