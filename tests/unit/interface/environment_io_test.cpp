// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/environment_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "interface/atomic_file.h"
#include "tests/support/temporary_folder.h"

namespace lightwell {
namespace {

using test::TemporaryFolder;
using testing::HasSubstr;

const std::filesystem::path kData = LIGHTWELL_TEST_DATA;

LatLongImage random_image(int width, int height) {
  LatLongImage image{width, height, {}};
  std::mt19937 generator(5);
  std::uniform_real_distribution<float> exponent(-4.0f, 4.0f);
  for (int i = 0; i < width * height; ++i) {
    Rgb pixel;
    for (int c = 0; c < 3; ++c) pixel[c] = std::pow(10.0f, exponent(generator));
    image.pixels.push_back(pixel);
  }
  return image;
}

bool same(const LatLongImage& a, const LatLongImage& b) {
  if (a.width != b.width || a.height != b.height) return false;
  for (std::size_t i = 0; i < a.pixels.size(); ++i)
    if ((a.pixels[i] != b.pixels[i]).any()) return false;
  return true;
}

std::string hdr(const std::string& resolution, const std::string& data) {
  return "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n" + resolution + "\n" + data;
}

void expect_bad(const Result<EnvironmentImage>& image, const std::string& names) {
  ASSERT_FALSE(image);
  EXPECT_EQ(image.error().kind, ErrorKind::bad_input);
  EXPECT_THAT(image.error().message, HasSubstr(names));
  EXPECT_EQ(image.error().message.find('\n'), std::string::npos);
}

TEST(EnvironmentIo, WrittenImageComesBackBitForBit) {
  const TemporaryFolder folder;
  for (const auto& [w, h] : {std::pair{1, 1}, {7, 3}, {64, 32}, {1, 130}}) {
    const LatLongImage image = random_image(w, h);
    ASSERT_TRUE(write_environment(folder.path() / "a.exr", image));
    const auto back = read_environment(folder.path() / "a.exr");
    ASSERT_TRUE(back) << back.error().message;
    EXPECT_TRUE(same(back->image, image));
    EXPECT_EQ(back->not_finite + back->negative, 0u);
  }
}

TEST(EnvironmentIo, NotFiniteAndNegativeValuesAreCountedAndReadAsZero) {
  const TemporaryFolder folder;
  LatLongImage image{2, 2, std::vector<Rgb>(4, Rgb::Constant(2))};
  image.pixels[0] = {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), 1};
  image.pixels[1] = {-1, -std::numeric_limits<float>::infinity(), 3};
  ASSERT_TRUE(write_environment(folder.path() / "bad.exr", image));
  const auto back = read_environment(folder.path() / "bad.exr").value();
  EXPECT_EQ(back.not_finite, 3u);
  EXPECT_EQ(back.negative, 1u);
  EXPECT_TRUE((back.image.pixels[0] == Rgb(0, 0, 1)).all());
  EXPECT_TRUE((back.image.pixels[1] == Rgb(0, 0, 3)).all());
  EXPECT_EQ(back.remark("bad.exr"),
            "bad.exr: 3 values are NaN or infinite, 1 values are negative; read as 0");
}

TEST(EnvironmentIo, ASizeThatIsNotTwoToOneIsSaidInTheSameLine) {
  const auto remark = [](int width, int height, std::uint64_t negative = 0) {
    EnvironmentImage environment;
    environment.image = random_image(width, height);
    environment.negative = negative;
    return environment.remark("a.exr");
  };
  for (const auto& [w, h] : {std::pair{1, 1}, {2, 1}, {3, 1}, {33, 16}, {33, 17}, {1000, 500}, {1000, 490}})
    EXPECT_EQ(remark(w, h), "") << w << " " << h;
  for (const auto& [w, h] : {std::pair{16, 16}, {400, 300}, {300, 400}, {600, 100}, {7, 2}})
    EXPECT_EQ(remark(w, h), "a.exr: " + std::to_string(w) + "x" + std::to_string(h) +
                                " is not 2:1; read as a latitude–longitude image all the same");
  EXPECT_EQ(
      remark(16, 16, 4),
      "a.exr: 16x16 is not 2:1; read as a latitude–longitude image all the same; 4 values are negative; "
      "read as 0");
}

TEST(EnvironmentIo, AConversionIsSaidInTheSameLine) {
  EnvironmentImage environment;
  environment.image = random_image(2, 1);
  environment.converted = true;
  EXPECT_EQ(environment.remark("a.exr"), "a.exr: converted from the file's chromaticities to Rec. 709");
  environment.negative = 2;
  EXPECT_EQ(environment.remark("a.exr"),
            "a.exr: converted from the file's chromaticities to Rec. 709; 2 values are negative; read as 0");
}

TEST(EnvironmentIo, WritingIntoAMissingFolderFails) {
  const Status status = write_environment("/nonexistent/a.exr", random_image(2, 1));
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().kind, ErrorKind::failed);
}

