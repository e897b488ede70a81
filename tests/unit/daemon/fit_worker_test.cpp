// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/pipeline/fit_worker.h"

#include <gtest/gtest.h>

#include <condition_variable>
#include <vector>

#include "tests/support/eventually.h"
#include "tests/support/fake_daemon.h"

namespace lightwell {
namespace {

using test::eventually;
using test::publish;

FewLightsOptions lights(int count) {
  FewLightsOptions options;
  options.lights = count;
  return options;
}

class FitWorkerTest : public testing::Test {
 protected:
  SnapshotChannel channel_{test::snapshot_shape()};
};

TEST_F(FitWorkerTest, FitsTheNewestFrameAndTellsItsListener) {
  std::mutex mutex;
  std::vector<std::uint64_t> heard;
  FitWorker worker(channel_, lights(2), [&](const FitSnapshot& fit) {
    const std::scoped_lock lock(mutex);
    heard.push_back(fit.number);
  });
  EXPECT_FALSE(worker.newest());
  for (std::uint64_t number = 1; number <= 3; ++number) {
    publish(channel_, number);
    ASSERT_TRUE(eventually([&] { return worker.newest() && worker.newest()->number == number; }));
  }
  const FitSnapshot fit = *worker.newest();
  const auto lease = channel_.wait_newer(0, std::chrono::milliseconds(0));
  EXPECT_EQ(fit.sequence, lease->sequence);
  EXPECT_EQ(fit.capture_mono_ns, lease->capture_mono_ns);
  EXPECT_STREQ(fit.calibration_id.data(), lease->calibration_id.data());
  EXPECT_EQ(fit.measured_part, lease->map.coverage);
  EXPECT_GE(fit.fit.count, 1);
  // As the lights alone would be: the map does not change from frame to frame but for its sun.
  EXPECT_NEAR(fit.fit.residual, fit_few_lights(lease->map, lights(2)).value().residual, 0.02);
  EXPECT_TRUE(eventually([&] {
    const std::scoped_lock lock(mutex);
    return heard == std::vector<std::uint64_t>{1, 2, 3};
  }));
}

TEST_F(FitWorkerTest, OptionsChangeWhileItRuns) {
  FitWorker worker(channel_, std::nullopt, {});
  publish(channel_, 1);
  worker.set_options(lights(1));
  ASSERT_TRUE(eventually([&] { return worker.newest().has_value(); }));
  EXPECT_EQ(worker.newest()->fit.count, 1);
  worker.set_options(lights(3));
  publish(channel_, 2);
  ASSERT_TRUE(eventually([&] { return worker.newest() && worker.newest()->number == 2; }));
  EXPECT_GT(worker.newest()->fit.count, 1);
  worker.set_options(std::nullopt);
  EXPECT_FALSE(worker.newest());
}

TEST_F(FitWorkerTest, FollowsAChangeOfTheMapsGrid) {
  FitWorker worker(channel_, lights(2), {});
  publish(channel_, 1);
  ASSERT_TRUE(eventually([&] { return worker.newest() && worker.newest()->number == 1; }));
  Snapshot& other = channel_.begin_write();
  other.map = PolarMap::make({20, 40, kPi / 2}, 1);
  test::paint_sky(other, 1);
  other.number = 2;
  channel_.end_write();
  ASSERT_TRUE(eventually([&] { return worker.newest() && worker.newest()->number == 2; }));
  EXPECT_LT(worker.newest()->fit.residual, 0.2);
}

TEST_F(FitWorkerTest, EndsThoughNothingEverCameAndThoughTheChannelIsClosed) {
  { const FitWorker worker(channel_, lights(4), {}); }
  channel_.close();
  { const FitWorker worker(channel_, lights(4), {}); }
  EXPECT_FALSE(FitWorker(channel_, lights(4), {}).newest());
}

}  // namespace
}  // namespace lightwell
