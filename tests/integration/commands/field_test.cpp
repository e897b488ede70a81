// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "interface/atomic_file.h"
#include "tests/integration/commands/command_fixture.h"
#include "tests/support/analytic_fields.h"

namespace lightwell::test {
namespace {

using testing::HasSubstr;

class FieldCommandTest : public CommandTest {
 protected:
  // Pictures of a linear field, and their list.
  void SetUp() override {
    const auto positions = random_positions(60, 1, 0.1);
    std::ofstream list(path("probes.csv"));
    list << "x,y,z,file\n";
    for (std::size_t i = 0; i < positions.size(); ++i) {
      const std::string name = "p" + std::to_string(i) + ".exr";
      list << positions[i].x() << "," << positions[i].y() << "," << positions[i].z() << "," << name << "\n";
      LatLongImage image{32, 16, {}};
      for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 32; ++x)
          image.pixels.push_back(
              linear_field(positions[i], direction_from_lat_long((x + 0.5) / 32, (y + 0.5) / 16))
                  .cast<float>());
      ASSERT_TRUE(write_environment(path(name), image));
    }
  }
  [[nodiscard]] ProcessResult build(const std::vector<std::string>& more,
                                    const std::string& list = "probes.csv") const {
    std::vector<std::string> arguments = {"field",    "build",       path(list),     "--grid", "5,4,5",
                                          "--bounds", "0,0,0,1,1,1", "--directions", "600"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return lightwell(arguments);
  }
  static auto lines(const std::string& text) { return std::count(text.begin(), text.end(), '\n'); }
  void expect_refused(const ProcessResult& result, int code, const std::string& text) const {
    EXPECT_EQ(result.exit_code, code) << result.err;
    EXPECT_THAT(result.err, HasSubstr(text));
    EXPECT_FALSE(std::filesystem::exists(path("f.vdb")));
  }
};

TEST_F(FieldCommandTest, AQueryGivesTheLightAtAPlace) {
  const auto built = build({"--out", path("f.vdb"), "--json"});
  ASSERT_EQ(built.exit_code, 0) << built.err;
  const auto report = nlohmann::json::parse(built.out);
  EXPECT_EQ(report["probes"], 60);
  EXPECT_EQ(report["stored_points"], 100);
  EXPECT_NEAR(report["coverage"], 1, 1e-3);
  EXPECT_EQ(report["bytes"], std::filesystem::file_size(path("f.vdb")));

  const Vec3d at(0.3, 0.6, 0.45);
  const auto asked =
      lightwell({"field", "query", path("f.vdb"), "--at", "0.3,0.6,0.45", "--normal", "0,2,0", "--json"});
  ASSERT_EQ(asked.exit_code, 0) << asked.err;
  const auto answer = nlohmann::json::parse(asked.out);
  const Eigen::MatrixXd exact = exact_harmonics(linear_field, at, 4, 3000);
  ASSERT_EQ(answer["sh"].size(), 25u);
  // Pictures of 11° a pixel, 60 probes, half floats: a hundredth of √4π.
  for (std::size_t i = 0; i < 25; ++i)
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_NEAR(answer["sh"][i][c].get<double>(),
                  exact(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(c)), 0.035);
  LightAtPoint light;
  light.radiance = exact.array();
  for (std::size_t c = 0; c < 3; ++c)
    EXPECT_NEAR(answer["irradiance"][c].get<double>(),
                irradiance(light, Vec3d::UnitY())[static_cast<Eigen::Index>(c)], 0.05);
  EXPECT_GT(answer["confidence"], 0.9);

  const auto outside = lightwell({"field", "query", path("f.vdb"), "--at", "0.3,1.6,0.45", "--json"});
  EXPECT_EQ(outside.exit_code, 2);
  EXPECT_THAT(outside.err,
              HasSubstr("--at is 0.3,1.6,0.45, allowed: inside the field, 0,0,0 to 1,1,1 metres"));
}

TEST_F(FieldCommandTest, TheNumberOfThreadsChangesNothing) {
  ASSERT_EQ(build({"--out", path("a.vdb"), "--threads", "1"}).exit_code, 0);
  ASSERT_EQ(build({"--out", path("b.vdb"), "--threads", "3"}).exit_code, 0);
  const auto query = [&](const std::string& file) {
    return lightwell({"field", "query", path(file), "--at", "0.7,0.1,0.2", "--json"}).out;
  };
  EXPECT_EQ(query("a.vdb"), query("b.vdb"));
}

TEST_F(FieldCommandTest, BadInputIsOneLineAndLeavesNothing) {
  const std::vector<std::string> out = {"--out", path("f.vdb")};
  const auto list = [&](const std::string& text) {
    std::ofstream(path("other.csv")) << text;
    return build(out, "other.csv");
  };
  expect_refused(list("x,y,z,file\n0,0,0,p0.exr\nnan,0,0,p1.exr\n"), 3, "other.csv: line 3");
  expect_refused(list("x,y,z,file\n0,0,0,absent.exr\n"), 3, "absent.exr");
  std::ofstream(path("cut.exr")) << "v/1";
  expect_refused(list("x,y,z,file\n0,0,0,p0.exr\n0,0,1,cut.exr\n"), 3, "cut.exr");
  ASSERT_TRUE(write_environment(path("small.exr"), sky(16, 8)));
  expect_refused(list("x,y,z,file\n0,0,0,p0.exr\n0,0,1,small.exr\n"), 3,
                 "small.exr: is 16x8 pixels, allowed 32x16, the size of");
  const auto huge = lightwell({"field", "build", path("probes.csv"), "--grid", "513,512,512", "--bounds",
                               "0,0,0,1,1,1", "--out", path("f.vdb")});
  expect_refused(huge, 2, "--grid is 513,512,512: 134479872 points, allowed: up to 134217728, 512 cubed");
  const auto thin = lightwell({"field", "build", path("probes.csv"), "--grid", "5,5,5", "--bounds",
                               "0,0,0,1,1,1e-9", "--out", path("f.vdb")});
  expect_refused(thin, 2, "--bounds is 0,0,0,1,1,1e-9: points 2.5e-10 metres apart, allowed: 1e-06 or more");
  const auto one = lightwell({"field", "build", path("probes.csv"), "--grid", "5,5,5", "--bounds",
                              "0,0,0,1,1,1", "--directions", "1", "--out", path("f.vdb")});
  expect_refused(one, 2, "--directions is 1, allowed: 0, or 2 to 1048576");
  expect_refused(build({"--out", path("f.vdb"), "--method", "nearest"}), 2, "allowed: best, low");
  expect_refused(build({"--out", path("f.vdb"), "--projection", "fisheye"}), 2, "--lens");
  expect_refused(build({"--out", path("absent/f.vdb")}), 1, "absent");
  const auto flat = lightwell({"field", "build", path("probes.csv"), "--grid", "4,4,4", "--bounds",
                               "0,0,0,1,0,1", "--out", path("f.vdb")});
  expect_refused(flat, 2, "--bounds is 0,0,0,1,0,1, allowed: X0 < X1");
}

TEST_F(FieldCommandTest, RefusesWhatIsLargerThanMemoryWithTheNumber) {
  std::ifstream file("/proc/meminfo");
  std::string word;
  double free_kib = 0;
  while (file >> word)
    if (word == "MemAvailable:") file >> free_kib;
  if (free_kib * 1024 > 460e9) GTEST_SKIP() << "this machine has the memory";
  const auto refused = lightwell({"field", "build", path("probes.csv"), "--grid", "512,512,512", "--bounds",
                                  "0,0,0,1,1,1", "--degree", "8", "--out", path("f.vdb")});
  // 3.5 times 512³ points of 3 · 81 + 1 floats, 458.5 GB, and 823,550 directions of 2296 bytes.
  expect_refused(refused, 2,
                 "--grid 512,512,512 at degree 8 in 823550 directions needs 460.4 GB of memory, allowed: ");
}

// Before any work: what is refused here would cost hours else, or the pictures.
TEST_F(FieldCommandTest, RefusesAnOutputThatCannotBeWrittenOrIsAnInput) {
  const auto bytes = [&](const std::string& name) { return read_text_file(path(name)).value(); };
  const std::string picture = bytes("p7.exr"), list = bytes("probes.csv");
  std::filesystem::create_symlink(path("p7.exr"), path("link.exr"));
  for (const std::string name : {"p7.exr", "link.exr"}) {
    const auto result = build({"--out", path(name)});
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.err, HasSubstr("p7.exr, which is not overwritten"));
  }
  EXPECT_EQ(bytes("p7.exr"), picture);
  EXPECT_EQ(build({"--out", path("probes.csv")}).exit_code, 2);
  EXPECT_EQ(bytes("probes.csv"), list);
  std::filesystem::create_directory(path("folder"));
  // No picture is there: they are not asked for.
  std::ofstream(path("gone.csv")) << "x,y,z,file\n0,0,0,gone.exr\n";
  const auto result = build({"--out", path("folder")}, "gone.csv");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, HasSubstr("folder: cannot write: Is a directory"));
  EXPECT_EQ(lines(result.err), 1) << result.err;
  EXPECT_EQ(lines(build({"--out", path("absent/f.vdb")}, "gone.csv").err), 1);
}

