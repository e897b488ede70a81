// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <functional>
#include <optional>

#include "interface/environment_io.h"
#include "interface/jpeg.h"
#include "tests/integration/photometric/photometric_fixture.h"

namespace lightwell {
namespace {

// Radiance of a pixel; the sets are of seven photographs two stops apart, from 1 s, through code = 255 x^(1/2.2).
using Scene = std::function<double(int x, int y)>;

// Five decades from left to right.
double ramp(int x, int y) {
  return std::pow(10, 5.0 * x / 1024 - 3) * (1 + 0.5 * y / 768);
}

// What a camera writes, as the first segment of a JPEG.
std::string exif_segment(double seconds, double f_number, unsigned iso) {
  std::string tiff("II*\0", 4);
  const auto put = [&tiff](std::uint64_t value, int bytes) {
    for (int i = 0; i < bytes; ++i) tiff.push_back(static_cast<char>(value >> (8 * i) & 255));
  };
  const auto entry = [&put](unsigned tag, unsigned type, unsigned value) {
    put(tag, 2), put(type, 2), put(1, 4), put(value, 4);
  };
  constexpr unsigned kShort = 3, kLong = 4, kRational = 5, kExifFolder = 26, kValues = 68;
  put(8, 4);
  put(1, 2), entry(0x8769, kLong, kExifFolder), put(0, 4);
  put(3, 2), entry(0x829A, kRational, kValues), entry(0x829D, kRational, kValues + 8),
      entry(0x8827, kShort, iso);
  put(0, 4);
  for (const double value : {seconds, f_number})
    put(static_cast<std::uint64_t>(std::lround(value * 1e6)), 4), put(1000000, 4);
  const std::string content = std::string("Exif\0\0", 6) + tiff;
  const std::size_t size = content.size() + 2;
  return "\xFF\xE1" + std::string{static_cast<char>(size >> 8), static_cast<char>(size & 255)} + content;
}

class BracketMerge : public test::PhotometricTest {
 protected:
  static constexpr int kWidth = 1024, kHeight = 768, kPhotographs = 7;

