// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/overlay.h"

#include <gtest/gtest.h>

#include "tests/unit/render/render_fixture.h"

namespace lightwell {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)

constexpr int kWidth = 320;
constexpr int kHeight = 240;

class Overlays : public Rendering {
 protected:
  // What the overlay leaves of a black picture, row 0 at the bottom.
  static std::vector<std::uint8_t> drawn(const render::Overlay::Content& content) {
    auto overlay = render::Overlay::create();
    EXPECT_TRUE(overlay.ok()) << overlay.error().message;
    const auto texture = render::gl::make_texture(GL_RGBA8, kWidth, kHeight);
    const auto framebuffer = render::gl::make_framebuffer({texture.id()}, 0);
    EXPECT_TRUE(framebuffer.ok());
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer->id());
    glClearColor(0, 0, 0, 1);
    glClear(GL_COLOR_BUFFER_BIT);
    overlay->draw(content, kWidth, kHeight);
    std::vector<std::uint8_t> rgba(std::size_t{kWidth} * kHeight * 4);
    glReadPixels(0, 0, kWidth, kHeight, GL_RGBA, GL_UNSIGNED_BYTE, rgba.data());
    EXPECT_EQ(glGetError(), GLenum{GL_NO_ERROR});
    return rgba;
  }
  // Pixels of text, in a part of the picture; y from the top.
  static int bright(const std::vector<std::uint8_t>& rgba, int x0, int y0, int x1, int y1) {
    int count = 0;
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x)
        if (rgba[static_cast<std::size_t>(((kHeight - 1 - y) * kWidth + x) * 4)] > 200) ++count;
    return count;
  }
};

TEST_F(Overlays, TextStandsInItsPlaceFromTheFirstPictureOn) {
  render::Overlay::Content numbers;
  numbers.numbers = {"72 lights", "EV 3.0"};
  auto picture = drawn(numbers);
  EXPECT_GT(bright(picture, 0, 0, 120, 60), 30);
  EXPECT_EQ(bright(picture, 160, 0, kWidth, kHeight), 0);
  render::Overlay::Content help;
  help.help = {"h    this help"};
  picture = drawn(help);
  EXPECT_GT(bright(picture, 80, 90, 240, 150), 30);
  EXPECT_EQ(bright(picture, 0, 0, kWidth, 80), 0);
}

TEST_F(Overlays, NothingToShowLeavesThePictureAlone) {
  const auto picture = drawn({});
  EXPECT_EQ(bright(picture, 0, 0, kWidth, kHeight), 0);
}

TEST_F(Overlays, AMarkerHasItsColourAtItsPlace) {
  render::Overlay::Content content;
  content.markers.push_back({{40, 30}, 8, Rgb(1, 0.5f, 0), true});
  const auto picture = drawn(content);
  const std::size_t at = ((kHeight - 1 - 30) * kWidth + 40) * 4;
  // Nine tenths opaque over black.
  EXPECT_NEAR(picture[at], 230, 3);
  EXPECT_NEAR(picture[at + 1], 115, 3);
  EXPECT_EQ(picture[at + 2], 0);
  EXPECT_EQ(bright(picture, 60, 60, kWidth, kHeight), 0);
}

TEST_F(Overlays, MoreMarkersThanSixteenBitsOfVerticesAreAllDrawn) {
  render::Overlay::Content content;
  for (int i = 0; i < 6000; ++i) content.markers.push_back({{10, 10}, 4, Rgb(0, 1, 0), true});
  content.markers.push_back({{300, 200}, 8, Rgb(1, 0, 0), true});
  const auto picture = drawn(content);
  EXPECT_GT(picture[((kHeight - 1 - 200) * kWidth + 300) * 4], 200);
}

}  // namespace
}  // namespace lightwell