// What is said of the lens, the poses and the calibration comes before they are read: here they are only files.
TEST_F(FieldCommandTest, RefusesAnOutputThatIsTheLensThePosesOrTheCalibration) {
  const auto expect_kept = [&](const std::string& name, const std::vector<std::string>& more,
                               const std::string& probes) {
    SCOPED_TRACE(name);
    std::ofstream(path(name)) << "kept";
    auto arguments = more;
    arguments.insert(arguments.end(), {"--out", path(name)});
    const auto result = build(arguments, probes);
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.err, HasSubstr(path(name) + ", which is not overwritten"));
    EXPECT_EQ(lines(result.err), 1) << result.err;
    EXPECT_EQ(read_text_file(path(name)).value(), "kept");
  };
  expect_kept("lens.json", {"--projection", "fisheye", "--lens", path("lens.json")}, "probes.csv");
  std::ofstream(path("walk.mkv")) << "\x1A\x45\xDF\xA3";  // how Matroska begins
  expect_kept("walk.poses.csv", {}, "walk.mkv");
  expect_kept("other.csv", {"--poses", path("other.csv")}, "walk.mkv");
  std::filesystem::create_directory(path("calibration"));
  for (const std::string name : {"response.json", "lens.json", "flat.json"})
    expect_kept("calibration/" + name, {"--calibration", path("calibration")}, "walk.mkv");
}

