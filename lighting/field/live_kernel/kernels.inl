// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// The kernels' one text, included by a file for each instruction set. In the vector extension that GCC and Clang share, as
// wide as the machine's registers: of wider ones GCC makes loads and stores in memory, eight times slower.
namespace lightwell::live_kernel {
namespace {

#if defined(LIGHTWELL_AVX2_KERNELS)
constexpr int kWidth = 8;
#else
constexpr int kWidth = 4;
#endif
static_assert(kLanes % kWidth == 0);
using Floats = float __attribute__((vector_size(4 * kWidth)));
// The same at any address.
struct Anywhere {
  Floats v;
} __attribute__((packed, may_alias));

inline __attribute__((always_inline)) void load(Floats& v, const float* p) {
  v = reinterpret_cast<const Anywhere*>(p)->v;
}
inline __attribute__((always_inline)) void store(float* p, const Floats& v) {
  reinterpret_cast<Anywhere*>(p)->v = v;
}

void interpolate(const float* weights, int pixels, int rays, const float* values, float* out) {
  for (int p = 0; p < pixels; p += kWidth) {
    Floats sum = Floats{}, weight;
    for (int n = 0; n < rays; ++n) {
      load(weight, weights + n * pixels + p);
      sum += weight * values[n];
    }
    store(out + p, sum > 0.0f ? sum : Floats{});
  }
}

void look_up(const Run& run, float* out) {
  const float* upper = run.pixels;
  const float* lower = upper + run.width;
  int i = 0;
  if (run.stride == 1)
    for (; i + kWidth <= run.count; i += kWidth) {
      Floats a, b, c, d;
      load(a, upper + i);
      load(b, upper + i + 1);
      load(c, lower + i);
      load(d, lower + i + 1);
      store(out + i, run.weight[0] * a + run.weight[1] * b + run.weight[2] * c + run.weight[3] * d);
    }
  for (; i < run.count; ++i)
    out[i * run.stride] = run.weight[0] * upper[i] + run.weight[1] * upper[i + 1] + run.weight[2] * lower[i] +
                          run.weight[3] * lower[i + 1];
}

// `kRows` harmonics at two registers of points: as many sums as a machine of sixteen registers holds beside its inputs.
template <int kRows>
inline __attribute__((always_inline)) void project_rows(const float* radiance, int stride, int directions,
                                                        const float* harmonics, int count, int points,
                                                        float* out) {
  Floats low[kRows], high[kRows];
  for (int h = 0; h < kRows; ++h) {
    load(low[h], out + h * points);
    load(high[h], out + h * points + kWidth);
  }
  for (int d = 0; d < directions; ++d) {
    Floats a, b;
    load(a, radiance + d * stride);
    load(b, radiance + d * stride + kWidth);
    for (int h = 0; h < kRows; ++h) {
      const float y = harmonics[d * count + h];
      low[h] += y * a;
      high[h] += y * b;
    }
  }
  for (int h = 0; h < kRows; ++h) {
    store(out + h * points, low[h]);
    store(out + h * points + kWidth, high[h]);
  }
}

inline __attribute__((always_inline)) void project_one(const float* radiance, int stride, int directions,
                                                       const float* harmonics, int count, float* out) {
  Floats sum, a;
  load(sum, out);
  for (int d = 0; d < directions; ++d) {
    load(a, radiance + d * stride);
    sum += harmonics[d * count] * a;
  }
  store(out, sum);
}

void project(const float* radiance, int stride, int directions, const float* harmonics, int count, int points,
             float* out) {
  constexpr int kRows = 5;  // a degree of 4 has 25
  int p = 0;
  for (; p + 2 * kWidth <= points; p += 2 * kWidth) {
    int h = 0;
    for (; h + kRows <= count; h += kRows)
      project_rows<kRows>(radiance + p, stride, directions, harmonics + h, count, points,
                          out + h * points + p);
    for (; h < count; ++h)
      project_rows<1>(radiance + p, stride, directions, harmonics + h, count, points, out + h * points + p);
  }
  for (; p < points; p += kWidth)
    for (int h = 0; h < count; ++h)
      project_one(radiance + p, stride, directions, harmonics + h, count, out + h * points + p);
}

}  // namespace
}  // namespace lightwell::live_kernel