TEST(EnvironmentIo, MissingDirectoryEmptyAndOtherFilesAreBadInput) {
  const TemporaryFolder folder;
  expect_bad(read_environment(folder.path() / "absent.exr"), "absent.exr");
  expect_bad(read_environment(folder.path()), "directory");
  ASSERT_TRUE(write_file_atomically(folder.path() / "empty.exr", ""));
  expect_bad(read_environment(folder.path() / "empty.exr"), "empty");
  ASSERT_TRUE(write_file_atomically(folder.path() / "text.hdr", "hello"));
  expect_bad(read_environment(folder.path() / "text.hdr"), "neither");
}

TEST(EnvironmentIo, AnyTruncationOfAnExrIsBadInput) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_environment(folder.path() / "a.exr", random_image(64, 40)));
  const std::string bytes = read_text_file(folder.path() / "a.exr").value();
  for (std::size_t size = 1; size < bytes.size(); size += 97)
    expect_bad(environment_from_bytes(std::string_view(bytes).substr(0, size), "cut.exr"), "cut.exr");
  expect_bad(environment_from_bytes(std::string_view(bytes).substr(0, bytes.size() - 1), "cut.exr"),
             "cut.exr");
}

TEST(RadianceHdr, ReadsFlatAndRunLengthCodedRows) {
  // (128, 64, 32) · 2^(129 − 136) = (1, 0.5, 0.25)
  const std::string pixel = "\x80\x40\x20\x81";
  const auto flat =
      environment_from_bytes(hdr("-Y 1 +X 3", pixel + pixel + std::string(4, '\0')), "f").value();
  EXPECT_TRUE((flat.image.at(1, 0) == Rgb(1, 0.5f, 0.25f)).all());
  EXPECT_TRUE((flat.image.at(2, 0) == Rgb::Zero()).all());

  const std::string old_run = hdr("-Y 1 +X 5", pixel + std::string("\x01\x01\x01\x04", 4));
  const auto old = environment_from_bytes(old_run, "o").value();
  EXPECT_TRUE((old.image.at(4, 0) == Rgb(1, 0.5f, 0.25f)).all());

  // nine pixels wide: a run of 9, then 1 + 8 literal, and so on
  const std::string coded = std::string("\x02\x02\x00\x09", 4) + "\x89\x80" + "\x81\x40\x88\x40" +
                            "\x89\x20" + std::string("\x03\x81\x81\x81\x86\x81");
  const auto rle = environment_from_bytes(hdr("-Y 1 +X 9", coded), "c").value();
  for (int x = 0; x < 9; ++x) EXPECT_TRUE((rle.image.at(x, 0) == Rgb(1, 0.5f, 0.25f)).all()) << x;
}