TEST_F(FieldCommandTest, SaysWhereStandardOutputIsFullOrAskedForTwice) {
  const std::string program = LIGHTWELL_BIN_DIR "/lightwell";
  ASSERT_EQ(build({"--out", path("f.vdb")}).exit_code, 0);
  const auto full = run_process(
      "/bin/sh", {"-c", program + " field query " + path("f.vdb") + " --at 0.5,0.5,0.5 --json >/dev/full"});
  EXPECT_EQ(full.exit_code, 1);
  EXPECT_EQ(full.err, "lightwell: standard output: cannot write: No space left on device\n");
  // The field, and nothing behind it.
  const auto piped = run_process(
      "/bin/sh", {"-c", program + " field build " + path("probes.csv") +
                            " --grid 5,4,5 --bounds 0,0,0,1,1,1 --directions 600 --out /dev/stdout | cat >" +
                            path("piped.vdb")});
  EXPECT_EQ(piped.exit_code, 0) << piped.err;
  EXPECT_EQ(std::filesystem::file_size(path("piped.vdb")), std::filesystem::file_size(path("f.vdb")));
  const auto twice = run_process(
      "/bin/sh",
      {"-c", program + " field build " + path("probes.csv") +
                 " --grid 5,4,5 --bounds 0,0,0,1,1,1 --out /dev/stdout --json | cat >" + path("none.vdb")});
  EXPECT_EQ(std::filesystem::file_size(path("none.vdb")), 0u);
  EXPECT_THAT(twice.err, HasSubstr("--out /dev/stdout is where --json writes, too"));
}

// What a picture does not show is not dark, and no number of it spoils the field.
TEST_F(FieldCommandTest, PixelsThatAreNoLightWereNotSeen) {
  ASSERT_EQ(build({"--out", path("whole.vdb")}).exit_code, 0);
  const auto spoil = [&](const std::string& name, float value) {
    LatLongImage image = read_environment(path(name))->image;
    for (std::size_t i = 0; i < image.pixels.size() / 2; ++i) image.pixels[i].x() = value;
    ASSERT_TRUE(write_environment(path(name), image));
  };
  spoil("p0.exr", std::numeric_limits<float>::quiet_NaN());
  spoil("p4.exr", std::numeric_limits<float>::infinity());
  spoil("p5.exr", 3e38f);
  spoil("p6.exr", -std::numeric_limits<float>::infinity());
  const auto built = build({"--out", path("f.vdb")});
  ASSERT_EQ(built.exit_code, 0) << built.err;
  EXPECT_THAT(built.err, HasSubstr("p0.exr and 3 others: 1024 pixels are NaN, infinite or above 1e15"));
  const auto light = [&](const std::string& file) {
    return nlohmann::json::parse(
        lightwell({"field", "query", path(file), "--at", "0.5,0.5,0.5", "--json"}).out)["sh"];
  };
  const auto whole = light("whole.vdb"), spoilt = light("f.vdb");
  // A linear field is known from fewer probes as well; as darkness four of 60 would be an error of some percent.
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_NEAR(spoilt[i][c].get<double>(), whole[i][c].get<double>(), 0.01);
}

