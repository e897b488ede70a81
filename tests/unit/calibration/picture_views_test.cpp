// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/detection/picture_views.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "interface/atomic_file.h"
#include "interface/jpeg.h"
#include "tests/support/temporary_folder.h"

namespace lightwell::calibration {
namespace {

using testing::HasSubstr;

constexpr int kWidth = 320, kHeight = 240;

// What a picture shows at a place, 0 to 1.
using Scene = std::function<double(double x, double y)>;

// Mean of 4 x 4 samples a pixel.
GreyPicture photographed(const Scene& scene, double contrast = 1) {
  GreyPicture out{kWidth, kHeight, {}};
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      double sum = 0;
      for (int s = 0; s < 16; ++s)
        sum += scene(x + (s % 4 + 0.5) / 4 - 0.5, y + (s / 4 + 0.5) / 4 - 0.5) / 16;
      out.pixels.push_back(static_cast<std::uint8_t>(std::lround(20 + 200 * contrast * sum)));
    }
  return out;
}

// Place on a board of 6 x 5 inner corners 1 apart, seen at a slant.
struct Slant {
  double far = 0.03;
  [[nodiscard]] Vec2d place(double x, double y) const {
    const double a = (x - 70) / (30 - far * (x - 70));
    return {a, ((y - 50) * (1 + far * a) - 4 * a) / 30};
  }
};

Scene board_scene(const Slant& slant) {
  return [slant](double x, double y) {
    const Vec2d p = slant.place(x, y);
    if (p.x() < -1 || p.x() > 6 || p.y() < -1 || p.y() > 5) return 1.0;
    return (static_cast<int>(std::floor(p.x())) + static_cast<int>(std::floor(p.y()))) % 2 == 0 ? 0.0 : 1.0;
  };
}

// A sharp photo of something else: a dark disc and a wall.
double street(double x, double y) {
  if (std::hypot(x - 100, y - 120) < 60) return 0;
  return x > 200 ? 0.1 : 0.8;
}

// Mean over a square of 2 r + 1, twice.
GreyPicture blurred(GreyPicture picture, int r) {
  for (int pass = 0; pass < 2; ++pass) {
    const GreyPicture from = picture;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        int sum = 0, count = 0;
        for (int v = std::max(0, y - r); v <= std::min(kHeight - 1, y + r); ++v)
          for (int u = std::max(0, x - r); u <= std::min(kWidth - 1, x + r); ++u, ++count)
            sum += from.pixels[static_cast<std::size_t>(v * kWidth + u)];
        picture.pixels[static_cast<std::size_t>(y * kWidth + x)] = static_cast<std::uint8_t>(sum / count);
      }
  }
  return picture;
}

Board board_of(const std::string& text) {
  return board_from_text(text).value();
}

class PictureViewsOf : public testing::Test {
 protected:
  std::string file(const std::string& name, const GreyPicture& picture) const {
    std::vector<std::uint8_t> rgb;
    for (const std::uint8_t v : picture.pixels) rgb.insert(rgb.end(), 3, v);
    const std::string path = (folder_.path() / name).string();
    EXPECT_TRUE(write_file_atomically(path, encode_jpeg(kWidth, kHeight, rgb, 95).value()));
    return path;
  }
  static Result<PictureViews> views(const std::vector<std::string>& files, const std::string& board) {
    return views_of_pictures(files, board_of(board), [](std::size_t) {});
  }

 private:
  test::TemporaryFolder folder_;
};

TEST(DetectBoard, OnlyASharpAndBrightPictureIsOfNoBoard) {
  const Board board = board_of("6x5:10");
  const GreyPicture sharp = photographed(board_scene({}));
  EXPECT_TRUE(detect_board(photographed(street), board).of_no_board);
  for (const GreyPicture& picture :
       {blurred(sharp, 14), photographed(street, 0.1), photographed([](double, double) { return 0.0; }),
        blurred(photographed(street), 14)}) {
    const Detection found = detect_board(picture, board);
    EXPECT_TRUE(found.points.empty());
    EXPECT_FALSE(found.of_no_board);
    EXPECT_NE(found.reason, "");
  }
}

// What has edges, corners or repetition, but no checks.
struct Texture {
  std::string what;
  Scene scene;
};

// One of two at every place of a raster, the same in every run.
double coin(int x, int y) {
  std::minstd_rand random(static_cast<unsigned>(1000 * (y + 10) + x + 10));
  random.discard(3);
  return (random() >> 16) % 2 == 0 ? 0 : 1;
}

