// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// The loops of a live field: over the pixels of the plane across a direction, and over grid points. Compiled once for
// every machine and once for AVX2 with fused products, and chosen at run time; results differ by rounding. Nothing here
// has inline code that the linker could share with a machine that lacks the instructions.
namespace lightwell::live_kernel {

inline constexpr int kLanes = 8;

// Grid points whose places in a plane are `step` pixels apart from `pixels` on, all with one fraction of a pixel:
// weights of the pixel, that to its right, that below, that below to the right.
struct Run {
  const float* pixels;
  int width;  // of the plane
  float weight[4];
  int count;
  int stride;  // of the output
};

struct Kernels {
  // out[p] = max(0, Σ_n weights[n][p] values[n]). pixels: a multiple of kLanes
  void (*interpolate)(const float* weights, int pixels, int rays, const float* values, float* out);
  // out[i · stride] = the plane between four pixels
  void (*look_up)(const Run& run, float* out);
  // out[h][i] += Σ_d harmonics[d][h] radiance[d][i], for `points` values i of each direction, `stride` apart in
  // radiance. points: a multiple of kLanes, as is stride
  void (*project)(const float* radiance, int stride, int directions, const float* harmonics, int count,
                  int points, float* out);
};

extern const Kernels kPortableKernels;
// The fastest that this machine runs.
const Kernels& kernels();
// nullptr where it does not run here.
const Kernels* avx2_kernels();

}  // namespace lightwell::live_kernel