TEST(RadianceHdr, ExposureAndColourCorrectionAreDividedOut) {
  // (128, 64, 32) · 2^(129 − 136) = (1, 0.5, 0.25); powers of two divide exactly
  const auto first_pixel = [](const std::string& lines) {
    const auto read = environment_from_bytes(
        "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n" + lines + "\n-Y 1 +X 1\n\x80\x40\x20\x81", "f.hdr");
    return read ? read->image.at(0, 0) : Rgb::Constant(-1);
  };
  EXPECT_TRUE((first_pixel("EXPOSURE=1\n") == Rgb(1, 0.5f, 0.25f)).all());
  EXPECT_TRUE((first_pixel("EXPOSURE=4\n") == Rgb(0.25f, 0.125f, 0.0625f)).all());
  EXPECT_TRUE((first_pixel("EXPOSURE=  4.0 \nEXPOSURE=+1.25e-1\n") == Rgb(2, 1, 0.5f)).all());
  EXPECT_TRUE((first_pixel("COLORCORR= 1 2 0.5\n") == Rgb(1, 0.25f, 0.5f)).all());
  EXPECT_TRUE(
      (first_pixel("COLORCORR=1 2 .5\nEXPOSURE=2\nCOLORCORR=2 1 1\n") == Rgb(0.25f, 0.125f, 0.25f)).all());
}

TEST(RadianceHdr, AnExposureThatIsNoMultiplierIsBadInput) {
  for (const char* line :
       {"EXPOSURE=0", "EXPOSURE=-1", "EXPOSURE=nan", "EXPOSURE=inf", "EXPOSURE=", "EXPOSURE=a",
        "EXPOSURE=1 2", "EXPOSURE=1e999", "COLORCORR=1 2", "COLORCORR=1 0 1", "COLORCORR=1 1 1 1"})
    expect_bad(environment_from_bytes("#?RADIANCE\n" + std::string(line) + "\n\n-Y 1 +X 1\nabcd", "f.hdr"),
               line);
  expect_bad(environment_from_bytes("#?RADIANCE\nEXPOSURE=1e300\nEXPOSURE=1e300\n\n-Y 1 +X 1\nabcd", "f.hdr"),
             "EXPOSURE");
}

// Radiance's own default primaries have an equal-energy white; white stays white, and pure red of a wider space is
// redder than Rec. 709 can say. The matrix is tested beside it (chromaticities_test.cpp); here that it is applied.
TEST(RadianceHdr, OtherPrimariesAreConvertedAndRec709sAreNot) {
  const auto read = [](const std::string& line, const std::string& pixel) {
    return environment_from_bytes("#?RADIANCE\n" + line + "\n\n-Y 1 +X 1\n" + pixel, "f.hdr");
  };
  const std::string white = "\x80\x80\x80\x81", red = std::string("\x80\x00\x00\x81", 4);
  const std::string kRec709 = "PRIMARIES= .640 .330 .300 .600 .150 .060 .3127 .3290";
  const std::string kRec2020 = "PRIMARIES=.708 .292 .170 .797 .131 .046 .3127 .3290";
  // Eight zeros are what Photoshop writes for "unknown": such a file is taken for Rec. 709, like one without the line.
  for (const std::string& line : {kRec709, std::string("PRIMARIES=0 0 0 0 0 0 0 0")}) {
    const auto same = read(line, red);
    ASSERT_TRUE(same.ok()) << same.error().message;
    EXPECT_FALSE(same->converted);
    EXPECT_TRUE((same->image.at(0, 0) == Rgb(1, 0, 0)).all());
  }
  for (const std::string& line : {kRec2020, std::string("PRIMARIES=.64 .33 .29 .60 .15 .06 .333 .333")}) {
    const auto still = read(line, white);
    ASSERT_TRUE(still.ok()) << still.error().message;
    EXPECT_TRUE(still->converted) << line;
    EXPECT_TRUE(((still->image.at(0, 0) - 1).abs() < 1e-6f).all()) << line;
  }
  const auto redder = read(kRec2020, red);
  ASSERT_TRUE(redder.ok()) << redder.error().message;
  EXPECT_NEAR(redder->image.at(0, 0)[0], 1.6605, 1e-3);  // ITU-R BT.2087, table 2's inverse
  for (const char* line : {"PRIMARIES=1 2 3", "PRIMARIES=", "PRIMARIES=.64 .33 .64 .33 .64 .33 .33 .33",
                           "PRIMARIES=nan .33 .29 .60 .15 .06 .333 .333", "PRIMARIES=.6 .3 .3 .6 .1 .1 .3 0"})
    expect_bad(read(line, white), "PRIMARIES");
}

