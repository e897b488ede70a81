// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// CORNERS.json of calibrate lens.
#include "calibration/lens/correspondences.h"
#include "tests/fuzz/memory_file.h"

using namespace lightwell;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const fuzz::MemoryFile file({data, size});
  const auto views = calibration::read_target_views(file.path());
  if (!views) fuzz::expect_one_line(views.error(), file.path().string());
  if (views) (void)calibration::to_json(*views);
  return 0;
}
