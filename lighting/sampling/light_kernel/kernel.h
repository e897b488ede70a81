// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// The loops over all bins and all lights, behind plain data. They are compiled once for every machine and once
// for AVX2 (lighting/CMakeLists.txt) and chosen at run time. Both give the same bits: the operations and their
// order are the same, and neither fuses a product with a sum. Like the radiometer's kernels these files include
// nothing with inline code that the linker could share with a machine that lacks the instructions.
namespace lightwell {

// A place inside a ring: fraction of the ring's solid angle, counted from its inner edge, in [0, 1].
struct RingPlace {
  int ring = 0;
  double fraction = 0;
};

// A place inside a sector: fraction of its width, in [0, 1].
struct SectorPlace {
  int sector = 0;
  double fraction = 0;
};

// Two rings of a map and the weight of each: the conditional distribution of azimuth is that of
// weight_a · power of a + weight_b · power of b + uniform (power a sector).
struct RingBlend {
  int a = 0;
  int b = 0;
  double weight_a = 1;
  double weight_b = 0;
  double uniform = 0;
};

// A point of the map that a sampler chose.
struct MapPlace {
  RingPlace ring;
  SectorPlace sector;
  int neighbour = 0;  // the other ring that the azimuth's distribution came from
};

}  // namespace lightwell

namespace lightwell::light_kernel {

inline constexpr int kBlock = 8;       // sectors a block, and blocks a group
inline constexpr int kRingGroup = 16;  // rings a group

// The planes of one ring. red, green and blue are one plane where the map is monochrome.
struct RingPlanes {
  const float* red;
  const float* green;
  const float* blue;
  const float* solid_angle;
};

// Cumulative sums of RingDistribution.
struct RingTables {
  int rings, sectors, blocks, groups;
  int group_stride;  // groups, to a multiple of 4
  double total_power;
  const float* power;         // [rings][blocks · kBlock], 0 behind the sectors
  const double* block_start;  // [rings][groups · kBlock], the ring's power behind the blocks
  const double* group_start;  // [rings][group_stride], the ring's power behind the groups
  const double* ring_power;   // [rings]
  const double* ring_start;   // [rings, to a multiple of 4], ∞ behind the rings
  const double* ring_group;   // every kRingGroup-th of ring_start, to a multiple of 4, ∞ behind
  int ring_groups;            // with the padding
};

struct Seam {
  double offset;             // s at the seam
  double sectors;            // the seam's azimuth
  const double* ring_power;  // [rings], over azimuths before the seam
};

// How the azimuth's distribution comes from the rings: the ring's own, interpolated with the nearer neighbour's by
// power, or of the normalised distributions as printed.
enum class Blending { own, by_power, printed };

struct Point {
  double t, s;
};

struct Kernels {
  // power = luminance × solid angle of a ring's bins; running sums at the starts of its blocks; the ring's power and its
  // RGB sums.
  void (*weigh_ring)(const RingPlanes& in, bool mono, int sectors, float* power, double* block_start,
                     double* ring_power, double* rgb);
  // Every azimuth alike where both rings are black.
  RingBlend (*blend)(const RingTables& map, Blending blending, const RingPlace& ring);
  // The blend's cumulative power from λ = 0 at place s of the circle.
  double (*target)(const RingTables& map, const Seam& seam, const RingBlend& blend, double s);
  // The places of `count` points. total_power > 0.
  void (*locate)(const RingTables& map, const Seam& seam, Blending blending, const Point* points, int count,
                 MapPlace* places);
  // Heights (1 − cos θ) and turns, in x and y, become unit directions.
  void (*directions)(float* x, float* y, float* z, int count);
  // out = Σ taps[k] · past[k]
  void (*filter)(const float* const* past, const float* taps, int taps_count, int count, float* out);
  // The same, each held between the least and the largest of its past.
  void (*filter_within_range)(const float* const* past, const float* taps, int taps_count, int count,
                              float* out);
  // Filtered directions made unit, raised to the map's edge, or kept as they last were (LightFilter says when).
  void (*settle_directions)(float* x, float* y, float* z, float* last_x, float* last_y, float* last_z,
                            int count, float edge_cosine, float edge_sine);
};

extern const Kernels kPortableKernels;
// The fastest that this machine runs.
const Kernels& kernels();
// nullptr where it does not run here.
const Kernels* avx2_kernels();

}  // namespace lightwell::light_kernel
