// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// `lightwell field build` under mpirun, and builds that are killed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>

#include "tests/integration/commands/command_fixture.h"
#include "tests/support/analytic_fields.h"

namespace lightwell::test {
namespace {

using testing::HasSubstr;

class FieldRanksTest : public CommandTest {
 protected:
  void SetUp() override {
    const auto positions = random_positions(60, 1, 0.1);
    std::ofstream list(path("probes.csv"));
    list << "x,y,z,file\n";
    for (std::size_t i = 0; i < positions.size(); ++i) {
      const std::string name = "p" + std::to_string(i) + ".hdr.exr";
      list << positions[i].x() << "," << positions[i].y() << "," << positions[i].z() << "," << name << "\n";
      LatLongImage image{32, 16, {}};
      for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 32; ++x)
          image.pixels.push_back(
              box_of_lamps(positions[i], direction_from_lat_long((x + 0.5) / 32, (y + 0.5) / 16))
                  .cast<float>());
      ASSERT_TRUE(write_environment(path(name), image));
    }
  }

  // Some seconds of work, saved after every part.
  [[nodiscard]] std::vector<std::string> build(const std::string& out,
                                               const std::string& list = "probes.csv") const {
    return {LIGHTWELL_BIN_DIR "/lightwell",
            "field",
            "build",
            path(list),
            "--grid",
            "12,12,12",
            "--bounds",
            "0,0,0,1,1,1",
            "--directions",
            "5000",
            "--save-every",
            "0",
            "--threads",
            "1",
            "--out",
            path(out)};
  }
  // On this machine alone, more ranks than cores, by any user.
  static std::vector<std::string> ranks(int count, const std::vector<std::string>& command) {
    std::vector<std::string> all = {"env",
                                    "OMPI_ALLOW_RUN_AS_ROOT=1",
                                    "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1",
                                    "mpirun",
                                    "-q",
                                    "-n",
                                    std::to_string(count),
                                    "--oversubscribe",
                                    "--mca",
                                    "btl",
                                    "self,vader",
                                    "--mca",
                                    "oob_tcp_if_include",
                                    "lo"};
    all.insert(all.end(), command.begin(), command.end());
    return all;
  }
  static ProcessResult run(const std::vector<std::string>& command) {
    return run_process(command.front(), {command.begin() + 1, command.end()});
  }
  // But for the number that OpenVDB gives every file: 36 letters after the first 21 bytes.
  [[nodiscard]] std::string content(const std::string& name) const {
    std::ifstream file(path(name), std::ios::binary);
    std::stringstream text;
    text << file.rdbuf();
    std::string bytes = text.str();
    return bytes.size() < 57 ? bytes : bytes.erase(21, 36);
  }
  [[nodiscard]] bool wait_for(const std::string& name) const {
    for (int i = 0; i < 6000; ++i) {
      if (std::filesystem::exists(path(name))) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return false;
  }
  static std::size_t lines(const std::string& text, const std::string& with) {
    std::istringstream stream(text);
    std::string line;
    std::size_t count = 0;
    while (std::getline(stream, line)) count += line.find(with) != std::string::npos ? 1 : 0;
    return count;
  }
};

// The programs that mpirun has started on this machine.
std::vector<pid_t> children_of(pid_t parent) {
  const std::string id = std::to_string(parent);
  std::ifstream file("/proc/" + id + "/task/" + id + "/children");
  std::vector<pid_t> children;
  for (pid_t child = 0; file >> child;) children.push_back(child);
  return children;
}

TEST_F(FieldRanksTest, ManyRanksGiveTheSameBitsAndSpeakOnce) {
  const auto alone = run(build("alone.vdb"));
  ASSERT_EQ(alone.exit_code, 0) << alone.err;
  for (const int count : {1, 2, 4}) {
    const std::string name = std::to_string(count) + ".vdb";
    const auto together = run(ranks(count, build(name)));
    ASSERT_EQ(together.exit_code, 0) << together.err;
    EXPECT_EQ(content(name), content("alone.vdb")) << count << " ranks";
    EXPECT_EQ(lines(together.out, "written"), 1u) << together.out;
    EXPECT_FALSE(std::filesystem::exists(path(name + ".part")));
  }
}

TEST_F(FieldRanksTest, AnErrorIsOneLineWithItsExitCode) {
  std::ofstream(path("cut.exr")) << "v/1";
  std::ofstream(path("other.csv"), std::ios::app)
      << std::ifstream(path("probes.csv")).rdbuf() << "0,0,1,cut.exr\n";
  const auto bad = run(ranks(3, build("f.vdb", "other.csv")));
  EXPECT_EQ(bad.exit_code, 3);
  EXPECT_EQ(lines(bad.err, "lightwell: "), 1u) << bad.err;
  EXPECT_THAT(bad.err, HasSubstr("cut.exr"));
  const auto wrong = run(
      ranks(2, {LIGHTWELL_BIN_DIR "/lightwell", "field", "build", path("probes.csv"), "--grid", "4,4,4"}));
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_EQ(lines(wrong.err, "lightwell: "), 1u) << wrong.err;
  EXPECT_FALSE(std::filesystem::exists(path("f.vdb")));
  EXPECT_FALSE(std::filesystem::exists(path("f.vdb.part")));
}

TEST_F(FieldRanksTest, RanksOfDifferentTakesAreOneLineAndNoWait) {
  const auto list = [&](const std::string& name, int probes, double x) {
    std::ofstream text(path(name));
    text << "x,y,z,file\n";
    for (int i = 0; i < probes; ++i)
      text << x + i % 3 << "," << i << "," << i % 5 << ",p" << i % 60 << ".hdr.exr\n";
  };
  list("few.csv", 30, 0);
  list("many.csv", 200, 0);
  list("moved.csv", 30, 1);
  const auto both = [&](const std::string& first, const std::string& second) {
    auto command = ranks(1, build("f.vdb", first));
    const auto other = build("f.vdb", second);
    command.insert(command.end(), {":", "-n", "1"});
    command.insert(command.end(), other.begin(), other.end());
    return run(command);
  };
  const auto expect_refused = [&](const ProcessResult& result, const std::string& why) {
    EXPECT_EQ(result.exit_code, 3);
    EXPECT_EQ(lines(result.err, "lightwell: "), 1u) << result.err;
    EXPECT_THAT(result.err, HasSubstr(why));
    EXPECT_FALSE(std::filesystem::exists(path("f.vdb.part")));
  };
  expect_refused(both("few.csv", "many.csv"),
                 "rank 1 has 200 probes, rank 0 has 30, allowed: the same on all ranks");
  expect_refused(both("few.csv", "moved.csv"), "rank 1 has other places, pictures, frames");
}

TEST_F(FieldRanksTest, ARankThatDiesEndsTheJobAndTheNextGoesOn) {
  ASSERT_EQ(run(build("alone.vdb")).exit_code, 0);
  for (const std::size_t victim : {0u, 1u}) {
    ChildProcess job(ranks(2, build("f.vdb")), path("stderr.txt"));
    ASSERT_TRUE(wait_for("f.vdb.part/sums")) << job.stderr_text();
    const auto children = children_of(job.pid());
    ASSERT_EQ(children.size(), 2u);
    ::kill(children[victim], SIGKILL);
    EXPECT_EQ(job.wait_for_end(60), 128 + SIGKILL);
    EXPECT_EQ(lines(job.stderr_text(), "f.vdb.part: the same command goes on from there"), 1u)
        << job.stderr_text();
    EXPECT_FALSE(std::filesystem::exists(path("f.vdb")));

    const auto next = victim == 0 ? run(build("f.vdb")) : run(ranks(3, build("f.vdb")));  // by any number
    ASSERT_EQ(next.exit_code, 0) << next.err;
    EXPECT_THAT(next.err, HasSubstr("goes on where an interrupted build stands"));
    EXPECT_EQ(content("f.vdb"), content("alone.vdb"));
    EXPECT_FALSE(std::filesystem::exists(path("f.vdb.part")));
    std::filesystem::remove(path("f.vdb"));
  }
}

TEST_F(FieldRanksTest, AKilledBuildGoesOn) {
  ASSERT_EQ(run(build("alone.vdb")).exit_code, 0);
  for (const int signal : {SIGKILL, SIGTERM, SIGINT}) {  // one after the other: each goes on from the last
    ChildProcess child(build("f.vdb"), path("stderr.txt"));
    ASSERT_TRUE(signal == SIGKILL   ? wait_for("f.vdb.part/samples-0")
                : signal == SIGTERM ? wait_for("f.vdb.part/sums")
                                    : child.wait_for_line("goes on").has_value());
    child.send(signal);
    EXPECT_EQ(child.wait_for_end(), -signal);
    EXPECT_FALSE(std::filesystem::exists(path("f.vdb")));
    EXPECT_EQ(lines(child.stderr_text(), "stopped; what is done stands in"), signal == SIGKILL ? 0u : 1u);
  }
  ASSERT_EQ(run(build("f.vdb")).exit_code, 0);
  EXPECT_EQ(content("f.vdb"), content("alone.vdb"));
  EXPECT_FALSE(std::filesystem::exists(path("f.vdb.part")));
}

}  // namespace
}  // namespace lightwell::test