std::vector<Texture> textures() {
  std::vector<Texture> out;
  for (const double period : {3.0, 6.0, 8.0, 24.0})
    out.push_back({"slanted stripes " + std::to_string(period), [=](double x, double y) {
                     return std::fmod(0.94 * x + 0.34 * y + 100 * period, period) < period / 2 ? 0 : 1;
                   }});
  for (const double height : {8.0, 30.0})
    out.push_back({"bricks " + std::to_string(height), [=](double x, double y) {
                     const double row = std::floor(y / height);
                     const double along = std::fmod(x + 10 * height + std::fmod(row, 2) * height, 2 * height);
                     return along < 0.15 * height || y - row * height < 0.15 * height ? 1 : 0.2;
                   }});
  for (const double pitch : {10.0, 30.0}) {
    out.push_back({"dots " + std::to_string(pitch), [=](double x, double y) {
                     const double u = std::remainder(x, pitch), v = std::remainder(y, pitch);
                     return std::hypot(u, v) < 0.3 * pitch ? 0 : 1;
                   }});
  }
  for (const double pitch : {20.0, 45.0})
    out.push_back({"tiles " + std::to_string(pitch), [=](double x, double y) {
                     const double u = std::fmod(x + pitch, pitch), v = std::fmod(y + pitch, pitch);
                     return std::min(u, v) < 0.2 * pitch ? 0 : 1;
                   }});
  for (const double pitch : {20.0, 30.0, 45.0})
    for (const double joint : {2.0, 3.0})
      for (const bool turned : {false, true})
        out.push_back({"joints of " + std::to_string(joint) + " every " + std::to_string(pitch),
                       [=](double x, double y) {
                         const double c = turned ? 0.97 : 1, n = turned ? 0.24 : 0;
                         const double u = std::fmod(c * x + n * y + 400 * pitch, pitch),
                                      v = std::fmod(-n * x + c * y + 400 * pitch, pitch);
                         return std::min(u, v) < joint ? 0.9 : 0.3;
                       }});
  // Checks of every colour but in no order: corners of four checks now and then, few in a row.
  out.push_back({"a random mosaic", [](double x, double y) {
                   return coin(static_cast<int>(std::floor(x / 8)), static_cast<int>(std::floor(y / 8)));
                 }});
  // Letters are strokes on a raster of 5 x 7, with spaces between them and lines between their rows.
  out.push_back({"text", [](double x, double y) {
                   const int u = static_cast<int>(std::floor(x / 2)), v = static_cast<int>(std::floor(y / 2));
                   return u % 6 == 5 || v % 11 > 6 ? 1 : coin(u, v);
                 }});
  out.push_back({"noise", [](double x, double y) {
                   return coin(static_cast<int>(std::floor(x)), static_cast<int>(std::floor(y)));
                 }});
  return out;
}

TEST(DetectBoard, TexturesAreOfNoBoard) {
  for (const Texture& texture : textures()) {
    const GreyPicture picture = photographed(texture.scene);
    for (const char* board : {"6x8:10", "3x3:10"}) {
      const Detection found = detect_board(picture, board_of(board));
      EXPECT_TRUE(found.points.empty()) << texture.what << " as " << board;
      EXPECT_TRUE(found.of_no_board) << texture.what << ": " << found.reason << " as " << board;
    }
  }
}

TEST(DetectBoard, AHalfHiddenBoardIsABoard) {
  const Scene board = board_scene({});
  const auto hidden = [&](double x, double y) { return x > 150 ? 0.5 : board(x, y); };
  const Detection found = detect_board(photographed(hidden), board_of("6x5:10"));
  EXPECT_TRUE(found.points.empty());
  EXPECT_FALSE(found.of_no_board);
  EXPECT_THAT(found.reason, HasSubstr("no whole 6x5 chessboard"));
}

// What may hide some of a board: a bare hand, a sleeve of coarse cloth.
std::vector<Texture> hands() {
  return {{"skin", [](double, double) { return 0.5; }},
          {"cloth", [](double x, double y) {
             return 0.2 +
                    0.6 * coin(static_cast<int>(std::floor(x / 6)), static_cast<int>(std::floor(y / 6)));
           }}};
}

// A hand over some corners hides neither the others nor where they are on the board. Lines along the raster are off by up
// to half a sample, 1/8 px on either axis, and refinement adds 0.05 px.
TEST(DetectBoard, CornersBesideAHandAreUsed) {
  const Slant slant;
  const Scene board = board_scene(slant);
  for (const Texture& hand_of : hands())
    for (const Vec2d& hand : {Vec2d(0.4, 0.3), Vec2d(2.5, 2.4)}) {
      const auto covers = [&](const Vec2d& place, double reach) { return (place - hand).norm() < reach; };
      const auto scene = [&](double x, double y) {
        return covers(slant.place(x, y), 1.1) ? hand_of.scene(x, y) : board(x, y);
      };
      const Detection found = detect_board(photographed(scene), board_of("6x5:10"));
      std::size_t visible = 0;  // further from the hand than a corner's window
      for (int c = 0; c < 6; ++c)
        for (int r = 0; r < 5; ++r) visible += !covers(Vec2d(c, r), 1.5);
      const std::string what = hand_of.what + " at " + std::to_string(hand.x()) + ": ";
      EXPECT_GE(found.points.size(), visible) << what << found.reason;
      EXPECT_FALSE(found.board_is_larger) << what;
      for (const Correspondence& point : found.points) {
        // The first corner has light in the quadrant of growing columns and rows: it is the scene's last.
        const Vec2d place(5 - point.target_mm.x() / 10, 4 - point.target_mm.y() / 10);
        const double shrink = 1 + slant.far * place.x();
        const Vec2d truth(70 + 30 * place.x() / shrink, 50 + (30 * place.y() + 4 * place.x()) / shrink);
        EXPECT_FALSE(covers(place, 1.1)) << what << place.transpose();
        EXPECT_LT((point.pixel - truth).norm(), 0.23) << what << place.transpose();
      }
    }
}

