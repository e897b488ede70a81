// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// lens.json, response.json and flat.json, and the three as a take carries them.
#include <cmath>

#include "interface/calibration_io.h"
#include "tests/fuzz/memory_file.h"

using namespace lightwell;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const fuzz::MemoryFile file({data, size});
  const std::string name = file.path().string();
  if (const auto lens = read_lens(file.path())) {
    for (const double share : {0.0, 0.3, 1.0}) {
      const double theta = share * lens->max_theta_rad;
      const Vec3d d(std::sin(theta), 0, std::cos(theta));
      verify_bug(lens->project(d).allFinite(), "a lens that was accepted projects to nowhere");
    }
  } else {
    fuzz::expect_one_line(lens.error(), name);
  }
  if (const auto response = read_response(file.path())) {
    for (double code = response->black_code; code <= response->clip_code;
         code += 1 + response->clip_code / 64)
      verify_bug(std::isfinite(response->luminance_cd_m2(code)),
                 "a response that was accepted is not finite");
  } else {
    fuzz::expect_one_line(response.error(), name);
  }
  if (const auto flat = read_flat_field(file.path()); !flat) fuzz::expect_one_line(flat.error(), name);
  const std::string text(reinterpret_cast<const char*>(data), size);
  if (const auto all = calibration_from_json(text, "take.mkv"); !all)
    fuzz::expect_one_line(all.error(), "take.mkv");
  else
    verify_bug(calibration_from_json(calibration_to_json(*all), "x").value().id == all->id, "another id");
  return 0;
}