TEST_F(FieldCommandTest, APictureThatIsGoneLeavesWhatIsDone) {
  const std::filesystem::path state = path("f.vdb.part");
  std::filesystem::create_directory(state);
  const std::string text = "lightwell.field-state/1 numerics 1\nof another take\n";
  std::ofstream(state / "made_from.txt") << text;
  std::filesystem::rename(path("p50.exr"), path("away.exr"));
  expect_refused(build({"--out", path("f.vdb")}), 3, "p50.exr: cannot read: No such file or directory");
  EXPECT_EQ(read_text_file(state / "made_from.txt").value(), text);
  std::filesystem::rename(path("away.exr"), path("p50.exr"));
  const auto built = build({"--out", path("f.vdb")});
  EXPECT_EQ(built.exit_code, 0) << built.err;
  EXPECT_THAT(built.err, HasSubstr("f.vdb.part: was of other pictures or options, begins anew"));
}

TEST_F(FieldCommandTest, SaysWhatOneProbeDoesNotDetermine) {
  std::ofstream(path("one.csv")) << "x,y,z,file\n0.5,0.5,0.5,p0.exr\n";
  const auto built = build({"--out", path("f.vdb")}, "one.csv");
  EXPECT_EQ(built.exit_code, 0) << built.err;
  EXPECT_THAT(built.err, HasSubstr("in one place: how light changes from place to place is not determined"));
}

// Pictures of an upper half, as of a probe that stands: what the projection could show was not seen.
TEST_F(FieldCommandTest, CountsWhatIsInThePictures) {
  for (int i = 0; i < 60; ++i) {
    const std::string name = path("p" + std::to_string(i) + ".exr");
    LatLongImage image = read_environment(name)->image;
    for (std::size_t p = image.pixels.size() / 2; p < image.pixels.size(); ++p)
      image.pixels[p].setConstant(std::numeric_limits<float>::quiet_NaN());
    ASSERT_TRUE(write_environment(name, image));
  }
  const auto report = nlohmann::json::parse(build({"--out", path("f.vdb"), "--json"}).out);
  // Cells that the horizon crosses, a ring of some 43 of 600, count whole or not at all.
  EXPECT_NEAR(report["coverage"], 0.5, 0.04);
  EXPECT_NEAR(report["directions"], 300, 24);
}

TEST_F(FieldCommandTest, OfOnePlaceNothingIsForetold) {
  std::ofstream(path("twice.csv")) << "x,y,z,file\n0.5,0.5,0.5,p0.exr\n0.5,0.5,0.5,p0.exr\n";
  const auto said = build({"--out", path("f.vdb")}, "twice.csv");
  EXPECT_EQ(said.exit_code, 0) << said.err;
  EXPECT_THAT(said.out, HasSubstr("all in one place: how far the field errs cannot be foretold"));
  const auto report = nlohmann::json::parse(build({"--out", path("f.vdb"), "--json"}, "twice.csv").out);
  EXPECT_TRUE(report["held_out_error"].is_null());
}

TEST_F(FieldCommandTest, AFullDiskIsOneLineAndLeavesNothing) {
  ChildProcess::Options options;
  options.file_bytes = 100000;  // the sorted samples need 60 · 600 · 12 bytes
  ChildProcess child({LIGHTWELL_BIN_DIR "/lightwell", "field", "build", path("probes.csv"), "--grid", "5,4,5",
                      "--bounds", "0,0,0,1,1,1", "--directions", "600", "--out", path("f.vdb")},
                     path("stderr.txt"), options);
  EXPECT_EQ(child.wait_for_end(), 1);
  EXPECT_THAT(child.stderr_text(), HasSubstr("sorting the probes' light needs 0.4 MB here while it runs: "));
  EXPECT_FALSE(std::filesystem::exists(path("f.vdb")));
  for (const auto& entry :
       std::filesystem::directory_iterator(std::filesystem::path(path("x")).parent_path()))
    EXPECT_EQ(entry.path().filename().string().find("lightwell-field"), std::string::npos);
}

}  // namespace
}  // namespace lightwell::test
