// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// The kernels' one text, included by a file for each instruction set. In the vector extension that GCC and Clang share;
// a machine whose registers are narrower takes several steps.
namespace lightwell::placement_kernel {
namespace {

using Floats = float __attribute__((vector_size(32)));
using Ints = int __attribute__((vector_size(32)));
using Floats4 = float __attribute__((vector_size(16)));
using Doubles = double __attribute__((vector_size(32)));

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

LIGHTWELL_INLINE void root(const Floats& q, Floats& r) {
#if defined(LIGHTWELL_AVX2_KERNELS)
  r = _mm256_sqrt_ps(q);
#else
  for (int lane = 0; lane < kLanes; ++lane) r[lane] = __builtin_sqrtf(q[lane]);
#endif
}

LIGHTWELL_INLINE double sum(const Floats& v) {
  const Floats4 low = __builtin_shufflevector(v, v, 0, 1, 2, 3);
  const Floats4 high = __builtin_shufflevector(v, v, 4, 5, 6, 7);
  const Floats4 four = low + high;
  return static_cast<double>(four[0] + four[2]) + static_cast<double>(four[1] + four[3]);
}

// ---- Bins

LIGHTWELL_INLINE void light_only(Floats& v) {
  const Floats most = Floats{} + 3.402823466e38f;
  const Ints good = (v > 0.0f) & (v <= most);
  v = reinterpret_cast<Floats>(reinterpret_cast<const Ints&>(v) & good);
}

LIGHTWELL_INLINE void add_bins(const RingPlanes& ring, int k, float sine, float cosine, const ColumnSums& out) {
  Floats omega, r, g, b, sum_r, sum_g, sum_b, across, up;
  load(omega, ring.solid_angle + k);
  load(r, ring.red + k);
  load(g, ring.green + k);
  load(b, ring.blue + k);
  load(sum_r, out.red + k);
  load(sum_g, out.green + k);
  load(sum_b, out.blue + k);
  load(across, out.across + k);
  load(up, out.up + k);
  light_only(r);
  light_only(g);
  light_only(b);
  r *= omega;
  g *= omega;
  b *= omega;
  const Floats y = 0.2126f * r + 0.7152f * g + 0.0722f * b;
  store(out.red + k, sum_r + r);
  store(out.green + k, sum_g + g);
  store(out.blue + k, sum_b + b);
  store(out.across + k, across + y * sine);
  store(out.up + k, up + y * cosine);
}

void add_ring(const RingPlanes& ring, int sectors, float sine, float cosine, const ColumnSums& out) {
  int k = 0;
  for (; k + kLanes <= sectors; k += kLanes) add_bins(ring, k, sine, cosine, out);
  const auto lit = [](float v) { return v > 0.0f && v <= 3.402823466e38f ? v : 0.0f; };
  for (; k < sectors; ++k) {
    const float omega = ring.solid_angle[k];
    const float r = lit(ring.red[k]) * omega, g = lit(ring.green[k]) * omega, b = lit(ring.blue[k]) * omega;
    const float y = 0.2126f * r + 0.7152f * g + 0.0722f * b;
    out.red[k] += r;
    out.green[k] += g;
    out.blue[k] += b;
    out.across[k] += y * sine;
    out.up[k] += y * cosine;
  }
}

// ---- Pairs of points and places

struct Place {
  float x, y, z, s;
};
LIGHTWELL_INLINE Place place(const Points& at, int i) {
  return {at.x[i], at.y[i], at.z[i], at.s[i]};
}

// Differences of coordinates, not a dot product: near a point 1 − cos cancels.
LIGHTWELL_INLINE void pair(const Points& from, int k, const Place& at, const Shares& shares, Floats& distance,
                           Floats& share) {
  Floats x, y, z, s;
  load(x, from.x + k);
  load(y, from.y + k);
  load(z, from.z + k);
  load(s, from.s + k);
  x -= at.x;
  y -= at.y;
  z -= at.z;
  root(x * x + y * y + z * z + shares.softening2, distance);
  share = s * (shares.ground * at.s) + shares.plain;
}

constexpr int kChunk = 256;  // points summed in float before double takes over

void potentials(const Points& from, const float* const weight[3], const Shares& shares, const Points& at,
                double* const out[3]) {
  for (int i = 0; i < at.count; ++i) {
    const Place here = place(at, i);
    double red = 0, green = 0, blue = 0;
    for (int begin = 0; begin < from.count; begin += kChunk) {
      const int end = begin + kChunk < from.count ? begin + kChunk : from.count;
      Floats r = {}, g = {}, b = {};
      for (int k = begin; k < end; k += kLanes) {
        Floats distance, share, w;
        pair(from, k, here, shares, distance, share);
        const Floats value = share * (3.0f - distance);
        load(w, weight[0] + k);
        r += w * value;
        load(w, weight[1] + k);
        g += w * value;
        load(w, weight[2] + k);
        b += w * value;
      }
      red += sum(r);
      green += sum(g);
      blue += sum(b);
    }
    out[0][i] = red;
    out[1][i] = green;
    out[2][i] = blue;
  }
}

void potential(const Points& from, const float* weight, const Shares& shares, const Points& at, double* out) {
  for (int i = 0; i < at.count; ++i) {
    const Place here = place(at, i);
    double total = 0;
    for (int begin = 0; begin < from.count; begin += kChunk) {
      const int end = begin + kChunk < from.count ? begin + kChunk : from.count;
      Floats part = {};
      for (int k = begin; k < end; k += kLanes) {
        Floats distance, share, w;
        pair(from, k, here, shares, distance, share);
        load(w, weight + k);
        part += w * (share * (3.0f - distance));
      }
      total += sum(part);
    }
    out[i] = total;
  }
}

// d/da of (plain + ground s_a s_b)(3 − |a − b|): −share (a − b)/|a − b|, and ground s_b (3 − |a − b|) times the slope of
// s_a, which the caller knows: it comes as the fourth value.
void gradient(const Points& from, const float* weight, const Shares& shares, const Points& at, double* out) {
  for (int i = 0; i < at.count; ++i) {
    const Place here = place(at, i);
    double sums[4] = {0, 0, 0, 0};
    for (int begin = 0; begin < from.count; begin += kChunk) {
      const int end = begin + kChunk < from.count ? begin + kChunk : from.count;
      Floats fx = {}, fy = {}, fz = {}, fs = {};
      for (int k = begin; k < end; k += kLanes) {
        Floats x, y, z, s, w, distance;
        load(x, from.x + k);
        load(y, from.y + k);
        load(z, from.z + k);
        load(s, from.s + k);
        load(w, weight + k);
        x -= here.x;
        y -= here.y;
        z -= here.z;
        root(x * x + y * y + z * z + shares.softening2, distance);
        const Floats pull = w * (s * (shares.ground * here.s) + shares.plain) / distance;
        fx += pull * x;
        fy += pull * y;
        fz += pull * z;
        fs += w * s * (3.0f - distance);
      }
      sums[0] += sum(fx);
      sums[1] += sum(fy);
      sums[2] += sum(fz);
      sums[3] += sum(fs);
    }
    for (int c = 0; c < 4; ++c) out[4 * i + c] = sums[c];
  }
}

void nearest(const Points& from, const Points& places, int* index, float* distance) {
  for (int k = 0; k < from.count; k += kLanes) {
    Floats x, y, z;
    load(x, from.x + k);
    load(y, from.y + k);
    load(z, from.z + k);
    Floats least = Floats{} + 8.0f;
    Ints which = {};
    for (int i = 0; i < places.count; ++i) {
      const Floats dx = x - places.x[i], dy = y - places.y[i], dz = z - places.z[i];
      const Floats q = dx * dx + dy * dy + dz * dz;
      const Ints closer = q < least;
      least = closer ? q : least;
      which = closer ? Ints{} + i : which;
    }
    Floats r;
    root(least, r);
    store(index + k, which);
    store(distance + k, r);
  }
}

void add_moments(const Points& from, const float* const weight[3], double* moments) {
  // A_l · Y_lm, real and orthonormal, of degrees 0, 1, 2 and 4; textbook (x, y, z) = our (z, x, y).
  constexpr float a0 = 0.886226925f, a1 = 1.023326708f, a2 = 0.858085531f;
  constexpr float a4 = -0.055389183f;  // −π/24 · ¾ · √(1/π)
  constexpr float s3 = 1.7320508076f, s5 = 2.2360679775f, s35 = 5.9160797831f, r2 = 1.4142135624f;
  for (int begin = 0; begin < from.count; begin += kChunk) {
    const int end = begin + kChunk < from.count ? begin + kChunk : from.count;
    for (int c = 0; c < 3; ++c) {
      Floats part[kMoments] = {};
      for (int k = begin; k < end; k += kLanes) {
        Floats x, y, z, w;
        load(x, from.z + k);
        load(y, from.x + k);
        load(z, from.y + k);
        load(w, weight[c] + k);
        const Floats xx = x * x, yy = y * y, zz = z * z, xy = x * y, yz = y * z, xz = x * z;
        part[0] += w * a0;
        part[1] += w * (a1 * y);
        part[2] += w * (a1 * z);
        part[3] += w * (a1 * x);
        part[4] += w * (a2 * xy);
        part[5] += w * (a2 * yz);
        part[6] += w * (a2 / (2 * s3) * (3 * zz - 1));
        part[7] += w * (a2 * xz);
        part[8] += w * (a2 / 2 * (xx - yy));
        part[9] += w * (a4 * s35 * xy * (xx - yy));
        part[10] += w * (a4 * s35 / r2 * yz * (3 * xx - yy));
        part[11] += w * (a4 * s5 * xy * (7 * zz - 1));
        part[12] += w * (a4 * s5 / r2 * yz * (7 * zz - 3));
        part[13] += w * (a4 / 4 * (35 * zz * zz - 30 * zz + 3));
        part[14] += w * (a4 * s5 / r2 * xz * (7 * zz - 3));
        part[15] += w * (a4 * s5 / 2 * (xx - yy) * (7 * zz - 1));
        part[16] += w * (a4 * s35 / r2 * xz * (xx - 3 * yy));
        part[17] += w * (a4 * s35 / 4 * (xx * (xx - 3 * yy) - yy * (3 * xx - yy)));
      }
      for (int m = 0; m < kMoments; ++m) moments[3 * m + c] += sum(part[m]);
    }
  }
}

// ---- Matrices

void multiply(const double* matrix, int rows, int stride, const double* in, double* out) {
  for (int i = 0; i < rows; ++i) {
    const double* row = matrix + static_cast<long>(i) * stride;
    Doubles total = {}, more = {};
    int k = 0;
    for (; k + 8 <= stride; k += 8) {
      Doubles a, b, c, d;
      load(a, row + k);
      load(b, in + k);
      load(c, row + k + 4);
      load(d, in + k + 4);
      total += a * b;
      more += c * d;
    }
    for (; k < stride; k += 4) {
      Doubles a, b;
      load(a, row + k);
      load(b, in + k);
      total += a * b;
    }
    total += more;
    out[i] = (total[0] + total[2]) + (total[1] + total[3]);
  }
}

void add_outer(double* matrix, int rows, int stride, double factor, const double* a, const double* b) {
  for (int i = 0; i < rows; ++i) {
    const double scale = factor * a[i];
    if (scale == 0) continue;
    double* row = matrix + static_cast<long>(i) * stride;
    for (int k = 0; k < stride; k += 4) {
      Doubles m, v;
      load(m, row + k);
      load(v, b + k);
      store(row + k, m + scale * v);
    }
  }
}

int best_to_leave(const double* by_inverse, const double* t, const double* inverse_pivot, const double* price, int stride,
                  double residual, double complement, double* least) {
  using Longs = long long __attribute__((vector_size(32)));
  Doubles most = Doubles{} + *least;
  Longs which = Longs{} - 1;
  for (int i = 0; i < stride; i += 4) {
    Doubles h, step, inverse, cost;
    load(h, by_inverse + i);
    load(step, t + i);
    load(inverse, inverse_pivot + i);
    load(cost, price + i);
    const Doubles r = h * step + residual;
    const Doubles net = r * r / (h * h * inverse + complement) - cost;
    const Longs better = (net > most) & (r > 0.0);
    most = better ? net : most;
    which = better ? Longs{i, i + 1, i + 2, i + 3} : which;
  }
  int best = -1;
  for (int lane = 0; lane < 4; ++lane)
    if (which[lane] >= 0 && (most[lane] > *least || (most[lane] == *least && which[lane] < best))) {
      *least = most[lane];
      best = static_cast<int>(which[lane]);
    }
  return best;
}

// Four rows by eight columns at a time stay in registers.
void multiply_rows(const double* left, int rows, const double* symmetric, int stride, double* out) {
  for (int row = 0; row < rows; row += 4) {
    const int group = rows - row < 4 ? rows - row : 4;
    const double* in[4];
    for (int k = 0; k < 4; ++k) in[k] = left + static_cast<long>(row + (k < group ? k : 0)) * stride;
    for (int column = 0; column < stride; column += 8) {
      const bool wide = column + 4 < stride;
      Doubles total[4][2] = {};
      for (int j = 0; j < stride; ++j) {
        Doubles first, second = {};
        load(first, symmetric + static_cast<long>(j) * stride + column);
        if (wide) load(second, symmetric + static_cast<long>(j) * stride + column + 4);
        for (int k = 0; k < 4; ++k) {
          total[k][0] += in[k][j] * first;
          total[k][1] += in[k][j] * second;
        }
      }
      for (int k = 0; k < group; ++k) {
        double* to = out + static_cast<long>(row + k) * stride + column;
        store(to, total[k][0]);
        if (wide) store(to + 4, total[k][1]);
      }
    }
  }
}

}  // namespace
}  // namespace lightwell::placement_kernel
