// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// EXR files as other programs store them, made here with OpenEXR's own writers; ours read back by
// OpenImageIO.
#include "interface/exr_file.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfRgbaFile.h>
#include <ImfStandardAttributes.h>
#include <ImfTiledOutputFile.h>
#include <OpenImageIO/imageio.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <limits>

#include "interface/atomic_file.h"
#include "interface/environment_io.h"
#include "interface/jpeg.h"
#include "tests/support/temporary_folder.h"

namespace lightwell {
namespace {

using test::TemporaryFolder;
using testing::HasSubstr;

constexpr std::int64_t kLimit = std::int64_t{1} << 28;

// Exact in half precision, another for every channel and pixel.
float sample(int channel, int x, int y) {
  return static_cast<float>(channel * 512 + y * 16 + x);
}

// One plane of a data window at (x0, y0).
struct Plane {
  Plane(const Imath::Box2i& window, int channel) {
    for (int y = window.min.y; y <= window.max.y; ++y)
      for (int x = window.min.x; x <= window.max.x; ++x)
        values.push_back(sample(channel, x - window.min.x, y - window.min.y));
  }
  std::vector<float> values;
};

struct Planes {
  Planes(const Imf::Header& header, const std::vector<std::string>& names) {
    int channel = 0;
    for (const std::string& name : names) {
      planes.emplace_back(header.dataWindow(), channel++);
      frame.insert(name, Imf::Slice::Make(Imf::FLOAT, planes.back().values.data(), header.dataWindow()));
    }
  }
  std::vector<Plane> planes;
  Imf::FrameBuffer frame;
};

Imf::Header header_with(int width, int height, const std::vector<std::string>& names,
                        Imf::PixelType type = Imf::FLOAT) {
  Imf::Header header(width, height);
  for (const std::string& name : names) header.channels().insert(name, Imf::Channel(type));
  return header;
}

// The bytes of a scan line file whose channels, in the order given, hold sample(0, …), sample(1, …) and so
// on.
std::string scan_lines(const Imf::Header& header, const std::vector<std::string>& names) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "a.exr";
  {
    Planes planes(header, names);
    Imf::OutputFile out(file.c_str(), header, 0);
    out.setFrameBuffer(planes.frame);
    out.writePixels(header.dataWindow().max.y - header.dataWindow().min.y + 1);
  }
  return read_text_file(file).value();
}

void expect_samples(const Result<LatLongImage>& image, int width, int height, std::array<int, 3> channels) {
  ASSERT_TRUE(image) << image.error().message;
  ASSERT_EQ(std::pair(image->width, image->height), std::pair(width, height));
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < 3; ++c) {
        const int from = channels[static_cast<std::size_t>(c)];
        ASSERT_EQ(image->at(x, y)[c], from < 0 ? 0 : sample(from, x, y)) << x << ' ' << y << ' ' << c;
      }
}

void expect_bad(const Result<LatLongImage>& image, const std::string& names) {
  ASSERT_FALSE(image);
  EXPECT_EQ(image.error().kind, ErrorKind::bad_input);
  EXPECT_THAT(image.error().message, HasSubstr(names));
  EXPECT_EQ(image.error().message.find('\n'), std::string::npos);
}

TEST(ExrFile, EveryLosslessCompressionAndLineOrderReads) {
  for (const auto compression : {Imf::NO_COMPRESSION, Imf::RLE_COMPRESSION, Imf::ZIPS_COMPRESSION,
                                 Imf::ZIP_COMPRESSION, Imf::PIZ_COMPRESSION})
    for (const auto order : {Imf::INCREASING_Y, Imf::DECREASING_Y}) {
      Imf::Header header = header_with(7, 37, {"R", "G", "B"});
      header.compression() = compression;
      header.lineOrder() = order;
      expect_samples(read_exr(scan_lines(header, {"R", "G", "B"}), "a", kLimit), 7, 37, {0, 1, 2});
    }
}