// A board turned in the picture has rows that follow its columns all the same: a mirrored one would put the camera
// behind it. Its corners are within 0.1 px: 0.05 px is what eight bits and 16 samples a pixel leave.
TEST(DetectBoard, CornersAreInTheirPlacesHoweverTheBoardIsTurned) {
  for (int turn = 0; turn < 4; ++turn) {
    const double angle = 0.2 + turn * kPi / 2, c = std::cos(angle), s = std::sin(angle);
    const auto scene = [&](double x, double y) {
      const Vec2d p((c * (x - 160) + s * (y - 120)) / 24 + 2.5, (-s * (x - 160) + c * (y - 120)) / 24 + 2);
      if (p.x() < -1 || p.x() > 6 || p.y() < -1 || p.y() > 5) return 1.0;
      return (static_cast<int>(std::floor(p.x())) + static_cast<int>(std::floor(p.y()))) % 2 == 0 ? 0.0 : 1.0;
    };
    const Detection found = detect_board(photographed(scene), board_of("6x5:24"));
    ASSERT_EQ(found.points.size(), 30u) << turn;
    // Six corners and five tell the board's ends apart, so the target's place is the scene's or its half turn.
    const bool half_turn = (found.points[5].pixel - found.points[0].pixel).dot(Vec2d(c, s)) < 0;
    for (const Correspondence& point : found.points) {
      Vec2d board(point.target_mm.x() - 60, point.target_mm.y() - 48);
      if (half_turn) board = -board;
      const Vec2d truth(160 + c * board.x() - s * board.y(), 120 + s * board.x() + c * board.y());
      EXPECT_LT((point.pixel - truth).norm(), 0.1) << turn;
    }
    EXPECT_FALSE(found.board_is_larger);
  }
}

TEST(DetectBoard, APictureWithoutAMarkerIsOneWithoutPoints) {
  for (const char* board : {"5x7:40:charuco", "6x6:71.5:aprilgrid"})
    for (const GreyPicture& picture :
         {photographed(street), photographed([](double, double) { return 0.0; })}) {
      const Detection found = detect_board(picture, board_of(board));
      EXPECT_TRUE(found.points.empty());
      EXPECT_FALSE(found.of_no_board);
      EXPECT_THAT(found.reason, HasSubstr("no marker"));
    }
}

TEST_F(PictureViewsOf, ABlurredPictureIsAViewWithoutPointsAndAReason) {
  const GreyPicture sharp = photographed(board_scene({}));
  const auto found = views({file("a.jpg", sharp), file("blurred.jpg", blurred(sharp, 14)),
                            file("b.jpg", photographed(board_scene({0.05})))},
                           "6x5:10");
  ASSERT_TRUE(found.ok()) << found.error().message;
  ASSERT_EQ(found->target_views.views.size(), 3u);
  EXPECT_EQ(found->target_views.views[0].points.size(), 30u);
  EXPECT_TRUE(found->target_views.views[1].points.empty());
  EXPECT_NE(found->reasons[1], "");
  EXPECT_EQ(found->target_views.views[2].points.size(), 30u);
  EXPECT_EQ(found->reasons[0] + found->reasons[2], "");
}

TEST_F(PictureViewsOf, APhotoOfSomethingElseIsNamed) {
  const auto found = views(
      {file("a.jpg", photographed(board_scene({}))), file("street.jpg", photographed(street))}, "6x5:10");
  ASSERT_FALSE(found.ok());
  EXPECT_EQ(found.error().kind, ErrorKind::bad_input);
  EXPECT_THAT(found.error().message, HasSubstr("street.jpg: shows no chessboard"));
}

TEST_F(PictureViewsOf, NoMarkerInAnyPictureIsRefused) {
  const auto found = views({file("a.jpg", photographed(street))}, "5x7:40:charuco");
  ASSERT_FALSE(found.ok());
  EXPECT_EQ(found.error().kind, ErrorKind::bad_input);
  EXPECT_THAT(found.error().message, HasSubstr("a.jpg"));
}

}  // namespace
}  // namespace lightwell::calibration
