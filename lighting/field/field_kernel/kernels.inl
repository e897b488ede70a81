// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// Included by every instruction set's file, behind kernel.h.

namespace lightwell::field_kernel {
namespace {

// Vectors of GCC and Clang: eight lanes on every machine, in one register or two.
typedef float Wide __attribute__((vector_size(4 * kLanes)));
typedef int Mask __attribute__((vector_size(4 * kLanes)));

constexpr float kFar = 1e35F;   // squared: farther than any ray, nearer than kNowhere
constexpr float kHuge = 3e38F;  // more than any number
// Of the squared support: far below the spread of rays all around (a tenth), far above that of a line.
constexpr float kSlopeRidge = 3e-4F;

inline Wide load(const float* from) {
  Wide value;
  __builtin_memcpy(&value, from, sizeof value);
  return value;
}
inline void store(const Wide& value, float* to) {
  __builtin_memcpy(to, &value, sizeof value);
}
inline Wide all(float value) {
  return Wide{value, value, value, value, value, value, value, value};
}
inline Wide where(const Mask& mask, const Wide& value) {
  return (Wide)((Mask)value & mask);
}
inline Wide choose(const Mask& mask, const Wide& yes, const Wide& no) {
  return (Wide)(((Mask)yes & mask) | ((Mask)no & ~mask));
}
inline Wide least(const Wide& a, const Wide& b) {
  return choose(a < b, a, b);
}
inline Wide most(const Wide& a, const Wide& b) {
  return choose(a > b, a, b);
}
// Lanes in one order, whatever the machine.
inline float sum(const Wide& v) {
  return ((v[0] + v[4]) + (v[2] + v[6])) + ((v[1] + v[5]) + (v[3] + v[7]));
}
inline float least(const Wide& v) {
  float value = v[0];
  for (int i = 1; i < kLanes; ++i) value = v[i] < value ? v[i] : value;
  return value;
}
inline float most(const Wide& v) {
  float value = v[0];
  for (int i = 1; i < kLanes; ++i) value = v[i] > value ? v[i] : value;
  return value;
}

int within(const Rays& from, int count, float x, float y, float square_distance, const Rays& to, int at) {
  for (int i = 0; i < count; ++i) {
    const float dx = from.x[i] - x, dy = from.y[i] - y;
    to.x[at] = from.x[i];
    to.y[at] = from.y[i];
    to.red[at] = from.red[i];
    to.green[at] = from.green[i];
    to.blue[at] = from.blue[i];
    at += dx * dx + dy * dy <= square_distance ? 1 : 0;
  }
  return at;
}

void measure(const Rays& rays, int count, float x, float y, float* squares) {
  const Wide at_x = all(x), at_y = all(y);
  for (int i = 0; i < count; i += kLanes) {
    const Wide dx = load(rays.x + i) - at_x, dy = load(rays.y + i) - at_y;
    store(dx * dx + dy * dy, squares + i);
  }
}

int count_below(const float* squares, int count, float bound) {
  const Wide limit = all(bound);
  Mask below = {};
  for (int i = 0; i < count; i += kLanes) below -= load(squares + i) < limit;
  int total = 0;
  for (int i = 0; i < kLanes; ++i) total += below[i];
  return total;
}

float least_from(const float* squares, int count, float bound) {
  const Wide limit = all(bound);
  Wide value = all(kHuge);
  for (int i = 0; i < count; i += kLanes) {
    const Wide square = load(squares + i);
    value = choose(square >= limit, least(square, value), value);
  }
  return least(value);
}

// The order statistic by halving an interval, and by how rays lie evenly: their number grows with the squared distance.
float order_statistic(const float* squares, int count, int nearer, float guess) {
  float low = 0, high = kFar, middle = guess;
  for (bool halve = false;; halve = !halve) {
    const int below = count_below(squares, count, middle);
    if (below == nearer) return least_from(squares, count, middle);
    (below < nearer ? low : high) = middle;
    const float even =
        below > 0 ? middle * (static_cast<float>(nearer) + 0.5F) / static_cast<float>(below) : 4 * middle;
    middle = !halve && even > low && even < high ? even : high == kFar ? 4 * middle : low + (high - low) / 2;
    if (!(middle > low && middle < high))
      return least_from(squares, count, low);  // several rays at one distance
  }
}

float square_distance(const Rays& rays, int count, float x, float y, int nearer, float guess,
                      float* squares) {
  measure(rays, count, x, y, squares);
  return order_statistic(squares, count, nearer, guess);
}

// Sums over a fit's rays of one channel, by weight; x and y from the rays' centroid.
struct Products {
  float value, x, y, least, most;
};

Products products_of(const float* values, const Rays& rays, const float* weights, int count, float centroid_x,
                     float centroid_y) {
  const Wide from_x = all(centroid_x), from_y = all(centroid_y);
  Wide sum_value = {}, sum_x = {}, sum_y = {}, low = all(kHuge), high = all(-kHuge);
  for (int i = 0; i < count; i += kLanes) {
    const Wide weight = load(weights + i), value = load(values + i), weighted = weight * value;
    sum_value += weighted;
    sum_x += weighted * (load(rays.x + i) - from_x);
    sum_y += weighted * (load(rays.y + i) - from_y);
    const Mask counts = weight > Wide{};
    low = choose(counts, least(value, low), low);
    high = choose(counts, most(value, high), high);
  }
  return {sum(sum_value), sum(sum_x), sum(sum_y), least(low), most(high)};
}

// What the support of a fit is: see Fit::square_support.
float support_of(const float* squares, int count, int somewhere, int support, float guess) {
  float square = 0;
  if (somewhere > support) {
    square = order_statistic(squares, count, support, guess);
  } else {  // the farthest keeps a weight
    for (int i = 0; i < somewhere; ++i) square = squares[i] > square ? squares[i] : square;
    square *= 2;
  }
  // Rays in one place have no next one in sight: all count alike.
  return square > 1e-12F ? square : 1e-12F;
}

Fit fit(const Rays& rays, int count, int somewhere, float x, float y, int support, float guess,
        float* squares) {
  measure(rays, count, x, y, squares);
  Fit out = {0,    0, 0, least_from(squares, count, 0), support_of(squares, count, somewhere, support, guess),
             false};

  const Wide end = all(out.square_support), inverse = all(1 / out.square_support);
  const Wide at_x = all(x), at_y = all(y);
  Wide sum_weight = {}, sum_x = {}, sum_y = {};
  for (int i = 0; i < count; i += kLanes) {
    const Wide inside = (end - load(squares + i)) * inverse;
    const Wide weight = where(inside > Wide{}, inside * inside);
    store(weight, squares + i);
    sum_weight += weight;
    sum_x += weight * (load(rays.x + i) - at_x);
    sum_y += weight * (load(rays.y + i) - at_y);
  }
  const float weights = sum(sum_weight);
  out.has_weights = weights > 0;
  if (!out.has_weights) return out;
  const float scale = 1 / weights, mean_x = sum(sum_x) * scale, mean_y = sum(sum_y) * scale;

  // About the centroid, where sums of products lose no digits. A ray that is nowhere has no weight, and a place that a
  // product still holds.
  const float centroid_x = x + mean_x, centroid_y = y + mean_y;
  const Wide from_x = all(centroid_x), from_y = all(centroid_y);
  Wide sum_xx = {}, sum_xy = {}, sum_yy = {};
  for (int i = 0; i < count; i += kLanes) {
    const Wide weight = load(squares + i), dx = load(rays.x + i) - from_x, dy = load(rays.y + i) - from_y;
    sum_xx += weight * dx * dx;
    sum_xy += weight * dx * dy;
    sum_yy += weight * dy * dy;
  }
  const float ridge = kSlopeRidge * out.square_support;
  const float xx = sum(sum_xx) * scale + ridge, xy = sum(sum_xy) * scale, yy = sum(sum_yy) * scale + ridge;
  // The mean less the slope times the way to the centroid is all that is asked of the slope.
  const float determinant = scale / (xx * yy - xy * xy);
  const float back_x = (yy * mean_x - xy * mean_y) * determinant,
              back_y = (xx * mean_y - xy * mean_x) * determinant;
  const float* channels[] = {rays.red, rays.green, rays.blue};
  float* results[] = {&out.red, &out.green, &out.blue};
  for (int c = 0; c < 3; ++c) {
    const Products p = products_of(channels[c], rays, squares, count, centroid_x, centroid_y);
    const float value = p.value * scale - (back_x * p.x + back_y * p.y), beyond = (p.most - p.least) / 2;
    const float low = p.least - beyond > 0 ? p.least - beyond : 0, high = p.most + beyond;
    *results[c] = value < low ? low : value > high ? high : value;
  }
  return out;
}

// The pixels around a run's first place, and the weights that all of its places share.
struct Corners {
  const float *upper, *lower;
  float w00, w10, w01, w11;
};

Corners corners_of(const Pixels& pixels, const Run& run) {
  const auto left = static_cast<int>(run.x), top = static_cast<int>(run.y);  // neither is below 0
  const float fx = static_cast<float>(run.x - left), fy = static_cast<float>(run.y - top);
  const float* upper = pixels.first + static_cast<long>(top) * pixels.width + left;
  return {upper, upper + pixels.width, (1 - fx) * (1 - fy), fx * (1 - fy), (1 - fx) * fy, fx * fy};
}

inline Wide interpolated(const Corners& c, int at) {
  return ((c.w00 * load(c.upper + at) + c.w10 * load(c.upper + at + 1)) + c.w01 * load(c.lower + at)) +
         c.w11 * load(c.lower + at + 1);
}
inline float interpolated_one(const Corners& c, int at) {
  return ((c.w00 * c.upper[at] + c.w10 * c.upper[at + 1]) + c.w01 * c.lower[at]) + c.w11 * c.lower[at + 1];
}

void interpolate(const Pixels& pixels, const Run& run, float* to) {
  const Corners corners = corners_of(pixels, run);
  if (run.step == 1) {
    for (int i = 0; i < run.count; i += kLanes) store(interpolated(corners, i), to + i);
    return;
  }
  for (int i = 0; i < run.count; ++i) to[i] = interpolated_one(corners, i * run.step);
}

void interpolate_across(const Pixels& pixels, const Run* runs, float* to, int stride) {
  float places[kLanes][kLanes];  // [run][place]
  for (int i = 0; i < kLanes; ++i) interpolate(pixels, runs[i], places[i]);
  for (int j = 0; j < kLanes; ++j)
    for (int i = 0; i < kLanes; ++i) to[j * stride + i] = places[i][j];
}

// As many accumulators as the machine has registers for.
#if defined(__AVX2__) || defined(__aarch64__)
constexpr int kTogether = kColumn / kLanes;
#else
constexpr int kTogether = 1;
#endif

template <int harmonics>
void add_some_products(const float* values, const float* weights, int directions, int all_harmonics,
                       float* to, long stride, int points) {
  for (int first = 0; first < points; first += kTogether * kLanes) {
    Wide sums[harmonics][kTogether] = {};
    for (int d = 0; d < directions; ++d) {
      const float* here = values + d * kColumn + first;
      for (int h = 0; h < harmonics; ++h)
        for (int i = 0; i < kTogether; ++i)
          sums[h][i] += weights[d * all_harmonics + h] * load(here + i * kLanes);
    }
    for (int h = 0; h < harmonics; ++h)
      for (int i = 0; i < kTogether; ++i) {
        float* out = to + h * stride + first + i * kLanes;
        const int rest = points - first - i * kLanes;
        if (rest >= kLanes)
          store(load(out) + sums[h][i], out);
        else
          for (int p = 0; p < rest; ++p) out[p] += sums[h][i][p];
      }
  }
}

void add_products(const float* values, const float* weights, int directions, int harmonics, float* to,
                  long stride, int points) {
  int h = 0;
  for (; h + 5 <= harmonics; h += 5)
    add_some_products<5>(values, weights + h, directions, harmonics, to + h * stride, stride, points);
  for (; h < harmonics; ++h)
    add_some_products<1>(values, weights + h, directions, harmonics, to + h * stride, stride, points);
}

}  // namespace
}  // namespace lightwell::field_kernel