TEST(ExrFile, HalfAndIntegerChannelsReadAsTheirValue) {
  const auto read = [](Imf::PixelType type, const auto& values) {
    const TemporaryFolder folder;
    const auto file = folder.path() / "a.exr";
    {
      const Imf::Header header = header_with(2, 1, {"R", "G", "B"}, type);
      Imf::FrameBuffer frame;
      for (const char* name : {"R", "G", "B"})
        frame.insert(name, Imf::Slice::Make(type, values.data(), header.dataWindow()));
      Imf::OutputFile out(file.c_str(), header, 0);
      out.setFrameBuffer(frame);
      out.writePixels(1);
    }
    return read_exr(read_text_file(file).value(), "a", kLimit);
  };
  const auto expect = [](const Result<LatLongImage>& image, float first, float second) {
    ASSERT_TRUE(image) << image.error().message;
    EXPECT_TRUE((image->at(0, 0) == Rgb::Constant(first)).all());
    EXPECT_TRUE((image->at(1, 0) == Rgb::Constant(second)).all());
  };
  expect(read(Imf::HALF, std::array<Imath::half, 2>{0.5f, 65504.0f}), 0.5f, 65504.0f);
  expect(read(Imf::UINT, std::array<unsigned, 2>{3, 70000}), 3, 70000);
}

TEST(ExrFile, ChannelsArePlainThenOfALayerThenGray) {
  using Names = std::vector<std::string>;
  const auto read = [](const Names& names) {
    return read_exr(scan_lines(header_with(3, 2, names), names), "a", kLimit);
  };
  expect_samples(read(Names{"r", "g", "b", "A"}), 3, 2, {0, 1, 2});
  expect_samples(read(Names{"R", "B"}), 3, 2, {0, -1, 1});
  expect_samples(read(Names{"sky.B", "sky.G", "sky.R"}), 3, 2, {2, 1, 0});
  expect_samples(read(Names{"a.R", "a.G", "a.B", "R", "G", "B"}), 3, 2, {3, 4, 5});
  expect_samples(read(Names{"A", "Y"}), 3, 2, {1, 1, 1});
  expect_samples(read(Names{"radiance"}), 3, 2, {0, 0, 0});
  expect_bad(read(Names{"A"}), "no colour");
  expect_bad(read(Names{"Z", "id"}), "no colour");
}

TEST(ExrFile, TiledAndMipMappedFilesGiveTheirFullResolution) {
  const TemporaryFolder folder;
  for (const auto mode : {Imf::ONE_LEVEL, Imf::MIPMAP_LEVELS, Imf::RIPMAP_LEVELS}) {
    const auto file = folder.path() / "a.exr";
    {
      Imf::Header header = header_with(21, 13, {"R", "G", "B"});
      header.setTileDescription(Imf::TileDescription(8, 4, mode));
      const Planes planes(header, {"R", "G", "B"});
      Imf::TiledOutputFile out(file.c_str(), header, 0);
      out.setFrameBuffer(planes.frame);  // the smaller levels take the same pixels: they must not be read
      for (int ly = 0; ly < out.numYLevels(); ++ly)
        for (int lx = 0; lx < out.numXLevels(); ++lx)
          if (out.isValidLevel(lx, ly))
            out.writeTiles(0, out.numXTiles(lx) - 1, 0, out.numYTiles(ly) - 1, lx, ly);
    }
    expect_samples(read_exr(read_text_file(file).value(), "a", kLimit), 21, 13, {0, 1, 2});
  }
}

TEST(ExrFile, ADataWindowSmallerThanTheImageLeavesTheRestDarkAndALargerOneIsCut) {
  Imf::Header header = header_with(8, 6, {"R", "G", "B"});
  header.displayWindow() = Imath::Box2i({10, 20}, {17, 25});
  header.dataWindow() = Imath::Box2i({12, 18}, {13, 21});
  const auto image = read_exr(scan_lines(header, {"R", "G", "B"}), "a", kLimit);
  ASSERT_TRUE(image) << image.error().message;
  ASSERT_EQ(std::pair(image->width, image->height), std::pair(8, 6));
  for (int y = 0; y < 6; ++y)
    for (int x = 0; x < 8; ++x) {
      const bool inside = (x == 2 || x == 3) && y < 2;
      ASSERT_EQ(image->at(x, y)[1], inside ? sample(1, x - 2, y + 2) : 0) << x << ' ' << y;
    }
}