TEST(RadianceHdr, DamageIsBadInputWithOneLine) {
  const std::string pixel = "\x80\x40\x20\x81";
  expect_bad(environment_from_bytes(hdr("-Y 1 +X 3", pixel + pixel), "f.hdr"), "row 0");
  expect_bad(environment_from_bytes(hdr("+Y 1 +X 1", pixel), "f.hdr"), "resolution");
  expect_bad(environment_from_bytes(hdr("-Y 0 +X 1", pixel), "f.hdr"), "0");
  expect_bad(environment_from_bytes(hdr("-Y 99999999 +X 99999999", pixel), "f.hdr"), "size");
  expect_bad(environment_from_bytes("#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n" + pixel, "f.hdr"),
             "xyze");
  expect_bad(environment_from_bytes("#?RADIANCE\n", "f.hdr"), "header");
  expect_bad(environment_from_bytes(hdr("-Y 1 +X 9", std::string("\x02\x02\x00\x09\xff\x80", 6)), "f.hdr"),
             "row 0");
  expect_bad(environment_from_bytes(hdr("-Y 1 +X 2", "\x01\x01\x01\x01"), "f.hdr"), "row 0");
}

TEST(EnvironmentIo, DamagedBytesNeverCrash) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_environment(folder.path() / "a.exr", random_image(20, 10)));
  std::string coded;
  for (int y = 0; y < 6; ++y)
    coded += std::string("\x02\x02\x00\x09", 4) + "\x89\x80\x89\x40\x89\x20\x89\x81";
  const std::string seeds[] = {read_text_file(folder.path() / "a.exr").value(), hdr("-Y 6 +X 9", coded)};
  std::mt19937 generator(2);
  for (const std::string& seed : seeds)
    for (int i = 0; i < 400; ++i) {
      std::string bytes = seed;
      const std::size_t span = i % 2 == 0 ? std::min<std::size_t>(400, bytes.size()) : bytes.size();
      for (int k = 0; k < 1 + i % 4; ++k) bytes[generator() % span] = static_cast<char>(generator());
      const auto image = environment_from_bytes(bytes, "x");
      if (!image) {
        EXPECT_EQ(image.error().message.find('\n'), std::string::npos);
        continue;
      }
      EXPECT_EQ(image->image.pixels.size(),
                static_cast<std::size_t>(image->image.width) * static_cast<std::size_t>(image->image.height));
    }
}

TEST(EnvironmentIo, RealMapsRead) {
  if (!std::filesystem::exists(kData / "env")) GTEST_SKIP() << "no real maps at " << kData;
  int read = 0;
  for (const auto& entry : std::filesystem::directory_iterator(kData / "env")) {
    const auto image = read_environment(entry.path());
    if (entry.path().stem().string().ends_with("Cube")) {
      expect_bad(image, "cube");
      continue;
    }
    ASSERT_TRUE(image) << image.error().message;
    EXPECT_EQ(image->image.width, 2 * image->image.height);
    ++read;
  }
  EXPECT_GT(read, 0);
}

TEST(EnvironmentIo, TheOneLuxSourceIntegratesToItsLux) {
  const auto file = kData / "env" / "spot1Lux_1k.hdr";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no " << file;
  const auto map = polar_map_from_lat_long(read_environment(file).value().image, true);
  // Its maker's nominal 1 lux; with exact solid angles 0.959 (the three digits known independently).
  EXPECT_NEAR(luminance(total_illuminance(map)), 0.959, 0.0005);
}

}  // namespace
}  // namespace lightwell
