// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <csignal>
#include <nlohmann/json.hpp>

#include "interface/atomic_file.h"
#include "interface/environment_io.h"
#include "render/egl_context.h"
#include "tests/integration/render/fake_probe.h"
#include "tests/integration/render/program.h"
#include "tests/support/dds.h"
#include "tests/support/eventually.h"
#include "tests/support/temporary_folder.h"

namespace lightwell {
namespace {

using test::ChildProcess;
using test::eventually;
using test::FakeProbe;
using test::start_render;

class Live : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto context = render::EglContext::create();
    if (!context) GTEST_SKIP() << context.error().message;
  }
  [[nodiscard]] std::vector<std::string> arguments(std::vector<std::string> more) const {
    std::vector<std::string> all = {
        "--scene",    LIGHTWELL_STAGE, "--live", "--domain",      std::to_string(dds_.domain),
        "--headless", "--size",        "32x24",  "--shadow-size", "32"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  [[nodiscard]] std::string file(const std::string& name) const { return (folder_.path() / name).string(); }

  test::TemporaryFolder folder_;
  DdsOptions dds_ = test::own_domain();
};

TEST_F(Live, RendersTheLightThatIsPublishedThoughItStartedFirst) {
  ChildProcess program = start_render(
      folder_.path(), arguments({"--frames", "2", "--out", file("f_%d.exr"), "--stats", file("stats.json")}));
  ASSERT_TRUE(eventually([&] {
    return program.stderr_text().find("waiting for light") != std::string::npos;
  })) << program.stderr_text();
  FakeProbe probe(dds_);
  ASSERT_TRUE(eventually([&] { return probe.send(), !program.running(); }));
  EXPECT_EQ(program.wait(), 0) << program.stderr_text();
  EXPECT_EQ(nlohmann::json::parse(read_text_file(file("stats.json")).value())["predicted_error"], 0.125);
  // Bottom row: the stage's matte ground, which no shadow reaches from straight above.
  const auto picture = read_environment(file("f_1.exr"));
  ASSERT_TRUE(picture.ok()) << picture.error().message;
  const Rgb expected = Rgb(0.42f, 0.40f, 0.38f) * Rgb(100, 200, 300) / static_cast<float>(kPi);
  EXPECT_LT(((picture->image.at(16, 23) - expected) / expected).abs().maxCoeff(), 1e-3f);
}

TEST_F(Live, KeepsTheLastLightWhenTheDaemonDiesAndGoesOnWhenItReturns) {
  ChildProcess program =
      start_render(folder_.path(), arguments({"--out", file("f_%d.png"), "--out", file("last.exr")}));
  {
    FakeProbe probe(dds_);
    ASSERT_TRUE(eventually([&] { return probe.send(), std::filesystem::exists(file("f_0.png")); }))
        << program.stderr_text();
  }
  ASSERT_TRUE(eventually([&] { return program.stderr_text().find("keeping the last") != std::string::npos; }))
      << program.stderr_text();
  EXPECT_TRUE(program.running());
  const auto last_picture = [&] {
    int i = 0;
    while (std::filesystem::exists(file("f_" + std::to_string(i) + ".png"))) ++i;
    return i;
  };
  const int before = last_picture();
  FakeProbe probe(dds_);
  ASSERT_TRUE(eventually([&] { return probe.send(), last_picture() > before; })) << program.stderr_text();
  program.send(SIGTERM);
  EXPECT_EQ(program.wait(), 0) << program.stderr_text();
  EXPECT_TRUE(std::filesystem::exists(file("last.exr")));
}

TEST_F(Live, NoLightInTheGivenTimeIsAFailureThatSaysSo) {
  ChildProcess program =
      start_render(folder_.path(), arguments({"--seconds", "0.5", "--out", file("a.png")}));
  EXPECT_EQ(program.wait(), 1);
  EXPECT_NE(program.stderr_text().find("no light arrived"), std::string::npos) << program.stderr_text();
  EXPECT_FALSE(std::filesystem::exists(file("a.png")));
}

}  // namespace
}  // namespace lightwell