TEST(ExrFile, OfSeveralPartsTheFirstIsRead) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "a.exr";
  {
    Imf::Header headers[2] = {header_with(3, 2, {"R", "G", "B"}), header_with(3, 2, {"R", "G", "B"})};
    headers[1].dataWindow() = Imath::Box2i({0, 0}, {8, 8});
    for (int i = 0; i < 2; ++i) {
      headers[i].setName(i == 0 ? "beauty" : "other");
      headers[i].setType(Imf::SCANLINEIMAGE);
    }
    Imf::MultiPartOutputFile out(file.c_str(), headers, 2, false, 0);
    for (int i = 0; i < 2; ++i) {
      const Planes planes(headers[i], {"R", "G", "B"});
      Imf::OutputPart part(out, i);
      part.setFrameBuffer(planes.frame);
      part.writePixels(i == 0 ? 2 : 9);
    }
  }
  expect_samples(read_exr(read_text_file(file).value(), "a", kLimit), 3, 2, {0, 1, 2});
}

TEST(ExrFile, CubesAndSubsampledColourAreRefused) {
  Imf::Header cube = header_with(4, 24, {"R", "G", "B"});
  Imf::addEnvmap(cube, Imf::ENVMAP_CUBE);
  expect_bad(read_exr(scan_lines(cube, {"R", "G", "B"}), "cube.exr", kLimit), "cube, expected");
  Imf::Header lat_long = header_with(4, 2, {"R", "G", "B"});
  Imf::addEnvmap(lat_long, Imf::ENVMAP_LATLONG);
  expect_samples(read_exr(scan_lines(lat_long, {"R", "G", "B"}), "a", kLimit), 4, 2, {0, 1, 2});
  const TemporaryFolder folder;
  const auto file = folder.path() / "yc.exr";
  {
    Imf::RgbaOutputFile out(file.c_str(), 16, 8, Imf::WRITE_YC);
    const std::vector<Imf::Rgba> pixels(16 * 8, Imf::Rgba(1.0f, 0.5f, 0.25f));
    out.setFrameBuffer(pixels.data(), 1, 16);
    out.writePixels(8);
  }
  expect_bad(read_exr(read_text_file(file).value(), "yc.exr", kLimit), "subsampled");
}

// Puts value over the 32 bit number that stands `skip` bytes after the name's end.
std::string with_number(std::string bytes, const std::string& name, std::size_t skip, std::int32_t value) {
  const std::size_t at = bytes.find(name + '\0');
  if (at == std::string::npos) throw std::logic_error("no attribute " + name);
  std::memcpy(bytes.data() + at + name.size() + 1 + skip, &value, sizeof value);
  return bytes;
}

TEST(ExrFile, HugeClaimsOfSmallFilesAreRefused) {
  const std::string good = scan_lines(header_with(4, 3, {"R", "G", "B"}), {"R", "G", "B"});
  const std::size_t to_max = std::strlen("box2i") + 1 + 4 + 8;  // type, size, min
  const auto sized = [&](std::int32_t x, std::int32_t y) {
    return with_number(with_number(good, "dataWindow", to_max, x), "dataWindow", to_max + 4, y);
  };
  expect_samples(read_exr(sized(3, 2), "a", kLimit), 4, 3, {0, 1, 2});  // the right places
  expect_bad(read_exr(sized(1 << 29, 2), "huge.exr", kLimit), "huge.exr");
  expect_bad(read_exr(sized(3, 1 << 29), "huge.exr", kLimit), "huge.exr");
  expect_bad(read_exr(sized(1 << 29, 1 << 29), "huge.exr", kLimit), "huge.exr");
  expect_bad(read_exr(sized((1 << 28) - 1, 0), "huge.exr", kLimit), "huge.exr");
  expect_bad(read_exr(sized(-1, -1), "huge.exr", kLimit), "huge.exr");
  const std::size_t to_size = std::strlen("chlist") + 1;
  for (const std::int32_t size : {-1, 1 << 30, 2000000000})
    expect_bad(read_exr(with_number(good, "channels", to_size, size), "huge.exr", kLimit), "header");
  expect_bad(read_exr(good, "a", 11), "4x3");
}

