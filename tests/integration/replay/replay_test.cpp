// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// The take in tests/data through the frame path, as the daemon runs it.

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "daemon/capture/recording_source.h"
#include "daemon/pipeline/frame_path.h"

namespace lightwell {
namespace {

const std::string kTake = std::string(LIGHTWELL_SOURCE_DIR) + "/tests/data/take.mkv";
const std::string kTruth = std::string(LIGHTWELL_SOURCE_DIR) + "/tests/data/truth.jsonl";

struct Replayed {
  std::uint64_t sequence = 0;
  float measured_illuminance = 0;
  std::vector<DirectionalLight> lights;
};

std::vector<Replayed> replay() {
  CaptureOptions options;
  options.speed = 0;
  auto source = make_recording_source(kTake, options);
  const auto calibration = recording_calibration(kTake);
  if (!source || !calibration || !*calibration || !(*source)->start()) return {};
  const FramePathOptions path_options;
  SnapshotChannel snapshots(FramePath::prototype(path_options));
  FramePath path(**calibration, path_options, snapshots);
  std::vector<Replayed> frames;
  while ((*source)->state() != SourceState::ended) {
    const FrameLease lease = (*source)->wait(std::chrono::milliseconds(100));
    if (!lease) continue;
    if (!path.prepare(lease.info().format, (*source)->rate_hz())) return {};
    path.process(lease.info(), lease.bytes());
    const auto snapshot = snapshots.wait_newer(0, std::chrono::milliseconds(0));
    frames.push_back({snapshot->sequence, snapshot->measured_illuminance[0], snapshot->lights});
  }
  return frames;
}

TEST(Replay, EveryFrameMeasuresTheIlluminanceTheCameraWasShown) {
  std::ifstream file(kTruth);
  std::vector<double> truth;
  for (std::string line; std::getline(file, line);)
    truth.push_back(nlohmann::json::parse(line).at("total_illuminance").at(0).get<double>());
  const auto frames = replay();
  ASSERT_EQ(frames.size(), 31u);
  // The camera joined the wire before the recorder: the take's frames are a run of the truth's. 2 % is the chain's bound
  // for a scene with the camera's ordinary noise; the lamp that is dimmed changes by more than that over the second.
  double best = 1e9;
  for (std::size_t shift = 0; shift + frames.size() <= truth.size(); ++shift) {
    double worst = 0;
    for (std::size_t i = 0; i < frames.size(); ++i)
      worst = std::max(worst,
                       std::abs(static_cast<double>(frames[i].measured_illuminance) / truth[shift + i] - 1));
    best = std::min(best, worst);
  }
  EXPECT_LT(best, 0.02);
}

TEST(Replay, TwoRunsGiveTheSameLightsBitForBit) {
  const auto first = replay();
  const auto second = replay();
  ASSERT_FALSE(first.empty());
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    ASSERT_EQ(first[i].sequence, second[i].sequence);
    ASSERT_EQ(first[i].lights.size(), second[i].lights.size());
    for (std::size_t j = 0; j < first[i].lights.size(); ++j) {
      EXPECT_EQ(first[i].lights[j].direction, second[i].lights[j].direction);
      EXPECT_TRUE((first[i].lights[j].illuminance == second[i].lights[j].illuminance).all());
      EXPECT_EQ(first[i].lights[j].id, second[i].lights[j].id);
    }
  }
}

}  // namespace
}  // namespace lightwell
