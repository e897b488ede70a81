// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <utility>

#include "interface/atomic_file.h"
#include "tests/integration/commands/command_fixture.h"

namespace lightwell {
namespace {

using test::ProcessResult;
using testing::HasSubstr;

class BadInput : public test::CommandTest {
 protected:
  // Ends with the code, one line on stderr that names what it must, nothing on stdout, nothing written.
  void expect(const std::vector<std::string>& arguments, int code, const std::string& names) {
    const ProcessResult run = lightwell(arguments);
    EXPECT_EQ(run.exit_code, code) << testing::PrintToString(arguments) << run.err;
    EXPECT_THAT(run.err, HasSubstr(names));
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
    EXPECT_EQ(run.out, "");
    EXPECT_FALSE(std::filesystem::exists(path("o.json")));
    for (const auto& entry : std::filesystem::directory_iterator(path("")))
      EXPECT_EQ(entry.path().string().find("o.json"), std::string::npos) << "left behind: " << entry.path();
  }
  void expect_lights(const std::string& environment, const std::vector<std::string>& extra, int code,
                     const std::string& names) {
    std::vector<std::string> words = {"lights", environment, "--out", path("o.json")};
    words.insert(words.end(), extra.begin(), extra.end());
    expect(words, code, names);
  }
};

TEST_F(BadInput, ValuesOutOfRangeAreWrongUsage) {
  const std::string sky = path("sky.exr");
  for (const char* count : {"0", "-1", "100001", "99999999999999"})
    expect_lights(sky, {"--count", count}, 2, "1 to 100000");
  for (const char* count : {"many", "1e3", "3.5", "", "99999999999999999999", "4 "})
    expect_lights(sky, {"--count", count}, 2,
                  "--count: value '" + std::string(count) + "', allowed whole numbers from 1 to 100000");
  expect_lights(sky, {}, 2, "--count");
  for (const char* method : {"nonsense", "median cut", "Best", ""})
    expect_lights(sky, {"--count", "4", "--method", method}, 2,
                  "best, standard, havran, structured, kollig-keller, penrose, median-cut, uniform");
  for (const char* powers : {"cell", ""})
    expect_lights(sky, {"--count", "4", "--powers", powers}, 2,
                  "--powers is " + std::string(powers) + ", allowed: own, cells, means, equal");
  expect_lights(sky, {"--count", "4", "--method", "standard", "--points", "sobol"}, 2,
                "--points is sobol, allowed: random, halton, relaxed");
  for (const auto& [method, points] :
       {std::pair{"best", "random"}, {"standard", "relaxed"}, {"havran", "random"}})
    expect_lights(sky, {"--count", "4", "--method", method, "--points", points}, 2,
                  "--points " + std::string(points) + " do not apply to method " + method);
  expect_lights(sky, {"--count", "4", "--method", "standard", "--interpolation", "printed"}, 2,
                "--interpolation printed does not apply to method standard, allowed: with havran");
  expect_lights(sky, {"--count", "4", "--method", "havran", "--interpolation", "none"}, 2,
                "--interpolation is none, allowed: power, printed");
  for (const char* seed : {"-1", "1.5", "4294967296"})
    expect_lights(sky, {"--count", "4", "--seed", seed}, 2,
                  "--seed: value '" + std::string(seed) + "', allowed whole numbers from 0 to 4294967295");
  for (const char* turn : {"nan", "inf", "abc", "1e300", "-360.5", "400", ""}) {
    const std::string names = "--rotate-y: value '" + std::string(turn) + "', allowed -360 to 360";
    expect_lights(sky, {"--count", "4", "--rotate-y", turn}, 2, names);
    expect({"evaluate", sky, path("l.json"), "--rotate-y", turn}, 2, names);
  }
  for (const char* rate : {"0", "abc", "nan", "100001"})
    expect_lights(sky, {"--count", "4", "--rate", rate}, 2,
                  "--rate: value '" + std::string(rate) + "', allowed above 0 to 100000 Hz");
  for (const char* seconds : {"0", "abc", "nan", "604801"})
    expect({"record", "--out", path("o.mkv"), "--seconds", seconds}, 2,
           "--seconds: value '" + std::string(seconds) + "', allowed above 0 to 604800");
  expect_lights(sky, {"--count", "4", "--temporal", "iir"}, 2, "best, fir, minimum-phase, one-frame, none");
  expect_lights(sky, {"--count", "4", "--temporal", "best"}, 2, "sequence");
  expect_lights(path("e%d.exr"), {"--count", "4", "--method", "havran", "--temporal", "best"}, 2,
                "allowed: fir, minimum-phase, one-frame, none");
  expect_lights(path("e%d.exr"), {"--count", "4", "--method", "median-cut", "--temporal", "best"}, 2,
                "allowed: none");
  expect_lights(sky, {"--count", "4", "--mains", "50"}, 2, "sequence");
  expect_lights(path("e%d.exr"), {"--count", "4", "--mains", "55"}, 2, "allowed: 50, 60 Hz");
  expect_lights(path("e%d.exr"), {"--count", "4", "--mains", "abc"}, 2, "50 or 60 Hz");
  expect_lights(path("e%d.exr"), {"--count", "4", "--exposure", "2"}, 2, "--mains");
  expect({"filter", "--rate", "60", "--pass", "12", "--stop", "20", "--order", "8", "--phase", "odd"}, 2,
         "allowed: linear, minimum");
  expect_lights(sky, {"--count", "4", "--temporal", "fir"}, 2, "sequence");
  // Refused before a frame is looked for.
  expect_lights(path("e%d.exr"), {"--count", "4", "--method", "havran", "--powers", "cells"}, 2,
                "--powers cells needs --temporal none");
  expect_lights(path("e%d.exr"), {"--count", "4", "--method", "havran", "--interpolation", "printed"}, 2,
                "--interpolation printed needs --temporal none");
  expect_lights(path("e%d.exr"), {"--count", "4", "--method", "standard", "--points", "random"}, 2,
                "--points random needs --temporal none");
  expect_lights(path("e%d.exr"), {"--count", "4", "--temporal", "fir"}, 2, "standard, havran");
  expect_lights(sky, {"--count", "4", "--sphere", "--hemisphere"}, 2, "--hemisphere");
  expect_lights(sky, {"--count", "4", "--frobnicate"}, 2, "--frobnicate");
  expect({"evaluate", sky}, 2, "lights");
}

TEST_F(BadInput, ACommandThatIsNoneIsNamed) {
  expect({"frobnicate"}, 2, "'frobnicate'");
  expect({"--frobnicate"}, 2, "'--frobnicate'");
  expect({"calibrate", "frobnicate"}, 2, "'frobnicate'");
  expect({}, 2, "required");
}

TEST_F(BadInput, RangesIncludeTheirEnds) {
  for (const auto& [option, value] : {std::pair("--rotate-y", "-360"),
                                      {"--rotate-y", "360"},
                                      {"--seed", "0"},
                                      {"--seed", "4294967295"},
                                      {"--rate", "100000"},
                                      {"--seed", "+010"}}) {
    const auto run =
        lightwell({"lights", path("sky.exr"), "--count", "1", "--out", path("l.json"), option, value});
    EXPECT_EQ(run.exit_code, 0) << option << ' ' << value << ": " << run.err;
  }
}

TEST_F(BadInput, AnOutputThatIsAnInputIsRefusedAndKept) {
  const std::string sky = path("sky.exr");
  const std::string before = read_text_file(sky).value();
  std::filesystem::create_hard_link(sky, path("link.exr"));
  std::filesystem::create_symlink(sky, path("soft.exr"));
  for (const std::string& out : {sky, path("./sky.exr"), path("link.exr"), path("soft.exr")})
    expect({"lights", sky, "--count", "4", "--out", out}, 2, "output " + out + " is also the input " + sky);
  for (const char* frame : {"s1.exr", "s2.exr"})
    ASSERT_TRUE(write_environment(path(frame), CommandTest::sky(8, 4)));
  expect({"lights", path("s%d.exr"), "--count", "4", "--out", path("s2.exr")}, 2, path("s2.exr"));
  expect({"repair", sky, "--out", sky}, 2, "is also the input");
  expect({"record", "--seconds", "1", "--source", "recording:" + sky, "--out", sky}, 2, "is also the input");
  expect({"calibrate", "response", sky, "--out", sky}, 2, "is also the input");
  expect({"calibrate", "lens", sky, "--board", "9x6:30", "--out", sky}, 2, "is also the input");
  EXPECT_EQ(read_text_file(sky).value(), before);
  EXPECT_TRUE(read_environment(path("s2.exr")));
}

TEST_F(BadInput, ImagesThatCannotBeReadAreBadInput) {
  const std::string good = read_text_file(path("sky.exr")).value();
  ASSERT_TRUE(write_file_atomically(path("cut.exr"), good.substr(0, good.size() / 2)));
  ASSERT_TRUE(write_file_atomically(path("empty.exr"), ""));
  ASSERT_TRUE(write_file_atomically(path("text.hdr"), "not an image"));
  ASSERT_TRUE(write_file_atomically(path("cut.hdr"), "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 8 +X 16\nab"));
  for (const char* name : {"absent.exr", "cut.exr", "empty.exr", "text.hdr", "cut.hdr", ""}) {
    expect_lights(path(name), {"--count", "4"}, 3, path(name));
    expect({"evaluate", path(name), path("l.json")}, 3, path(name));
  }
}

TEST_F(BadInput, SequencesThatAreNotWholeAreBadInput) {
  expect_lights(path("none_%04d.exr"), {"--count", "4"}, 3, "no frame");
  expect_lights(path("absent/e_%d.exr"), {"--count", "4"}, 3, "folder");
  expect_lights(path("a%d_%d.exr"), {"--count", "4"}, 3, "one %d");
  for (const char* frame : {"s1.exr", "s2.exr", "s4.exr"})
    ASSERT_TRUE(write_environment(path(frame), sky(8, 4)));
  expect_lights(path("s%d.exr"), {"--count", "4"}, 3, "frame 3");
  ASSERT_TRUE(write_environment(path("s3.exr"), sky(10, 4)));
  expect_lights(path("s%d.exr"), {"--count", "4"}, 3, "s3.exr");
}

TEST_F(BadInput, AFileWhoseNameLooksLikeASequenceIsAFile) {
  ASSERT_TRUE(write_environment(path("sky_%d.exr"), sky(8, 4)));
  const auto run = lightwell({"lights", path("sky_%d.exr"), "--count", "4", "--out", path("l.json")});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(std::filesystem::exists(path("l.json")));
}

TEST_F(BadInput, StandardOutputHasNoShortName) {
  expect({"lights", path("sky.exr"), "--count", "4", "--out", "-"}, 2, "/dev/stdout");
  EXPECT_FALSE(std::filesystem::exists("-"));
}

TEST_F(BadInput, PicturesThatAreNotTwiceAsWideAsHighAreSaid) {
  for (const auto& [width, height] : {std::pair(16, 16), {8, 16}, {64, 16}}) {
    ASSERT_TRUE(write_environment(path("square.exr"), sky(width, height)));
    const auto run =
        lightwell({"lights", path("square.exr"), "--count", "4", "--out", path("l.json"), "--json"});
    EXPECT_EQ(run.exit_code, 0);
    EXPECT_THAT(run.err, HasSubstr("square.exr: " + std::to_string(width) + "x" + std::to_string(height)));
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
  }
  for (const auto& [width, height] : {std::pair(1, 1), {3, 2}, {33, 17}, {1000, 500}}) {
    ASSERT_TRUE(write_environment(path("odd.exr"), sky(width, height)));
    const auto run =
        lightwell({"lights", path("odd.exr"), "--count", "4", "--out", path("l.json"), "--json"});
    EXPECT_EQ(run.exit_code, 0);
    EXPECT_EQ(run.err, "");
  }
}

TEST_F(BadInput, LightSetsThatAreNoneAreBadInput) {
  const std::string sky = path("sky.exr");
  expect({"evaluate", sky, path("absent.json")}, 3, "absent.json");
  expect({"evaluate", sky, path("")}, 3, "directory");
  ASSERT_TRUE(write_file_atomically(path("bad.json"), "{\"schema\": 1}"));
  expect({"evaluate", sky, path("bad.json")}, 3, "schema");
  ASSERT_TRUE(write_file_atomically(path("bad.json"), "{"));
  expect({"evaluate", sky, path("bad.json")}, 3, "JSON");
}

TEST_F(BadInput, AMissingOutputFolderIsAFailure) {
  expect({"lights", path("sky.exr"), "--count", "4", "--out", path("absent/lights.json")}, 1,
         "absent/lights.json");
  expect({"lights", path("sky%d.exr"), "--count", "4", "--out", path("o.json")}, 3, "no frame");
  ASSERT_TRUE(write_environment(path("s1.exr"), sky(8, 4)));
  expect({"lights", path("s%d.exr"), "--count", "4", "--out", path("absent/l.jsonl")}, 1, "absent/l.jsonl");
}

TEST_F(BadInput, NotFiniteAndNegativeValuesCountAsZeroAndAreSaid) {
  LatLongImage image = sky(8, 4);
  image.pixels[3][0] = std::numeric_limits<float>::quiet_NaN();
  image.pixels[4][1] = std::numeric_limits<float>::infinity();
  image.pixels[5][2] = -1;
  ASSERT_TRUE(write_environment(path("odd.exr"), image));
  const auto run = lightwell({"lights", path("odd.exr"), "--count", "4", "--out", path("l.json"), "--json"});
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_THAT(run.err, HasSubstr(path("odd.exr") +
                                 ": 2 values are NaN or infinite, 1 values are negative; read as 0"));
  EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1);
}

}  // namespace
}  // namespace lightwell