TEST(ExrFile, WrittenPictureReadsTheSameElsewhere) {
  const TemporaryFolder folder;
  const std::vector<float> pixels = {1, 2, 3, 0.5f, 5, 6, 7, 1, 1e30f, 1e-30f, 0, 0.25f};
  const auto bytes = exr_from_floats(1, 3, "RGBA", pixels, ExrContent::picture);
  ASSERT_TRUE(bytes);
  ASSERT_TRUE(write_file_atomically(folder.path() / "a.exr", *bytes));
  const auto input = OIIO::ImageInput::open((folder.path() / "a.exr").string());
  ASSERT_TRUE(input) << OIIO::geterror();
  EXPECT_EQ(input->spec().channelnames, (std::vector<std::string>{"R", "G", "B", "A"}));
  EXPECT_EQ(input->spec().format, OIIO::TypeDesc::FLOAT);
  std::vector<float> back(12);
  ASSERT_TRUE(input->read_image(0, 0, 0, 4, OIIO::TypeDesc::FLOAT, back.data()));
  EXPECT_EQ(back, pixels);
  EXPECT_EQ(input->spec().get_string_attribute("textureformat"), "");
}

// One pixel; R, G, B are 0, 512 and 1024, as sample() has them.
std::string one_pixel(const std::vector<std::string>& names, const Imf::Chromaticities& space) {
  Imf::Header header = header_with(1, 1, names);
  Imf::addChromaticities(header, space);
  return scan_lines(header, names);
}

const Imf::Chromaticities kRec2020({0.708f, 0.292f}, {0.170f, 0.797f}, {0.131f, 0.046f}, {0.3127f, 0.3290f});

TEST(ExrFile, OtherChromaticitiesBecomeRec709) {
  bool converted = false;
  const auto image = read_exr(one_pixel({"R", "G", "B"}, kRec2020), "a", kLimit, &converted);
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_TRUE(converted);
  // ITU-R BT.2407-0, section 2, whose four digits are good to 5e-5 of 512 and of 1024 each.
  constexpr float kDigits = 5e-5f * (512 + 1024);
  EXPECT_NEAR(image->at(0, 0)[0], -0.5876f * 512 - 0.0728f * 1024, kDigits);
  EXPECT_NEAR(image->at(0, 0)[1], 1.1329f * 512 - 0.0083f * 1024, kDigits);
  EXPECT_NEAR(image->at(0, 0)[2], -0.1006f * 512 + 1.1187f * 1024, kDigits);
  const auto environment = environment_from_bytes(one_pixel({"R", "G", "B"}, kRec2020), "a");
  ASSERT_TRUE(environment);
  EXPECT_TRUE(environment->converted);
  EXPECT_EQ(environment->negative, 1u);  // a colour that Rec. 709 has not
  EXPECT_EQ(environment->image.at(0, 0)[0], 0);
}

TEST(ExrFile, Rec709ChromaticitiesAndGrayChangeNothing) {
  bool converted = true;
  expect_samples(read_exr(one_pixel({"R", "G", "B"}, Imf::Chromaticities()), "a", kLimit, &converted), 1, 1,
                 {0, 1, 2});
  EXPECT_FALSE(converted);
  converted = true;
  expect_samples(read_exr(one_pixel({"Y"}, kRec2020), "a", kLimit, &converted), 1, 1, {0, 0, 0});
  EXPECT_FALSE(converted);
}

