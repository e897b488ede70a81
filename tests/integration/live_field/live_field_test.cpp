// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <csignal>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "daemon/simulator/walk_stage.h"
#include "interface/dds_topics.h"
#include "lighting/field/sphere_partition.h"
#include "tests/support/child_process.h"
#include "tests/support/dds.h"
#include "tests/support/eventually.h"
#include "tests/support/temporary_folder.h"

namespace lightwell::test {
namespace {

using testing::HasSubstr;
using namespace std::chrono_literals;

std::string program(const std::string& name) {
  return std::string(LIGHTWELL_BIN_DIR) + "/" + name;
}

// A corner of the stage that no projector reaches: three lamps, a window, walls.
const std::vector<Vec3d> kPlaces = {
    {-1.4, 0, 0.6}, {-0.3, 0, 0.6}, {-1.4, 0.1, 1.7}, {-0.3, 0.2, 1.7}, {-0.9, 0.5, 1.2}};
constexpr const char* kBounds = "-1.5,0,0.5,-0.2,0.6,1.8";

std::string text_of(const Vec3d& v) {
  std::ostringstream text;
  text << v.x() << "," << v.y() << "," << v.z();
  return text.str();
}

// What a monochrome probe would see at a place, as harmonics: luminance.
Eigen::VectorXd truth_at(const Vec3d& at) {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(25), y(25);
  const SpherePartition sphere(20000);
  for (int cell = 0; cell < sphere.cells(); ++cell) {
    const Vec3d d = sphere.centre(cell);
    if (d.y() <= 0) continue;
    harmonics(d, 4, y.data());
    sum += sphere.cell_solid_angle_sr() * luminance(simulator::stage_wall_radiance(at, d)) * y;
  }
  for (const simulator::DiscLight& light : simulator::stage_lights(at)) {
    harmonics(light.direction, 4, y.data());
    sum += luminance(light.illuminance) * y;
  }
  return sum;
}

class LiveStage : public testing::Test {
 protected:
  void start_probe(std::size_t n) { start_probe(n, "p" + std::to_string(n)); }
  void start_probe(std::size_t n, const std::string& name) {
    const std::filesystem::path file = folder_.path() / ("p" + std::to_string(n) + ".toml");
    std::ofstream(file) << "[http]\nlisten = \"127.0.0.1:0\"\n[dds]\ndomain = " << own_domain().domain
                        << "\nenvironment_hz = 30\n[probe]\nname = \"" << name
                        << "\"\n[source]\naddress = \"simulated:stage@" << text_of(kPlaces[n])
                        << "\"\nwidth = 320\nheight = 240\nrate_hz = 5\n";
    daemons_[n] = std::make_unique<ChildProcess>(
        std::vector<std::string>{program("lightwelld"), "--config", file.string()},
        folder_.path() / ("p" + std::to_string(n) + ".log"));
    ASSERT_TRUE(daemons_[n]->wait_for_line("page: http://")) << daemons_[n]->stderr_text();
  }
  void start_field(std::vector<std::string> more = {}) {
    std::vector<std::string> command = {program("lightwell"),
                                        "field",
                                        "live",
                                        "--json",
                                        "--domain",
                                        std::to_string(own_domain().domain),
                                        "--bounds",
                                        kBounds,
                                        "--hold",
                                        "2",
                                        "--fade",
                                        "0.5",
                                        "--out",
                                        out().string()};
    for (std::size_t n = 0; n < kPlaces.size(); ++n) {
      command.emplace_back("--probe");
      command.push_back("p" + std::to_string(n) + "=" + text_of(kPlaces[n]));
    }
    command.insert(command.end(), more.begin(), more.end());
    field_ = std::make_unique<ChildProcess>(
        command, folder_.path() / "field.log",
        ChildProcess::Options{.file_bytes = {}, .environment = {}, .stdout_file = lines()});
  }
  [[nodiscard]] std::filesystem::path out() const { return folder_.path() / "field.vdb"; }
  [[nodiscard]] std::filesystem::path lines() const { return folder_.path() / "field.jsonl"; }
  // Waits for a field of which something is true.
  template <class Condition>
  bool hear(const Condition& condition) {
    return eventually([&] { return reader_->take(frame_, 100ms) && condition(frame_); }, 60s);
  }

