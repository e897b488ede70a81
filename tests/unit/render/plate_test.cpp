// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/plate.h"

#include <gtest/gtest.h>

#include <fstream>
#include <limits>

#include "interface/atomic_file.h"
#include "interface/exr_file.h"
#include "interface/jpeg.h"
#include "render/picture.h"
#include "tests/support/temporary_folder.h"

namespace lightwell::render {
namespace {

std::string png(const std::filesystem::path& folder, std::uint8_t red, std::uint8_t alpha = 255) {
  const auto file = folder / "plate.png";
  EXPECT_TRUE(write_png(file, {2, 1, {red, 0, 128, alpha, 255, 10, 11, 255}}));
  return file.string();
}

TEST(Plate, SrgbCodesBecomeLinear) {
  // IEC 61966-2-1's two branches and ends.
  EXPECT_EQ(linear_from_srgb(0), 0);
  EXPECT_FLOAT_EQ(linear_from_srgb(1), 1);
  EXPECT_FLOAT_EQ(linear_from_srgb(0.04f), 0.04f / 12.92f);
  EXPECT_NEAR(linear_from_srgb(0.5f), 0.21404114f, 1e-6f);  // float rounding
  const test::TemporaryFolder folder;
  const auto plate = read_plate(png(folder.path(), 64));
  ASSERT_TRUE(plate.ok()) << plate.error().message;
  EXPECT_TRUE(plate->display_referred);
  ASSERT_EQ(plate->pixels.size(), 2u);
  EXPECT_FLOAT_EQ(plate->pixels[0][0], linear_from_srgb(64.0f / 255));
  EXPECT_FLOAT_EQ(plate->pixels[0][2], linear_from_srgb(128.0f / 255));
  EXPECT_FLOAT_EQ(plate->pixels[1][0], 1);
}

TEST(Plate, TransparentPixelsAreBlack) {
  const test::TemporaryFolder folder;
  const auto plate = read_plate(png(folder.path(), 200, 0));
  ASSERT_TRUE(plate.ok());
  EXPECT_EQ(plate->pixels[0].maxCoeff(), 0);
}

TEST(Plate, JpegIsReadAsSrgb) {
  const auto bytes = encode_jpeg(16, 16, std::vector<std::uint8_t>(std::size_t{16} * 16 * 3, 128), 95);
  ASSERT_TRUE(bytes.ok());
  const auto plate = plate_from_bytes(*bytes, "grey.jpg");
  ASSERT_TRUE(plate.ok()) << plate.error().message;
  // A flat grey survives the transform to within a code.
  EXPECT_NEAR(plate->pixels[40][1], linear_from_srgb(128.0f / 255), 0.005f);
}

TEST(Plate, ExrStaysLinearAndIsRepairedWithAWord) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const auto bytes =
      exr_from_floats(2, 1, "RGB", std::vector<float>{5000, nan, 2, -1, 3, 4}, ExrContent::picture);
  ASSERT_TRUE(bytes.ok());
  const auto plate = plate_from_bytes(*bytes, "a.exr");
  ASSERT_TRUE(plate.ok()) << plate.error().message;
  EXPECT_FALSE(plate->display_referred);
  EXPECT_EQ(plate->pixels[0][0], 5000);
  EXPECT_EQ(plate->pixels[0][1], 0);
  EXPECT_EQ(plate->pixels[1][0], 0);
  EXPECT_EQ(plate->pixels[1][2], 4);
  EXPECT_EQ(plate->remark, "a.exr: 2 values are NaN, infinite or negative; read as 0");
}

TEST(Plate, DamagedAndForeignFilesAreNamed) {
  const test::TemporaryFolder folder;
  const auto whole = read_text_file(png(folder.path(), 1));
  ASSERT_TRUE(whole.ok());
  const auto jpeg = encode_jpeg(64, 64, std::vector<std::uint8_t>(std::size_t{64} * 64 * 3, 7));
  ASSERT_TRUE(jpeg.ok());
  for (const std::string& bytes : {std::string(), std::string("hello"), whole->substr(0, 20),
                                   whole->substr(0, whole->size() - 20), jpeg->substr(0, jpeg->size() / 2)}) {
    const auto plate = plate_from_bytes(bytes, "x.png");
    ASSERT_FALSE(plate.ok());
    EXPECT_EQ(plate.error().kind, ErrorKind::bad_input);
    EXPECT_TRUE(plate.error().message.starts_with("x.png")) << plate.error().message;
  }
}

TEST(PlateSource, FramesOfASequenceFollowOneAnotherAndTheLastStays) {
  const test::TemporaryFolder folder;
  for (int i = 3; i < 5; ++i)
    ASSERT_TRUE(write_png(folder.path() / ("p" + std::to_string(i) + ".png"),
                          {1, 1, {static_cast<std::uint8_t>(i), 0, 0, 255}}));
  auto source = PlateSource::open((folder.path() / "p%d.png").string());
  ASSERT_TRUE(source.ok()) << source.error().message;
  EXPECT_FLOAT_EQ(source->plate().pixels[0][0], linear_from_srgb(3.0f / 255));
  EXPECT_FALSE(*source->update(0));
  EXPECT_TRUE(*source->update(1));
  EXPECT_FLOAT_EQ(source->plate().pixels[0][0], linear_from_srgb(4.0f / 255));
  EXPECT_FALSE(*source->update(7));
  EXPECT_FALSE(PlateSource::open((folder.path() / "none.png").string()).ok());
}

}  // namespace
}  // namespace lightwell::render