TEST(ExrFile, ChromaticitiesThatAreNoColourSpaceAreBadInput) {
  const Imath::V2f point(0.3f, 0.3f);
  const Imf::Chromaticities line(point, point, point, point);
  expect_bad(read_exr(one_pixel({"R", "G", "B"}, line), "a.exr", kLimit), "a.exr: attribute chromaticities");
}

TEST(ExrFile, AValueThatIsNotFiniteStaysInItsChannelThroughAConversion) {
  Imf::Header header = header_with(1, 1, {"R", "G", "B"});
  Imf::addChromaticities(header, kRec2020);
  const TemporaryFolder folder;
  const auto file = folder.path() / "a.exr";
  std::array<float, 3> values = {std::numeric_limits<float>::infinity(), 1, 1};
  {
    Imf::FrameBuffer frame;
    for (std::size_t c = 0; c < 3; ++c)
      frame.insert(std::string(1, "RGB"[c]), Imf::Slice::Make(Imf::FLOAT, &values[c], header.dataWindow()));
    Imf::OutputFile out(file.c_str(), header, 0);
    out.setFrameBuffer(frame);
    out.writePixels(1);
  }
  const auto environment = read_environment(file);
  ASSERT_TRUE(environment) << environment.error().message;
  EXPECT_EQ(environment->not_finite, 1u);
  EXPECT_EQ(environment->negative, 0u);
  EXPECT_EQ(environment->image.at(0, 0)[0], 0);
  EXPECT_GT(environment->image.at(0, 0)[1], 1);
}

TEST(ExrFile, WrittenEnvironmentSaysWhatItIsElsewhere) {
  const TemporaryFolder folder;
  const LatLongImage image{2, 1, {Rgb(1, 2, 3), Rgb(4, 5, 6)}};
  ASSERT_TRUE(write_environment(folder.path() / "a.exr", image));
  const auto input = OIIO::ImageInput::open((folder.path() / "a.exr").string());
  ASSERT_TRUE(input) << OIIO::geterror();
  EXPECT_EQ(input->spec().get_string_attribute("textureformat"), "LatLong Environment");
  float primaries[8] = {};
  ASSERT_TRUE(input->spec().getattribute("chromaticities", OIIO::TypeDesc("float[8]"), primaries));
  EXPECT_THAT(primaries, testing::ElementsAre(0.64f, 0.33f, 0.30f, 0.60f, 0.15f, 0.06f, 0.3127f, 0.3290f));
}

TEST(Jpeg, ReadsTheSameElsewhereToItsLoss) {
  const TemporaryFolder folder;
  constexpr int kWidth = 33;
  constexpr int kHeight = 17;
  std::vector<std::uint8_t> pixels;
  for (int i = 0; i < kWidth * kHeight; ++i) pixels.insert(pixels.end(), {200, 100, 50});
  const auto bytes = encode_jpeg(kWidth, kHeight, pixels);
  ASSERT_TRUE(bytes) << bytes.error().message;
  ASSERT_TRUE(write_file_atomically(folder.path() / "a.jpg", *bytes));
  const auto input = OIIO::ImageInput::open((folder.path() / "a.jpg").string());
  ASSERT_TRUE(input) << OIIO::geterror();
  ASSERT_EQ(std::pair(input->spec().width, input->spec().height), std::pair(kWidth, kHeight));
  std::vector<std::uint8_t> back(pixels.size());
  ASSERT_TRUE(input->read_image(0, 0, 0, 3, OIIO::TypeDesc::UINT8, back.data()));
  // One colour has only its mean to quantise: a step or two of rounding in the colour transform.
  for (std::size_t i = 0; i < pixels.size(); ++i) ASSERT_NEAR(back[i], pixels[i], 3) << i;
  EXPECT_FALSE(encode_jpeg(70000, 1, std::vector<std::uint8_t>(210000)));  // JPEG ends at 65500
}

}  // namespace
}  // namespace lightwell