  static double seconds(int number) { return std::pow(4.0, -number); }
  static std::string jpeg(const Scene& scene, double exposure_s) {
    std::vector<std::uint8_t> rgb;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        const double code = 255 * std::pow(std::min(1.0, scene(x, y) * exposure_s), 1 / 2.2);
        rgb.insert(rgb.end(), 3, static_cast<std::uint8_t>(std::lround(code)));
      }
    return *encode_jpeg(kWidth, kHeight, rgb, 100);
  }
  // The radiance in units of code 118 in the middle exposure, a quarter of the size.
  std::optional<LatLongImage> merged(const Scene& scene) const {
    std::vector<std::string> command = {"brackets"};
    std::string times;
    for (int i = 0; i < kPhotographs; ++i) {
      command.push_back(write("p" + std::to_string(i) + ".jpg", jpeg(scene, seconds(i))));
      times += (i > 0 ? "," : "") + std::to_string(seconds(i));
    }
    command.insert(command.end(),
                   {"--exposures", times, "--out", path("response.json"), "--radiance", path("r.exr")});
    const auto run = calibrate(command);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    auto image = read_environment(path("r.exr"));
    if (!image) return std::nullopt;
    return std::move(image->image);
  }
  static double mean_of(const LatLongImage& image, int left, int top, int side) {
    double sum = 0;
    for (int y = top / 4; y < (top + side) / 4; ++y)
      for (int x = left / 4; x < (left + side) / 4; ++x) sum += static_cast<double>(image.at(x, y)[1]);
    return sum / (side / 4 * (side / 4));
  }
};

TEST_F(BracketMerge, StripesAndLampsOfOnePixelKeepTheirLight) {
  constexpr int kSide = 128, kTop = 256, kStripes = 320, kEven = 640, kLamps = 800;
  constexpr double kDark = 0.2, kBright = 8, kLamp = 40, kWall = 0.4;
  const auto within = [](int x, int y, int left) {
    return x >= left && x < left + kSide && y >= kTop && y < kTop + kSide;
  };
  const auto image = merged([&](int x, int y) {
    if (within(x, y, kStripes)) return x % 2 == 0 ? kDark : kBright;
    if (within(x, y, kEven)) return (kDark + kBright) / 2;
    if (within(x, y, kLamps)) return x % 8 == 3 && y % 8 == 5 ? kLamp : kWall;
    return ramp(x, y);
  });
  ASSERT_TRUE(image);
  const double unit = seconds(kPhotographs / 2) / std::pow(118 / 255.0, 2.2);
  // Without the JPEG blocks at the rim. The curve is good to 2 % (its own test), at either of two radiances.
  const double even = mean_of(*image, kEven + 8, kTop + 8, kSide - 16);
  EXPECT_NEAR(even / (unit * (kDark + kBright) / 2), 1, 0.02);
  EXPECT_NEAR(mean_of(*image, kStripes + 8, kTop + 8, kSide - 16) / even, 1, 0.04);
  const double lamps = (kLamp + 63 * kWall) / 64;
  EXPECT_NEAR(mean_of(*image, kLamps + 8, kTop + 8, kSide - 16) / (unit * lamps), 1, 0.04);
}

TEST_F(BracketMerge, PicturesThatSquaresDoNotDivideEndInCutOnes) {
  // 1021 × 767 of one radiance a column: the last square is of one column, and no black pixel beside it is counted in.
  const auto photograph = [&](int number) {
    std::vector<std::uint8_t> rgb;
    for (int y = 0; y < 767; ++y)
      for (int x = 0; x < 1021; ++x) {
        const double code = 255 * std::pow(std::min(1.0, ramp(x, 0) / 4 * seconds(number)), 1 / 2.2);
        rgb.insert(rgb.end(), 3, static_cast<std::uint8_t>(std::lround(code)));
      }
    return write("p" + std::to_string(number) + ".jpg", *encode_jpeg(1021, 767, rgb, 100));
  };
  const auto run =
      calibrate({"brackets", photograph(0), photograph(1), photograph(2), photograph(3), "--exposures",
                 "1,0.25,0.0625,0.015625", "--out", path("response.json"), "--radiance", path("r.exr")});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto image = read_environment(path("r.exr"));
  ASSERT_TRUE(image) << image.error().message;
  ASSERT_EQ(image->image.width, 256);
  ASSERT_EQ(image->image.height, 192);
  // Columns rise by 1.1 % a pixel: the middle of the last whole square is 2.5 before the last column. The curve: 2 %.
  for (const int y : {0, 100, 191})
    EXPECT_NEAR(static_cast<double>(image->image.at(255, y)[1] / image->image.at(254, y)[1]),
                std::pow(10, 5.0 * 2.5 / 1024), 0.02)
        << y;
}

TEST_F(BracketMerge, PhotographsOfAnotherApertureOrIsoAreRefused) {
  const auto file = [&](int number, double f_number, unsigned iso) {
    const std::string picture = jpeg(ramp, seconds(number));
    return write("p" + std::to_string(number) + ".jpg",
                 picture.substr(0, 2) + exif_segment(seconds(number), f_number, iso) + picture.substr(2));
  };
  const auto command = [&](const std::string& last) {
    return std::vector<std::string>{"brackets", file(0, 5.6, 100), file(1, 5.6, 100),
                                    last,       "--out",           path("response.json")};
  };
  const auto good = calibrate(command(file(2, 5.6, 100)));
  ASSERT_EQ(good.exit_code, 0) << good.err;
  EXPECT_TRUE(read_json("response.json").at("brackets").at("absolute").get<bool>());
  // The shortest is the first of a set, by which the others are judged.
  expect_refused(command(file(2, 8, 100)), 3, "p1.jpg: f-number = 5.6: allowed 8, that of ", "response.json");
  expect_refused(command(file(2, 5.6, 400)), 3, "p1.jpg: ISO = 100: allowed 400, that of ", "response.json");
}

TEST_F(BracketMerge, ExposuresThatContradictExifAreDoubtedAloud) {
  std::vector<std::string> words = {"brackets"};
  for (int number = 0; number < 3; ++number) {
    const std::string picture = jpeg(ramp, seconds(number));
    words.push_back(
        write("p" + std::to_string(number) + ".jpg",
              picture.substr(0, 2) + exif_segment(seconds(number), 5.6, 100) + picture.substr(2)));
  }
  const auto stated = [&](double power, double factor) {
    std::string list;
    for (int number = 0; number < 3; ++number)
      list += (number == 0 ? "" : ",") + std::to_string(factor * std::pow(seconds(number), power));
    std::vector<std::string> all = words;
    all.insert(all.end(), {"--exposures", list, "--out", path("response.json")});
    return calibrate(all);
  };
  EXPECT_THAT(stated(2, 1).err, testing::HasSubstr("its EXIF data"));
  const auto filtered = stated(1, 0.5);  // a common factor is a filter
  EXPECT_EQ(filtered.exit_code, 0);
  EXPECT_EQ(filtered.err, "");
}

}  // namespace
}  // namespace lightwell
