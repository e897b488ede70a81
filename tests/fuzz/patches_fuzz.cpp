// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// The CSV files of calibrate response and colour: patches and colour charts.
#include "calibration/photometric/colour_fit.h"
#include "calibration/photometric/patches.h"
#include "tests/fuzz/memory_file.h"

using namespace lightwell;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const fuzz::MemoryFile file({data, size});
  const std::string name = file.path().string();
  const auto patches = calibration::read_patches(file.path());
  if (!patches) {
    fuzz::expect_one_line(patches.error(), name);
  } else {
    for (const std::string& channel : calibration::channels_of(*patches)) {
      const auto set = calibration::at_exposure(calibration::of_channel(*patches, channel), 1000, 0.01);
      const auto checked = calibration::ordered_and_checked(set, 4095, 0.5);
      if (!checked) fuzz::expect_one_line(checked.error(), name);
    }
  }
  Response response;
  response.model = LinearResponse{0, 10};
  const auto chart = calibration::read_chart(file.path(), response);
  if (!chart)
    fuzz::expect_one_line(chart.error(), name);
  else if (const auto fit = calibration::fit_colour(*chart, name); !fit)
    fuzz::expect_one_line(fit.error(), name);
  return 0;
}