  TemporaryFolder folder_;
  std::array<std::unique_ptr<ChildProcess>, 5> daemons_;
  std::unique_ptr<ChildProcess> field_;
  std::unique_ptr<FieldReader> reader_ = FieldReader::create(DdsDomain::open(own_domain()).value()).value();
  FieldFrame frame_;
};

TEST_F(LiveStage, OfTwoDaemonsOfOneNameOneIsFollowedAndItIsSaid) {
  start_probe(0, "p0");
  start_field();
  ASSERT_TRUE(field_->wait_for_line("probe 'p0' is heard")) << field_->stderr_text();
  start_probe(1, "p0");
  EXPECT_TRUE(field_->wait_for_line("two publish as probe 'p0': the first that was heard is followed"))
      << field_->stderr_text();
}

TEST_F(LiveStage, FieldOfFiveDaemonsIsTheStagesLightBetweenThem) {
  for (std::size_t n = 0; n < kPlaces.size(); ++n) start_probe(n);
  start_field({"--probe", "nobody=0,0,0"});
  ASSERT_TRUE(hear([](const FieldFrame& f) {
    return std::count_if(f.probes.begin(), f.probes.end(), [](const auto& p) { return p.weight == 1; }) ==
               5 &&
           std::count_if(f.lamps.begin(), f.lamps.end(), [](const auto& l) { return l.weight == 1; }) >= 3;
  })) << field_->stderr_text();
  EXPECT_EQ(frame_.header.probe, "stage");
  EXPECT_EQ(frame_.field.grid.size[0], 16);

  // The three lamps, to half a degree at 2 m.
  for (const Vec3d& lamp : {Vec3d(-1.6, 0.9, 0.6), Vec3d(2.1, 0.7, -1.4), Vec3d(0.4, 1.4, 1.9)})
    EXPECT_TRUE(std::any_of(frame_.lamps.begin(), frame_.lamps.end(), [&](const auto& l) {
      return (l.position - lamp).norm() < std::max(0.02, 3.0 * static_cast<double>(l.sigma_m));
    })) << lamp.transpose();

  double error = 0, norm = 0, nearest = 0;
  for (const Vec3d& at : {Vec3d(-0.8, 0.2, 0.9), Vec3d(-1.1, 0.3, 1.4), Vec3d(-0.5, 0.1, 1.3)}) {
    const Eigen::VectorXd truth = truth_at(at);
    error += (light_at(frame_.field, at).radiance.col(1).matrix() - truth).squaredNorm();
    norm += truth.squaredNorm();
    const auto closest =
        std::min_element(kPlaces.begin(), kPlaces.end(),
                         [&](const Vec3d& a, const Vec3d& b) { return (a - at).norm() < (b - at).norm(); });
    nearest += (truth_at(*closest) - truth).squaredNorm();
  }
  // .045 with a noisy sensor of 320 x 240. The nearest probe's own light errs several times more.
  EXPECT_LT(std::sqrt(error / norm), 0.07);
  EXPECT_GT(nearest, 16 * error);
  RecordProperty("error", std::to_string(std::sqrt(error / norm)));

  EXPECT_TRUE(field_->wait_for_line("'nobody' was not heard yet")) << field_->stderr_text();
  field_->send(SIGINT);
  EXPECT_EQ(field_->wait_for_end(), 0) << field_->stderr_text();
  const ProcessResult query =
      run_process(program("lightwell"), {"field", "query", out().string(), "--at", "-0.8,0.2,0.9", "--json"});
  ASSERT_EQ(query.exit_code, 0) << query.err;
  EXPECT_NEAR(nlohmann::json::parse(query.out).at("sh")[0][1].get<double>(), truth_at({-0.8, 0.2, 0.9})[0],
              0.05 * truth_at({-0.8, 0.2, 0.9})[0]);
  std::ifstream status(lines());
  std::string line;
  ASSERT_TRUE(std::getline(status, line));
  EXPECT_EQ(nlohmann::json::parse(line).at("schema"), "lightwell.field-live/1");
}

TEST_F(LiveStage, ProbesThatGoFadeAndComeBack) {
  for (const std::size_t n : {0u, 1u, 2u}) start_probe(n);
  start_field();
  const auto weight = [](const FieldFrame& f, std::size_t n) { return f.probes.at(n).weight; };
  ASSERT_TRUE(hear([&](const FieldFrame& f) {
    return weight(f, 0) == 1 && weight(f, 1) == 1 && weight(f, 2) == 1;
  })) << field_->stderr_text();
  daemons_[1]->send(SIGKILL);
  ASSERT_TRUE(hear([&](const FieldFrame& f) { return weight(f, 1) == 0 && weight(f, 0) == 1; }))
      << field_->stderr_text();
  EXPECT_TRUE(field_->wait_for_line("'p1' is silent"));
  start_probe(1);
  ASSERT_TRUE(hear([&](const FieldFrame& f) { return weight(f, 1) == 1; })) << field_->stderr_text();
  EXPECT_TRUE(field_->wait_for_line("'p1' is back"));
  // On demand.
  field_->send(SIGUSR1);
  EXPECT_TRUE(field_->wait_for_line("field.vdb is written"));
  EXPECT_TRUE(std::filesystem::exists(out()));
  field_->send(SIGTERM);
  EXPECT_EQ(field_->wait_for_end(), 0);
}

TEST_F(LiveStage, NobodyIsHeard) {
  start_field({"--seconds", "0.5"});
  EXPECT_EQ(field_->wait_for_end(), 1);
  EXPECT_THAT(field_->stderr_text(), HasSubstr("none of the probes was heard"));
  EXPECT_FALSE(std::filesystem::exists(out()));
}

TEST(LiveFieldCommand, WrongOptionsAreUsage) {
  const auto refused = [](std::vector<std::string> more) {
    std::vector<std::string> command = {"field", "live"};
    command.insert(command.end(), more.begin(), more.end());
    const ProcessResult result = run_process(program("lightwell"), command);
    EXPECT_EQ(result.exit_code, 2) << result.err;
    return result.err;
  };
  EXPECT_THAT(refused({"--bounds", "0,0,0,1,1,1", "--probe", "left=1,2"}), HasSubstr("--probe is left=1,2"));
  EXPECT_THAT(refused({"--bounds", "0,0,0,1,1,1", "--probe", "a=0,0,0", "--probe", "a=1,0,0"}),
              HasSubstr("each name once"));
  EXPECT_THAT(refused({"--bounds", "0,0,0,1,1,0", "--probe", "a=0,0,0"}), HasSubstr("--bounds"));
  EXPECT_THAT(refused({"--bounds", "99999,0,0,99999.001,1,1", "--probe", "a=0,0,0", "--grid", "4,4,4"}),
              HasSubstr("cells of 0.000333 m along X, allowed so far from the origin: from 0.0312 m"));
  EXPECT_THAT(refused({"--bounds", "0,0,0,1,1,1", "--probe", "a=0,0,0", "--grid", "100,100,100"}),
              HasSubstr("262144"));
  EXPECT_THAT(refused({"--bounds", "0,0,0,1,1,1", "--probe", "a=0,0,0", "--rate", "0"}), HasSubstr("--rate"));
  EXPECT_THAT(refused({"--bounds", "0,0,0,1,1,1", "--probe", "a=0,0,0", "--name", ""}), HasSubstr("name"));
}

}  // namespace
}  // namespace lightwell::test
