// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// The loops of placing lights: over the map's bins, over pairs of lights and atoms, over matrices of lights. Compiled
// once for every machine and once for AVX2 with fused products, and chosen at run time; results differ by rounding.
// Nothing here has inline code that the linker could share with a machine that lacks the instructions.
namespace lightwell::placement_kernel {

inline constexpr int kLanes = 8;     // points come in multiples of it, those behind the last with weight 0
inline constexpr int kMoments = 18;  // Lambertian: degrees 0, 1, 2, 4

// Two shares of the error's kernel: (plain + ground · s_a · s_b) · (3 − |a − b|), distances softened.
struct Shares {
  float plain, ground, softening2;
};

// Weighted points of the sphere, coordinate by coordinate; s: what of them falls on the ground (error_kernel.h).
struct Points {
  const float *x, *y, *z, *s;
  int count;  // with the padding
};

// One ring's planes. red, green and blue are one plane where the map is monochrome.
struct RingPlanes {
  const float *red, *green, *blue, *solid_angle;
};

// Sums over the rings of a row of blocks, a sector: RGB, luminance · sin θ and luminance · cos θ.
struct ColumnSums {
  float *red, *green, *blue, *across, *up;
};

struct Kernels {
  // Adds one ring to the columns. What is not finite and positive counts as 0.
  void (*add_ring)(const RingPlanes& ring, int sectors, float sine, float cosine, const ColumnSums& out);
  // out[c][i] = Σ_k weight[c][k] · kernel(point k, place i), in double; places: count of them, any number
  void (*potentials)(const Points& from, const float* const weight[3], const Shares& shares, const Points& at,
                     double* const out[3]);
  void (*potential)(const Points& from, const float* weight, const Shares& shares, const Points& at,
                    double* out);
  // Where the potential of one weight grows: its gradient at each place without the moments' part, not yet tangential.
  void (*gradient)(const Points& from, const float* weight, const Shares& shares, const Points& at,
                   double* out_xyz);
  // Index of the nearest place of each point, and its distance. places: at least 1
  void (*nearest)(const Points& from, const Points& places, int* index, float* distance);
  // moments[m][c] += Σ_k weight[c][k] · moment m (point k)
  void (*add_moments)(const Points& from, const float* const weight[3], double* moments);
  // out = matrix · in; rows of `stride` doubles, a multiple of 4, 0 behind the columns
  void (*multiply)(const double* matrix, int rows, int stride, const double* in, double* out);
  // matrix += factor · a · bᵀ
  void (*add_outer)(double* matrix, int rows, int stride, double factor, const double* a, const double* b);
  // The light whose going pays most for place c: over i the most of (residual + h t)² / (complement + h² inverse_pivot) −
  // price, h = by_inverse[i], where residual + h t > 0. −1: none above `least`, which comes to be the most.
  int (*best_to_leave)(const double* by_inverse, const double* t, const double* inverse_pivot,
                       const double* price, int stride, double residual, double complement, double* least);
  // out = left · symmetric; left: rows × stride, symmetric: stride × stride
  void (*multiply_rows)(const double* left, int rows, const double* symmetric, int stride, double* out);
};

extern const Kernels kPortableKernels;
// The fastest that this machine runs.
const Kernels& kernels();
// nullptr where it does not run here.
const Kernels* avx2_kernels();

}  // namespace lightwell::placement_kernel
