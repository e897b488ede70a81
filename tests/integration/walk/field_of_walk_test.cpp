// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "tests/integration/walk/walk_fixture.h"

namespace lightwell::test {
namespace {

using testing::HasSubstr;

class FieldOfWalk : public Walk {
 protected:
  [[nodiscard]] ProcessResult build(const Words& more) const {
    Words arguments = {"field", "build", take().string(), "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_process(program("lightwell"), arguments);
  }
  [[nodiscard]] std::string field() const { return (folder_.path() / "field.vdb").string(); }
  // Light from all sides at a place of the field, lux.
  [[nodiscard]] double total_at(const Vec3d& at) const {
    const std::string place =
        std::to_string(at.x()) + "," + std::to_string(at.y()) + "," + std::to_string(at.z());
    const auto result =
        run_process(program("lightwell"), {"field", "query", field(), "--at=" + place, "--json"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return nlohmann::json::parse(result.out).at("sh")[0][0].get<double>() * std::sqrt(4 * kPi);
  }
  // Of the light from all sides along the first lane, between the grid's points too, relative. A beam's edge between two
  // points, 10 cm apart, may be anywhere: the middle of all errors has none.
  [[nodiscard]] double median_error() const {
    std::vector<double> errors;
    std::ifstream file(truth());
    std::size_t count = 0;
    for (std::string line; std::getline(file, line);) {
      const auto frame = nlohmann::json::parse(line);
      const Vec3d at = rgb_of(frame.at("position_m")).matrix();
      if (std::abs(at.x()) > 0.7 || at.y() > 0 || at.z() > -0.75 || count++ % 5 != 0) continue;
      errors.push_back(std::abs(total_at(at) / frame.at("total_illuminance")[0].get<double>() - 1));
    }
    EXPECT_GE(errors.size(), 10u);
    if (errors.empty()) return 1e9;
    std::sort(errors.begin(), errors.end());
    return errors[errors.size() / 2];
  }
  void expect_refused(const ProcessResult& result, int code, const std::string& text) const {
    EXPECT_EQ(result.exit_code, code) << result.err;
    EXPECT_THAT(result.err, HasSubstr(text));
    EXPECT_FALSE(std::filesystem::exists(field()));
  }
};

// Two lanes of the stage, there and back, at half a metre a second. The tracker is 200 ms late, 10 cm.
TEST_F(FieldOfWalk, AWalkWithATrackerBecomesTheLightThatWasThere) {
  const std::string tracker = "opentrackio:127.0.0.1:" + own_port();
  start_camera(
      {"--scenario", "walk", "--size", "320x240", "--tracking-out", tracker, "--tracking-lag", "200"});
  const auto recorded = record({"--seconds", "7.5", "--source", "aravis:" + address_, "--tracking", tracker});
  ASSERT_EQ(recorded.exit_code, 0) << recorded.err;
  camera_->send(SIGTERM);
  ASSERT_TRUE(camera_->wait_for_end());
  const Words lanes = {"--grid", "17,2,3", "--bounds=-0.8,0,-0.8,0.8,0.1,-0.7", "--calibration",
                       calibration().string()};
  expect_refused(build({lanes[0], lanes[1], lanes[2], "--out", field()}), 3,
                 "has no calibration attached: allowed with --calibration DIR");
  const auto build_late_by = [&](const char* lag_ms) {
    Words options = lanes;
    for (const char* word : {"--lag", lag_ms, "--out"}) options.emplace_back(word);
    options.push_back(field());
    const auto built = build(options);
    EXPECT_EQ(built.exit_code, 0) << built.err;
    return nlohmann::json::parse(built.out);
  };
  const double held_out_wrong = build_late_by("0").at("held_out_error");
  const double error_wrong = median_error();
  const auto report = build_late_by("200");
  const double error = median_error();
  EXPECT_LT(report.at("held_out_error"), 0.95 * held_out_wrong)
      << "lanes there and back agree best where they are right";
  EXPECT_LT(error, 0.03);
  EXPECT_LT(error, 0.5 * error_wrong);
  RecordProperty("error", std::to_string(error) + ", 10 cm beside it " + std::to_string(error_wrong));
  const auto& walk = report.at("walk");
  EXPECT_EQ(walk["lag_ms"], 200);
  EXPECT_GT(walk["frames"], 100);
  EXPECT_EQ(walk["kept"].get<int>() + walk["redundant"].get<int>() +
                walk["without_pose"]["outside"].get<int>() + walk["without_pose"]["in_gap"].get<int>() +
                walk["without_pose"]["in_jump"].get<int>(),
            walk["frames"]);
  EXPECT_NEAR(report["coverage"], 0.5, 1e-3);
}

TEST_F(FieldOfWalk, ASimulatedWalkNeedsNothing) {
  const auto recorded = record({"--seconds", "1.5", "--source", "simulated:walk"});
  ASSERT_EQ(recorded.exit_code, 0) << recorded.err;
  const Words grid = {"--grid", "4,2,2", "--bounds=-0.8,0,-0.85,-0.2,0.1,-0.75", "--out", field()};
  const auto with = [&](const Words& more) {
    Words all = grid;
    all.insert(all.end(), more.begin(), more.end());
    return build(all);
  };
  expect_refused(with({"--projection", "mirror-ball"}), 2, "--projection needs a list of pictures");
  expect_refused(with({"--lag", "3000"}), 2, "--lag");
  expect_refused(with({"--redundant", "-1"}), 2, "--redundant");
  expect_refused(with({"--calibration", folder_.path().string()}), 3, "response.json");
  const std::string list = (folder_.path() / "probes.csv").string();
  std::ofstream(list) << "x,y,z,file\n0,0,0,a.exr\n";
  const auto other = run_process(program("lightwell"), {"field", "build", list, "--grid", "2,2,2", "--bounds",
                                                        "0,0,0,1,1,1", "--out", field(), "--lag", "3"});
  expect_refused(other, 2, "--lag needs a recording");
  EXPECT_EQ(build(grid).exit_code, 0) << "its calibration is attached";
}

}  // namespace
}  // namespace lightwell::test
