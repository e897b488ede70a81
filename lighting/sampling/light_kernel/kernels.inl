// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// The kernels' one text, included by a file for each instruction set. In the vector extension that GCC and Clang share;
// a machine whose registers are narrower takes several steps.
namespace lightwell::light_kernel {
namespace {

using Floats4 = float __attribute__((vector_size(16)));
using Floats8 = float __attribute__((vector_size(32)));
using Doubles4 = double __attribute__((vector_size(32)));
using Longs4 = long long __attribute__((vector_size(32)));

#define LIGHTWELL_INLINE inline __attribute__((always_inline))

// The same types at any address.
template <class Vector>
struct Anywhere {
  Vector v;
} __attribute__((packed, may_alias));

template <class Vector, class T>
LIGHTWELL_INLINE void load(Vector& v, const T* p) {
  v = reinterpret_cast<const Anywhere<Vector>*>(p)->v;
}
template <class Vector, class T>
LIGHTWELL_INLINE void store(T* p, const Vector& v) {
  reinterpret_cast<Anywhere<Vector>*>(p)->v = v;
}
LIGHTWELL_INLINE void to_doubles(const Floats4& from, Doubles4& to) {
#if defined(__AVX__)
  to = _mm256_cvtps_pd(from);  // GCC 12 goes through memory on its own
#else
  to = __builtin_convertvector(from, Doubles4);
#endif
}

template <class T>
LIGHTWELL_INLINE T least(T a, T b) {
  return b < a ? b : a;
}
template <class T>
LIGHTWELL_INLINE T most(T a, T b) {
  return a < b ? b : a;
}
template <class T>
LIGHTWELL_INLINE T held(T v, T low, T high) {
  return least(most(v, low), high);
}

// ---- A ring's powers and running sums

// Radiance × solid angle stays finite in float up to here; beyond is no light but a broken map.
constexpr float kLargestPower = 1e30f;

LIGHTWELL_INLINE void halves(const Floats8& v, Floats4& low, Floats4& high) {
  low = __builtin_shufflevector(v, v, 0, 1, 2, 3);
  high = __builtin_shufflevector(v, v, 4, 5, 6, 7);
}

LIGHTWELL_INLINE double sum_of_lanes(const Floats8& v) {
  Floats4 low, high;
  halves(v, low, high);
  low += high;
  return static_cast<double>(low[0] + low[2]) + static_cast<double>(low[1] + low[3]);
}

// A block's eight bins as four sums, in double: a bin beside a sun 10⁸ times as bright still counts.
LIGHTWELL_INLINE void sums_in_block(const Floats8& block, Doubles4& sums) {
  Floats4 low, high;
  halves(block, low, high);
  Doubles4 more;
  to_doubles(low, sums);
  to_doubles(high, more);
  sums += more;
}

// The sums of four blocks, each over its eight bins.
LIGHTWELL_INLINE void sums_of_blocks(const Floats8& a, const Floats8& b, const Floats8& c, const Floats8& d,
                                     Doubles4& sums) {
  Doubles4 in_a, in_b, in_c, in_d;
  sums_in_block(a, in_a);
  sums_in_block(b, in_b);
  sums_in_block(c, in_c);
  sums_in_block(d, in_d);
  const Doubles4 ab =
      __builtin_shufflevector(in_a, in_b, 0, 4, 2, 6) + __builtin_shufflevector(in_a, in_b, 1, 5, 3, 7);
  const Doubles4 cd =
      __builtin_shufflevector(in_c, in_d, 0, 4, 2, 6) + __builtin_shufflevector(in_c, in_d, 1, 5, 3, 7);
  sums = __builtin_shufflevector(ab, cd, 0, 1, 4, 5) + __builtin_shufflevector(ab, cd, 2, 3, 6, 7);
}

struct ChannelSums {
  Floats8 red = {}, green = {}, blue = {};
};

// power = luminance × solid angle of eight bins.
template <bool kMono>
LIGHTWELL_INLINE void weigh_block(const RingPlanes& in, int sector, ChannelSums& sums, float* power,
                                  Floats8& weighed) {
  Floats8 omega, r, g, b;
  load(omega, in.solid_angle + sector);
  load(r, in.red + sector);
  r *= omega;
  weighed = r;
  if constexpr (!kMono) {
    load(g, in.green + sector);
    load(b, in.blue + sector);
    g *= omega;
    b *= omega;
    sums.red += r;
    sums.green += g;
    sums.blue += b;
    weighed = 0.2126f * r + 0.7152f * g + 0.0722f * b;
  }
  const Floats8 limit = Floats8{} + kLargestPower;
  weighed = weighed < limit ? weighed : limit;
  store(power + sector, weighed);
}

// Powers are summed in double; the RGB sums are of a few hundred non-negative floats in eight lanes: relative error
// ≤ 50 · 2⁻²⁴.
template <bool kMono>
LIGHTWELL_INLINE void weigh_ring_of(const RingPlanes& planes, int sectors, float* power, double* block_start,
                                    double* ring_power, double* rgb) {
  const RingPlanes in = planes;  // a copy: nothing that is written can change it
  ChannelSums lanes;
  double sum = 0;
  int s = 0;
  for (; s + 4 * kBlock <= sectors; s += 4 * kBlock) {
    Floats8 a, b, c, d;
    weigh_block<kMono>(in, s, lanes, power, a);
    weigh_block<kMono>(in, s + kBlock, lanes, power, b);
    weigh_block<kMono>(in, s + 2 * kBlock, lanes, power, c);
    weigh_block<kMono>(in, s + 3 * kBlock, lanes, power, d);
    Doubles4 sums;
    sums_of_blocks(a, b, c, d, sums);
    for (int block = 0; block < 4; ++block) {
      *block_start++ = sum;
      sum += sums[block];
    }
  }
  for (; s + kBlock <= sectors; s += kBlock) {
    Floats8 block;
    weigh_block<kMono>(in, s, lanes, power, block);
    Doubles4 sums;
    sums_in_block(block, sums);
    *block_start++ = sum;
    sum += (sums[0] + sums[1]) + (sums[2] + sums[3]);
  }
  rgb[0] = sum_of_lanes(lanes.red);
  rgb[1] = sum_of_lanes(lanes.green);
  rgb[2] = sum_of_lanes(lanes.blue);
  if (s < sectors) *block_start++ = sum;
  for (; s < sectors; ++s) {  // the last, shorter block
    const float r = in.red[s] * in.solid_angle[s];
    const float g = in.green[s] * in.solid_angle[s];
    const float b = in.blue[s] * in.solid_angle[s];
    rgb[0] += static_cast<double>(r);
    rgb[1] += static_cast<double>(g);
    rgb[2] += static_cast<double>(b);
    power[s] = least(kMono ? r : 0.2126f * r + 0.7152f * g + 0.0722f * b, kLargestPower);
    sum += static_cast<double>(power[s]);
  }
  if (kMono) rgb[0] = rgb[1] = rgb[2] = sum;
  *ring_power = sum;
}

void weigh_ring(const RingPlanes& in, bool mono, int sectors, float* power, double* block_start,
                double* ring_power, double* rgb) {
  if (mono)
    weigh_ring_of<true>(in, sectors, power, block_start, ring_power, rgb);
  else
    weigh_ring_of<false>(in, sectors, power, block_start, ring_power, rgb);
}

// ---- Inverse of the cumulative sums. A search counts how many of eight or sixteen starts lie at or below the target, in
// steps that wait for nothing but the one before, so several lights are on their way at once.

// How many lanes are at or below the limit.
LIGHTWELL_INLINE int lanes_at_or_below(const Doubles4& v, const Doubles4& limit) {
  const Longs4 below = v <= limit;  // a true lane is −1
#if defined(__AVX2__)
  return __builtin_popcount(static_cast<unsigned>(_mm256_movemask_pd(reinterpret_cast<__m256d>(below))));
#else
  using Longs2 = long long __attribute__((vector_size(16)));
  const Longs2 sum =
      __builtin_shufflevector(below, below, 0, 1) + __builtin_shufflevector(below, below, 2, 3);
  return -static_cast<int>(sum[0] + sum[1]);
#endif
}

LIGHTWELL_INLINE int at_or_below(const double* sorted, int quads, double target) {
  const Doubles4 limit = Doubles4{} + target;
  int count = 0;
  for (int q = 0; q < quads; ++q) {
    Doubles4 v;
    load(v, sorted + 4 * q);
    count += lanes_at_or_below(v, limit);
  }
  return count;
}

// Always a ring with power.
LIGHTWELL_INLINE RingPlace find_ring(const RingTables& map, double t) {
  const double target = t * map.total_power;
  const int first = kRingGroup * most(at_or_below(map.ring_group, map.ring_groups / 4, target) - 1, 0);
  const int quads = least(kRingGroup, (map.rings + 3) / 4 * 4 - first) / 4;
  int ring = held(first + at_or_below(map.ring_start + first, quads, target) - 1, 0, map.rings - 1);
  while (ring > 0 && map.ring_power[ring] <= 0) --ring;
  const double power = map.ring_power[ring];
  return {ring, power > 0 ? held((target - map.ring_start[ring]) / power, 0.0, 1.0) : 0.5};
}

LIGHTWELL_INLINE double blended(const RingBlend& blend, const double* of_rings) {
  return blend.weight_a * of_rings[blend.a] + blend.weight_b * of_rings[blend.b];
}

template <Blending kBlending>
LIGHTWELL_INLINE RingBlend blend_with(const RingTables& map, const RingPlace& ring) {
  RingBlend blend = {ring.ring, ring.ring, 1, 0, 0};
  if constexpr (kBlending != Blending::own) {
    // Distance from the middle of the ring, and the ring on that side (none beyond the zenith and the edge).
    const double away = ring.fraction - 0.5;
    blend.b = held(ring.ring + (away < 0 ? -1 : 1), 0, map.rings - 1);
    blend.weight_b = blend.b == ring.ring ? 0 : (away < 0 ? -away : away);
    blend.weight_a = 1 - blend.weight_b;
  }
  if constexpr (kBlending == Blending::printed) {
    // Each ring's distribution normalised; a black ring's is even.
    const double own = map.ring_power[blend.a], other = map.ring_power[blend.b];
    blend.uniform = ((own > 0 ? 0 : blend.weight_a) + (other > 0 ? 0 : blend.weight_b)) / map.sectors;
    blend.weight_a = own > 0 ? blend.weight_a / own : 0;
    blend.weight_b = other > 0 ? blend.weight_b / other : 0;
  } else if (blended(blend, map.ring_power) <= 0) {
    blend = {ring.ring, ring.ring, 0, 0, 1};
  }
  return blend;
}

RingBlend blend(const RingTables& map, Blending blending, const RingPlace& ring) {
  switch (blending) {
    case Blending::own:
      return blend_with<Blending::own>(map, ring);
    case Blending::by_power:
      return blend_with<Blending::by_power>(map, ring);
    case Blending::printed:
      return blend_with<Blending::printed>(map, ring);
  }
  __builtin_unreachable();
}

// How many of 4 · quads starts of the blend are at or below the target; they are `apart` sectors from each other.
template <bool kUniform>
LIGHTWELL_INLINE int starts_at_or_below(const RingBlend& blend, const double* a, const double* b, int quads,
                                        double sectors, double apart, double target) {
  const Doubles4 limit = Doubles4{} + target;
  int count = 0;
  for (int q = 0; q < quads; ++q) {
    Doubles4 start_a, start_b;
    load(start_a, a + 4 * q);
    load(start_b, b + 4 * q);
    Doubles4 start = blend.weight_a * start_a + blend.weight_b * start_b;
    if constexpr (kUniform) {
      const double at = sectors + 4 * q * apart;
      start += blend.uniform * Doubles4{at, at + apart, at + 2 * apart, at + 3 * apart};
    }
    count += lanes_at_or_below(start, limit);
  }
  return count;
}

LIGHTWELL_INLINE double bin_power(const RingTables& map, const RingBlend& blend, int sector) {
  const int stride = map.blocks * kBlock;
  return blend.weight_a * static_cast<double>(map.power[blend.a * stride + sector]) +
         blend.weight_b * static_cast<double>(map.power[blend.b * stride + sector]) + blend.uniform;
}

// The target lies beyond what the block holds by a rounding error: the end of the last sector that has power. (By value:
// a reference would keep the lights of the loop around it in memory.)
__attribute__((noinline)) SectorPlace last_sector_with_power(const RingTables& map, RingBlend blend,
                                                             int from) {
  for (int s = from; s >= 0; --s)
    if (bin_power(map, blend, s) > 0) return {s, 1};
  for (int s = from + 1; s < map.sectors; ++s)
    if (bin_power(map, blend, s) > 0) return {s, 0};
  return {from, 0.5};
}

// Each lane becomes the sum of itself and those before it. In Sklansky's order: a half's running sums, then the lower
// half's whole added to each of the upper's. A sum so never falls below the one before it, whatever is rounded.
LIGHTWELL_INLINE void make_running_sums(Doubles4& v) {
  const Doubles4 zero = {};
  v += __builtin_shufflevector(zero, v, 0, 4, 0, 6);
  v += __builtin_shufflevector(zero, v, 0, 1, 5, 5);
}

// The blend's powers of four sectors.
LIGHTWELL_INLINE void blended_powers(const RingBlend& blend, const float* a, const float* b,
                                     Doubles4& power) {
  Floats4 floats;
  Doubles4 power_b;
  load(floats, a);
  to_doubles(floats, power);
  load(floats, b);
  to_doubles(floats, power_b);
  power = blend.weight_a * power + blend.weight_b * power_b + blend.uniform;
}

// rest: the target less the block's start
LIGHTWELL_INLINE SectorPlace find_in_block(const RingTables& map, int block, double rest,
                                           const RingBlend& blend) {
  static_assert(kBlock == 8);
  const float* a = map.power + (blend.a * map.blocks + block) * kBlock;
  const float* b = map.power + (blend.b * map.blocks + block) * kBlock;
  Doubles4 low, high;
  blended_powers(blend, a, b, low);
  blended_powers(blend, a + 4, b + 4, high);
  double power[kBlock];
  store(power, low);
  store(power + 4, high);
  make_running_sums(low);
  make_running_sums(high);
  high += low[3];
  double sum[kBlock + 1];
  sum[0] = 0;
  store(sum + 1, low);
  store(sum + 5, high);
  const Doubles4 limit = Doubles4{} + rest;
  const int passed = lanes_at_or_below(low, limit) + lanes_at_or_below(high, limit);
  const int sector = block * kBlock + passed;
  if (passed == kBlock || sector >= map.sectors)
    return last_sector_with_power(map, blend, least(sector, map.sectors) - 1);
  return {sector, held((rest - sum[passed]) / power[passed], 0.0, 1.0)};
}

constexpr int kTogether = 16;

// A block of the blend's sectors, and what of the target is left at its start.
struct BlockPlace {
  int block;
  double rest;
};

template <bool kUniform>
LIGHTWELL_INLINE BlockPlace find_block(const RingTables& map, double target, const RingBlend& blend) {
  const double* group_a = map.group_start + blend.a * map.group_stride;
  const double* group_b = map.group_start + blend.b * map.group_stride;
  const int groups =
      starts_at_or_below<kUniform>(blend, group_a, group_b, map.group_stride / 4, 0, kBlock * kBlock, target);
  const int first = kBlock * held(groups - 1, 0, map.groups - 1);
  const double* a = map.block_start + blend.a * map.groups * kBlock;
  const double* b = map.block_start + blend.b * map.groups * kBlock;
  const int blocks =
      starts_at_or_below<kUniform>(blend, a + first, b + first, 2, first * kBlock, kBlock, target);
  const int block = held(first + blocks - 1, first, map.blocks - 1);
  double start = blend.weight_a * a[block] + blend.weight_b * b[block];
  if constexpr (kUniform) start += blend.uniform * (block * kBlock);
  return {block, target - start};
}

inline double target(const RingTables& map, const Seam& seam, const RingBlend& blend, double s) {
  const double power = blended(blend, map.ring_power) + blend.uniform * map.sectors;
  const double after = s - seam.offset;
  const double reached = blended(blend, seam.ring_power) + blend.uniform * seam.sectors +
                         (after < 0 ? after + 1 : after) * power;
  return reached >= power ? reached - power : reached;
}

// Some lights side by side, step by step: a step's lights do not wait for each other, as one light's steps do.
template <Blending kBlending>
LIGHTWELL_INLINE void locate_together(const RingTables& map, const Seam& seam, const Point* points, int count,
                                      MapPlace* places) {
  constexpr bool kUniform = kBlending == Blending::printed;
  RingPlace rings[kTogether];
  RingBlend blends[kTogether];
  BlockPlace blocks[kTogether];
  for (int i = 0; i < count; ++i) rings[i] = find_ring(map, points[i].t);
  for (int i = 0; i < count; ++i) blends[i] = blend_with<kBlending>(map, rings[i]);
  for (int i = 0; i < count; ++i)
    blocks[i] = find_block<kUniform>(map, target(map, seam, blends[i], points[i].s), blends[i]);
  for (int i = 0; i < count; ++i) {
    places[i].sector = find_in_block(map, blocks[i].block, blocks[i].rest, blends[i]);
    places[i].neighbour = blends[i].b;
    places[i].ring.ring = rings[i].ring;
    places[i].ring.fraction = rings[i].fraction;
  }
}

template <Blending kBlending>
LIGHTWELL_INLINE void locate_with(const RingTables& tables, const Seam& seam, const Point* points, int count,
                                  MapPlace* places) {
  const RingTables map = tables;  // a copy: nothing that is written can change it
  int i = 0;
  for (; i + kTogether <= count; i += kTogether)
    locate_together<kBlending>(map, seam, points + i, kTogether, places + i);
  if (i < count) locate_together<kBlending>(map, seam, points + i, count - i, places + i);
}

void locate(const RingTables& map, const Seam& seam, Blending blending, const Point* points, int count,
            MapPlace* places) {
  switch (blending) {
    case Blending::own:
      return locate_with<Blending::own>(map, seam, points, count, places);
    case Blending::by_power:
      return locate_with<Blending::by_power>(map, seam, points, count, places);
    case Blending::printed:
      return locate_with<Blending::printed>(map, seam, points, count, places);
  }
}

// ---- Directions

// Sine and cosine of a part of a turn in [0, 1], branch-free so that the compiler makes vectors of it.
// Taylor polynomials on an eighth of a turn either side: their error is below 3e-8, half of float's own step.
LIGHTWELL_INLINE void sine_cosine(float turns, float& sine, float& cosine) {
  const int quadrant = static_cast<int>(turns * 4 + 0.5f);
  const float x = (turns - 0.25f * static_cast<float>(quadrant)) * 6.28318530718f;
  const float q = x * x;
  const float sx = x * (1 + q * (-1.0f / 6 + q * (1.0f / 120 + q * (-1.0f / 5040 + q * (1.0f / 362880)))));
  const float cx = 1 + q * (-0.5f + q * (1.0f / 24 + q * (-1.0f / 720 + q * (1.0f / 40320))));
  const bool swap = (quadrant & 1) != 0;
  const float s = swap ? cx : sx;
  const float c = swap ? sx : cx;
  sine = (quadrant & 2) != 0 ? -s : s;
  cosine = ((quadrant + 1) & 2) != 0 ? -c : c;
}

void directions(float* __restrict x, float* __restrict y, float* __restrict z, int count) {
  for (int i = 0; i < count; ++i) {
    const float height = x[i];
    float sine = 0, cosine = 0;
    sine_cosine(y[i], sine, cosine);
    const float sin_theta = __builtin_sqrtf(most(height * (2 - height), 0.0f));
    x[i] = sin_theta * sine;
    y[i] = 1 - height;
    z[i] = sin_theta * cosine;
  }
}

void settle_directions(float* __restrict x, float* __restrict y, float* __restrict z,
                       float* __restrict last_x, float* __restrict last_y, float* __restrict last_z,
                       int count, float edge_cosine, float edge_sine) {
  constexpr float kShortest = 0.05f;
  for (int i = 0; i < count; ++i) {
    const float length = __builtin_sqrtf(x[i] * x[i] + y[i] * y[i] + z[i] * z[i]);
    const float scale = 1 / most(length, kShortest);
    const float horizontal = __builtin_sqrtf(x[i] * x[i] + z[i] * z[i]);
    const bool below = y[i] * scale < edge_cosine;
    // Straight down there is no azimuth to keep. (No short circuits: the loop is to become vectors.)
    const bool keep = (length < kShortest) | (below & (horizontal < 1e-6f));
    const float flat_scale = below ? edge_sine / most(horizontal, 1e-6f) : scale;
    const float nx = x[i] * flat_scale;
    const float ny = below ? edge_cosine : y[i] * scale;
    const float nz = z[i] * flat_scale;
    const float kx = last_x[i], ky = last_y[i], kz = last_z[i];
    last_x[i] = x[i] = keep ? kx : nx;
    last_y[i] = y[i] = keep ? ky : ny;
    last_z[i] = z[i] = keep ? kz : nz;
  }
}

// ---- Filters: sixteen lights at a time stay in registers while the frames pass by.

template <class Vector, bool kWithinRange>
LIGHTWELL_INLINE void filter_at(const float* const* past, const float* taps, int taps_count, int at,
                                float* out) {
  Vector sum = {}, low, high, v;
  load(low, past[0] + at);
  high = low;
  for (int k = 0; k < taps_count; ++k) {
    load(v, past[k] + at);
    sum += taps[k] * v;
    if constexpr (kWithinRange) {
      low = v < low ? v : low;
      high = high < v ? v : high;
    }
  }
  if constexpr (kWithinRange) {
    sum = sum < low ? low : sum;
    sum = high < sum ? high : sum;
  }
  store(out + at, sum);
}

template <bool kWithinRange>
LIGHTWELL_INLINE void filter_with(const float* const* past, const float* taps, int taps_count, int count,
                                  float* out) {
  using Floats1 = float __attribute__((vector_size(4)));
  int i = 0;
  for (; i + 8 <= count; i += 8) filter_at<Floats8, kWithinRange>(past, taps, taps_count, i, out);
  for (; i < count; ++i) filter_at<Floats1, kWithinRange>(past, taps, taps_count, i, out);
}

void filter(const float* const* past, const float* taps, int taps_count, int count, float* out) {
  filter_with<false>(past, taps, taps_count, count, out);
}

void filter_within_range(const float* const* past, const float* taps, int taps_count, int count, float* out) {
  filter_with<true>(past, taps, taps_count, count, out);
}

#undef LIGHTWELL_INLINE

}  // namespace
}  // namespace lightwell::light_kernel
