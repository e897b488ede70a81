// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <csignal>
#include <nlohmann/json.hpp>

#include "interface/atomic_file.h"
#include "interface/environment_io.h"
#include "interface/field_file.h"
#include "render/egl_context.h"
#include "tests/integration/render/fake_field.h"
#include "tests/integration/render/fake_probe.h"
#include "tests/integration/render/program.h"
#include "tests/support/dds.h"
#include "tests/support/eventually.h"
#include "tests/support/temporary_folder.h"

namespace lightwell {
namespace {

using test::ChildProcess;
using test::eventually;
using test::FakeField;
using test::stage_field;
using test::start_render;

class FieldLive : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto context = render::EglContext::create();
    if (!context) GTEST_SKIP() << context.error().message;
  }
  [[nodiscard]] std::vector<std::string> arguments(std::vector<std::string> more) const {
    std::vector<std::string> all = {
        "--scene",    LIGHTWELL_STAGE, "--field", "live",          "--domain", std::to_string(dds_.domain),
        "--headless", "--size",        "32x24",   "--shadow-size", "32"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  [[nodiscard]] std::string file(const std::string& name) const { return (folder_.path() / name).string(); }
  [[nodiscard]] int pictures() const {
    int i = 0;
    while (std::filesystem::exists(file("f_" + std::to_string(i) + ".exr"))) ++i;
    return i;
  }
  // The stage's matt ground: under even light of radiance 1 it returns its albedo.
  [[nodiscard]] float ground(const std::string& name) const {
    const auto picture = read_environment(file(name));
    return picture.ok() ? picture->image.at(16, 23)[0] / 0.42f : -1;
  }
  [[nodiscard]] nlohmann::json stats() const {
    return nlohmann::json::parse(read_text_file(file("stats.json")).value());
  }
  // Sends until the program rendered another picture of what is sent.
  void expect_ground(FakeField& publisher, const ChildProcess& program, float radiance,
                     const LightField& field) {
    const auto shown = [&] {
      publisher.send(field);
      const int last = pictures() - 1;
      return last >= 0 &&
             std::abs(ground("f_" + std::to_string(last) + ".exr") - radiance) < 2e-3f * radiance;
    };
    EXPECT_TRUE(eventually(shown)) << radiance << ": " << program.stderr_text();
  }
  static std::size_t lines_with(const ChildProcess& program, const std::string& words) {
    const std::string text = program.stderr_text();
    std::size_t count = 0;
    for (std::size_t at = text.find(words); at != std::string::npos; at = text.find(words, at + 1)) ++count;
    return count;
  }

  test::TemporaryFolder folder_;
  DdsOptions dds_ = test::own_domain();
};

TEST_F(FieldLive, RendersTheNewestFieldThoughItStartedFirst) {
  ChildProcess program = start_render(
      folder_.path(), arguments({"--frames", "3", "--out", file("f_%d.exr"), "--stats", file("stats.json")}));
  ASSERT_TRUE(eventually([&] { return lines_with(program, "waiting for field light") == 1; }))
      << program.stderr_text();
  FakeField publisher(dds_);
  ASSERT_TRUE(eventually([&] { return publisher.send(stage_field(2)), !program.running(); }));
  EXPECT_EQ(program.wait(), 0) << program.stderr_text();
  EXPECT_EQ(lines_with(program, "field light from 'fake'"), 1u) << program.stderr_text();
  EXPECT_EQ(lines_with(program, "the light at its border is taken"), 1u) << program.stderr_text();
  EXPECT_NEAR(ground("f_2.exr"), 2, 4e-3);
  const auto field = stats()["field"];
  EXPECT_EQ(stats()["frames"], 3);
  EXPECT_EQ(field["size"], (std::vector<int>{3, 2, 3}));
  EXPECT_EQ(field["updates"], 3);
  EXPECT_GT(field["update_ms"]["p50"], 0);
}

// Light that changes, then a field of another size, of another degree, with other bounds.
TEST_F(FieldLive, AnotherFieldTakesTheFirstOnesPlace) {
  ChildProcess program =
      start_render(folder_.path(), arguments({"--out", file("f_%d.exr"), "--stats", file("stats.json")}));
  FakeField publisher(dds_);
  expect_ground(publisher, program, 1, stage_field(1));
  expect_ground(publisher, program, 3, stage_field(3));
  expect_ground(publisher, program, 5, stage_field(5, 0, Vec3d::UnitY(), {4, 3, 5}));
  expect_ground(publisher, program, 7, stage_field(7, 0, Vec3d::UnitY(), {4, 3, 5}, 4));
  LightField moved = stage_field(9, 0, Vec3d::UnitY(), {4, 3, 5}, 4);
  moved.grid.high.x() = 2;
  expect_ground(publisher, program, 9, moved);
  expect_ground(publisher, program, 2, stage_field(2, 0, Vec3d::UnitY(), {2, 2, 2}, 1));
  program.send(SIGTERM);
  EXPECT_EQ(program.wait(), 0) << program.stderr_text();
  EXPECT_EQ(stats()["field"]["degree"], 1);
}

// Main lights fade in, so that no shadow pops; then the picture is that of the same field from a file.
TEST_F(FieldLive, ShadowsOfALampThatComesEndAsThoseOfAFile) {
  const LightField before = stage_field(1, 20, Vec3d(0.3, 0.9, 0.1), {3, 2, 3}, 4);
  LightField both = before;
  const LightField second = stage_field(0, 15, Vec3d(-1, 0.6, 0.4), {3, 2, 3}, 4);
  for (std::size_t i = 0; i < both.radiance.size(); ++i) both.radiance[i] += second.radiance[i];
  ChildProcess program = start_render(
      folder_.path(),
      arguments({"--out", file("f_%d.exr"), "--out", file("live.exr"), "--stats", file("stats.json")}));
  FakeField publisher(dds_);
  ASSERT_TRUE(eventually([&] { return publisher.send(before), pictures() > 0; })) << program.stderr_text();
  // Half a second of fields and more: fades count the time between fields.
  const auto start = std::chrono::steady_clock::now();
  const int first = pictures();
  ASSERT_TRUE(eventually([&] {
    return publisher.send(both),
           std::chrono::steady_clock::now() - start > std::chrono::seconds(2) && pictures() > first + 20;
  })) << program.stderr_text();
  program.send(SIGTERM);
  ASSERT_EQ(program.wait(), 0) << program.stderr_text();
  EXPECT_EQ(stats()["field"]["main_lights"], 2);
  EXPECT_EQ(stats()["shadow_maps"], 2);

  ASSERT_TRUE(write_field(file("both.vdb"), both, {}));
  ChildProcess still =
      start_render(folder_.path(), {"--scene", LIGHTWELL_STAGE, "--field", file("both.vdb"), "--headless",
                                    "--size", "32x24", "--shadow-size", "32", "--out", file("still.exr")});
  ASSERT_EQ(still.wait(), 0) << still.stderr_text();
  const auto live_picture = read_environment(file("live.exr")),
             still_picture = read_environment(file("still.exr"));
  ASSERT_TRUE(live_picture.ok() && still_picture.ok());
  double difference = 0, sum = 0;
  for (std::size_t i = 0; i < live_picture->image.pixels.size(); ++i) {
    const double a = static_cast<double>(live_picture->image.pixels[i][0]);
    const double b = static_cast<double>(still_picture->image.pixels[i][0]);
    difference += std::abs(a - b);
    sum += b;
  }
  // Lights hold within .3 degrees, a few pixels of edges.
  EXPECT_LT(difference, 0.01 * sum);
}

// The same over the real program: one probe under an even sky gives its light everywhere.
TEST_F(FieldLive, RendersTheFieldThatTheCommandMakes) {
  test::FakeProbe probe(dds_);
  ChildProcess command(
      {LIGHTWELL_BIN_DIR "/lightwell", "field", "live", "--domain", std::to_string(dds_.domain), "--probe",
       "fake=0,0,0", "--bounds", "-1,0,-1,1,2,1", "--grid", "4,4,4"},
      folder_.path() / "field.log");
  ChildProcess program = start_render(folder_.path(), arguments({"--out", file("f_%d.exr")}));
  ASSERT_TRUE(eventually([&] { return pictures() > 3; })) << program.stderr_text() << command.stderr_text();
  program.send(SIGTERM);
  EXPECT_EQ(program.wait(), 0) << program.stderr_text();
  EXPECT_EQ(lines_with(program, "field light from 'stage'"), 1u) << program.stderr_text();
  // What degree 4 leaves out of a hemisphere's irradiance.
  EXPECT_NEAR(ground("f_2.exr"), test::FakeProbe::kSky, 0.02 * test::FakeProbe::kSky);
  command.send(SIGINT);
  EXPECT_EQ(command.wait_for_end(), 0) << command.stderr_text();
}

TEST_F(FieldLive, KeepsTheLastFieldWhenItStopsAndGoesOnWhenItReturns) {
  ChildProcess program = start_render(folder_.path(), arguments({"--out", file("f_%d.exr")}));
  {
    FakeField publisher(dds_);
    expect_ground(publisher, program, 1, stage_field(1));
  }
  ASSERT_TRUE(eventually([&] { return lines_with(program, "keeping the last") == 1; }))
      << program.stderr_text();
  EXPECT_TRUE(program.running());
  FakeField publisher(dds_);
  expect_ground(publisher, program, 4, stage_field(4));
  EXPECT_EQ(lines_with(program, "field light from 'fake'"), 2u) << program.stderr_text();
  program.send(SIGTERM);
  EXPECT_EQ(program.wait(), 0) << program.stderr_text();
}

// Each is refused in one line, however often it comes; the picture stays, and good fields go on.
TEST_F(FieldLive, WhatIsNoFieldIsRefusedAndTheLastGoodOneKept) {
  ChildProcess program = start_render(folder_.path(), arguments({"--out", file("f_%d.exr")}));
  FakeField publisher(dds_);
  expect_ground(publisher, program, 1, stage_field(1));
  const std::vector<std::pair<std::string, FakeField::Spoil>> wrong = {
      {"radiance is not the grid's size", [](auto& wire) { wire.size[0] = 4; }},
      {"confidence is not the grid's size", [](auto& wire) { wire.confidence._length = 17; }},
      {"size is not 2 or more", [](auto& wire) { wire.size[1] = 0; }},
      {"size is above", [](auto& wire) { wire.size[0] = wire.size[1] = wire.size[2] = 0x20000; }},
      {"degree is not within 1 to 8", [](auto& wire) { wire.degree = 9; }},
      {"radiance is not finite", [](auto& wire) { wire.half_radiance._buffer[5] = 0x7e00; }},
      {"scale is not positive", [](auto& wire) { wire.scale = std::nanf(""); }},
      {"low is not below high", [](auto& wire) { wire.low[2] = wire.high[2]; }},
      {"bounds are not finite", [](auto& wire) { wire.high[0] = std::nanf(""); }},
  };
  for (const auto& [words, spoil] : wrong) {
    const int before = pictures();
    ASSERT_TRUE(eventually([&, &w = words, &s = spoil] {
      return publisher.send(stage_field(50), s), lines_with(program, w) == 1;
    })) << words
        << ": " << program.stderr_text();
    EXPECT_LE(pictures(), before + 1) << words;  // one may have been on its way
  }
  // A grid that the wire allows, and no driver's 3D texture does.
  const LightField thin = stage_field(50, 0, Vec3d::UnitY(), {32768, 2, 2}, 1);
  ASSERT_TRUE(eventually([&] { return publisher.send(thin), lines_with(program, "does not fit into") == 1; }))
      << program.stderr_text();
  for (int i = 0; i < pictures(); ++i) EXPECT_NEAR(ground("f_" + std::to_string(i) + ".exr"), 1, 4e-3) << i;
  expect_ground(publisher, program, 2, stage_field(2));
  EXPECT_EQ(lines_with(program, "is refused"), wrong.size() + 1) << program.stderr_text();
  program.send(SIGTERM);
  EXPECT_EQ(program.wait(), 0) << program.stderr_text();
}

TEST_F(FieldLive, NoFieldInTheGivenTimeIsAFailureThatSaysSo) {
  ChildProcess program =
      start_render(folder_.path(), arguments({"--seconds", "0.5", "--out", file("a.png")}));
  EXPECT_EQ(program.wait(), 1);
  EXPECT_NE(program.stderr_text().find("no light arrived"), std::string::npos) << program.stderr_text();
  EXPECT_FALSE(std::filesystem::exists(file("a.png")));
}

// The network's options go with light that comes over it, and with no other.
TEST_F(FieldLive, TheNetworksOptionsNeedLiveLight) {
  for (const std::string option : {"--domain", "--interface"}) {
    ChildProcess program = start_render(
        folder_.path(), {"--scene", LIGHTWELL_STAGE, "--field", "a.vdb", option, "1", "--headless"});
    EXPECT_EQ(program.wait(), 2);
    EXPECT_NE(program.stderr_text().find(option), std::string::npos) << program.stderr_text();
  }
}

}  // namespace
}  // namespace lightwell
