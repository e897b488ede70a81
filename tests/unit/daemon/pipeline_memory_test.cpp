// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <atomic>
#include <cstring>
#include <memory>

#include "daemon/pipeline/pipeline.h"
#include "tests/support/endless_source.h"
#include "tests/support/log_camera.h"
#include "tests/support/reference_radiometer.h"
#include "tests/support/resident_memory.h"

namespace lightwell {
namespace {

TEST(PipelineMemory, StaysFlatOverTenThousandFrames) {
  constexpr std::uint64_t kFrames = 10000, kWarm = 1000;
  const FrameFormat format{64, 48, PixelFormat::mono12p};
  const Calibration calibration = test::log_camera(format.width, format.height, 12);
  std::vector<std::vector<std::byte>> pictures;
  for (unsigned seed = 1; seed <= 5; ++seed)
    pictures.push_back(test::pack(test::random_codes(calibration, format, seed), format));
  FramePathOptions options;
  options.radiometer.grid = {10, 40, kPi / 2};
  options.lights.count = 40;
  options.lights.clusters = 10;
  SnapshotChannel snapshots(FramePath::prototype(options));

  std::atomic<double> warm{0}, middle{0}, end{0};
  const auto source =
      std::make_shared<test::EndlessSource>(format, 60, pictures, kFrames, [&](std::uint64_t taken) {
        if (taken == kWarm) warm = test::resident_bytes();
        if (taken == kFrames / 2) middle = test::resident_bytes();
        if (taken == kFrames) end = test::resident_bytes();
      });
  Pipeline pipeline(nullptr);
  ASSERT_TRUE(pipeline.start(source, std::make_shared<FramePath>(calibration, options, snapshots)));
  std::uint64_t seen = 0;
  while (seen < kFrames) {  // a reader as the daemon has them
    const auto lease = snapshots.wait_newer(seen, std::chrono::seconds(20));
    ASSERT_TRUE(lease) << seen;
    seen = lease->number;
  }
  pipeline.stop();
  EXPECT_EQ(pipeline.view().path->published(), kFrames);
  ASSERT_GT(warm, 0);
  // 50 bytes kept of every frame would show; a page touched for the first time, of a stack or a snapshot, does not.
  constexpr double kSlack = 50.0 * (kFrames - kWarm);
  EXPECT_LT(middle - warm, kSlack);
  EXPECT_LT(end - warm, kSlack);
}

}  // namespace
}  // namespace lightwell
