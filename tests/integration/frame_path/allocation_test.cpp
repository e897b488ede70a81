// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/pipeline/frame_path.h"

#include <gtest/gtest.h>

#include <vector>

#include "daemon/clock.h"
#include "tests/support/allocation_counter.h"

namespace lightwell {
namespace {

constexpr FrameFormat kFormat{64, 64, PixelFormat::mono12};

Calibration calibration() {
  Calibration calibration;
  calibration.response.model = LogResponse{1000, 150, 0};
  calibration.lens.image_size = {64, 64};
  calibration.lens.center = {31.5, 31.5};
  calibration.lens.focal = {64 / kPi, 64 / kPi};
  return calibration;
}

TEST(FramePath, AllocatesNothingOnceEverySnapshotHasItsShape) {
  SnapshotChannel snapshots(FramePath::prototype(FramePathOptions{}));
  FramePath path(calibration(), FramePathOptions{}, snapshots);
  std::vector<std::byte> codes(kFormat.bytes(), std::byte{5});
  FrameInfo info;
  info.format = kFormat;
  info.exposure_us = 10000;
  const auto frame = [&] {
    info.capture_mono_ns = info.received_mono_ns = mono_now_ns();
    ++info.sequence;
    ASSERT_TRUE(path.prepare(kFormat, 60));
    path.process(info, codes);
  };
  for (int i = 0; i < 100; ++i) frame();
  const test::AllocationCounter allocations;
  for (int i = 0; i < 100; ++i) frame();
  EXPECT_EQ(allocations.count(), 0u);
}

}  // namespace
}  // namespace lightwell
