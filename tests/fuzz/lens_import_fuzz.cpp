// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// calibrate import, one program a format (LIGHTWELL_FUZZ_FORMAT).
#include <cmath>

#include "calibration/lens_import/source_lens.h"
#include "tests/fuzz/memory_file.h"

using namespace lightwell;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const fuzz::MemoryFile file({data, size});
  calibration::SourceLensOptions options;
  options.format = calibration::lens_format(LIGHTWELL_FUZZ_FORMAT);
  const auto source = calibration::read_source_lens(file.path(), options);
  if (!source) {
    if (source.error().kind == ErrorKind::bad_input)
      fuzz::expect_one_line(source.error(), file.path().string());
    return 0;
  }
  for (int i = 0; i <= 20; ++i) {
    const double theta = kPi * i / 20, phi = 2.4 * i;
    const auto pixel =
        source->project({std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)});
    (void)pixel;  // anywhere, or nowhere: convert_lens asks whether it is finite
  }
  return 0;
}
