// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// The innermost loops of a field, behind plain data. They are compiled once for every machine and once for AVX2
// (lighting/CMakeLists.txt) and chosen at run time. Both give the same bits: the operations and their order are the same,
// eight lanes wide, and neither fuses a product with a sum. These files include nothing with inline code that the linker
// could share with a machine that lacks the instructions.
namespace lightwell::field_kernel {

inline constexpr int kLanes = 8;

// Rays in a plane: places in cells and radiance. Lists that fit() reads end at a multiple of kLanes, with rays at kNowhere.
struct Rays {
  float *x, *y, *red, *green, *blue;
};
inline constexpr float kNowhere = 1e18F;

// A weighted plane through the nearest rays (lighting/field/moving_least_squares.h).
struct Fit {
  float red, green, blue;
  float square_nearest;  // squared distance of the nearest ray
  float square_support;  // that of the first ray beyond the fit, where weights end
  bool has_weights;      // false: all rays of the fit lie where weights end, and there is no radiance
};

// One channel of a plane.
struct Pixels {
  const float* first;
  int width;
};
// A run of places in a plane, `step` pixels apart from (x, y) on along its rows: all have one fraction of a pixel.
struct Run {
  double x, y;
  int count, step;
};
inline constexpr int kColumn = 16;  // points that are summed together

struct Kernels {
  // Copies those of `count` rays that lie within a distance to `to` from entry `at` on; returns how many entries `to` has then.
  // `to` has room for all, and one more.
  int (*within)(const Rays& from, int count, float x, float y, float square_distance, const Rays& to, int at);
  // Squared distance of the ray after the `nearer` nearest. count: a multiple of kLanes, more than `nearer` of them somewhere.
  // guess: of the answer, above 0. squares: room for count.
  float (*square_distance)(const Rays& rays, int count, float x, float y, int nearer, float guess,
                           float* squares);
  // A fit over the `support` nearest of so many rays; over all of `somewhere`, where there are no more. squares: as above.
  Fit (*fit)(const Rays& rays, int count, int somewhere, float x, float y, int support, float guess,
             float* squares);
  // Linear interpolation at a run's places. May read and write kLanes numbers behind the last.
  void (*interpolate)(const Pixels& pixels, const Run& run, float* to);
  // The same of kLanes neighbouring runs of kLanes places each, their places behind one another: place j of run i goes to
  // to[j · stride + i].
  void (*interpolate_across)(const Pixels& pixels, const Run* runs, float* to, int stride);
  // to[h · stride + i] += Σ_d values[d][i] · weights[d][h] for i below `points`, which is at most kColumn.
  // values: [directions][kColumn]; weights: [directions][harmonics].
  void (*add_products)(const float* values, const float* weights, int directions, int harmonics, float* to,
                       long stride, int points);
};

extern const Kernels kPortableKernels;
const Kernels* avx2_kernels();  // null where the machine lacks it
const Kernels& kernels();       // the best that the machine has

}  // namespace lightwell::field_kernel
