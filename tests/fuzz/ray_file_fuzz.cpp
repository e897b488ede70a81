// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// Ray files, of TM-25 and as text: what reads is a lamp whose flux is its rays'.
#include <cmath>
#include <string_view>

#include "interface/plain_ray_file.h"
#include "tests/fuzz/memory_file.h"

using namespace lightwell;

namespace {

void expect_lamp(const Result<RayFile>& file) {
  if (!file) {
    fuzz::expect_one_line(file.error(), "lamp");
    return;
  }
  double flux = 0;
  for (const LampRay& ray : file->rays) flux += ray.flux_lm;
  const Luminaire lamp = bin_rays(file->rays, {3, 8});
  constexpr double kDenormal = 1e-30;  // images are floats
  verify_bug(std::abs(luminous_flux(lamp)[1] - flux) <= 1e-3 * flux + kDenormal, "flux of a lamp of rays");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  expect_lamp(parse_tm25({data, size}, "lamp"));
  expect_lamp(parse_plain_rays({reinterpret_cast<const char*>(data), size}, "lamp"));
  return 0;
}
