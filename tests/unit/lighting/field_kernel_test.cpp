// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/field_kernel/kernel.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>
#include <vector>

#include "lighting/field/moving_least_squares.h"
#include "lighting/field/ray_list.h"

namespace lightwell {
namespace {

using field_kernel::kColumn;
using field_kernel::Kernels;
using field_kernel::kLanes;

std::vector<const Kernels*> all_kernels() {
  std::vector<const Kernels*> all = {&field_kernel::kPortableKernels};
  if (field_kernel::avx2_kernels() != nullptr) all.push_back(field_kernel::avx2_kernels());
  return all;
}

std::vector<PlaneSample> samples_of(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> along(0, 10), light(0, 5);
  std::vector<PlaneSample> samples(count);
  for (PlaneSample& s : samples) {
    s.at = {along(random), along(random)};
    s.radiance = {light(random), 1 + s.at.x(), 2};
  }
  return samples;
}

int fill(RayList& list, const std::vector<PlaneSample>& samples) {
  list.reserve(samples.size());
  const field_kernel::Rays rays = list.rays();
  for (std::size_t i = 0; i < samples.size(); ++i) {
    rays.x[i] = samples[i].at.x();
    rays.y[i] = samples[i].at.y();
    rays.red[i] = samples[i].radiance[0];
    rays.green[i] = samples[i].radiance[1];
    rays.blue[i] = samples[i].radiance[2];
  }
  return list.pad(static_cast<int>(samples.size()));
}

std::vector<float> numbers_of(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal;
  std::vector<float> numbers(count);
  for (float& n : numbers) n = normal(random);
  return numbers;
}

// The definition (lighting/field/moving_least_squares.h) in doubles, by a sort of all.
Eigen::Array3d slow_fit(const std::vector<PlaneSample>& samples, const Vec2d& at, std::size_t support) {
  std::vector<double> squares, sorted;
  for (const PlaneSample& s : samples) squares.push_back((s.at.cast<double>() - at).squaredNorm());
  sorted = squares;
  std::sort(sorted.begin(), sorted.end());
  const double end = support < sorted.size() ? sorted[support] : 2 * sorted.back();
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero(), product = normal;
  Eigen::Array3d least = Eigen::Array3d::Constant(1e30), most = -least;
  double weights = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (squares[i] >= end) continue;
    const double weight = std::pow(1 - squares[i] / end, 2);
    const Vec2d offset = samples[i].at.cast<double>() - at;
    const Vec3d basis(1, offset.x(), offset.y());
    const Eigen::Array3d radiance = samples[i].radiance.cast<double>();
    normal += weight * basis * basis.transpose();
    product += weight * basis * radiance.matrix().transpose();
    weights += weight;
    least = least.min(radiance);
    most = most.max(radiance);
  }
  normal(1, 1) += 3e-4 * end * weights;
  normal(2, 2) += 3e-4 * end * weights;
  const Eigen::Array3d value = normal.fullPivLu().solve(product).row(0).transpose().array();
  return value.max(least - (most - least) / 2).min(most + (most - least) / 2).max(0.0);
}

bool same_bits(float a, float b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

TEST(FieldKernel, OrderStatisticIsThatOfASort) {
  for (const Kernels* kernels : all_kernels())
    for (const std::size_t count : {7u, 8u, 61u, 300u}) {
      auto samples = samples_of(count, 1);
      for (std::size_t i = 0; i < count / 3; ++i) samples[i].at = samples[0].at;  // several at one distance
      RayList list;
      const int padded = fill(list, samples);
      std::vector<float> squares(static_cast<std::size_t>(padded)), sorted;
      for (const PlaneSample& s : samples) {
        const float dx = s.at.x() - 4, dy = s.at.y() - 5;
        sorted.push_back(dx * dx + dy * dy);
      }
      std::sort(sorted.begin(), sorted.end());
      for (std::size_t nearer = 0; nearer < count; nearer += 1 + count / 9)
        for (const float guess : {1e-12f, 0.5f, 1e6f})
          EXPECT_EQ(kernels->square_distance(list.rays(), padded, 4, 5, static_cast<int>(nearer), guess,
                                             squares.data()),
                    sorted[nearer]);
    }
}

TEST(FieldKernel, FitIsThatOfTheDefinition) {
  const auto samples = samples_of(200, 2);
  RayList list;
  const int padded = fill(list, samples);
  std::vector<float> squares(static_cast<std::size_t>(padded));
  for (const Kernels* kernels : all_kernels())
    for (const int support : {4, 13, 40, 199, 200, 500})
      for (float x = -3; x < 12; x += 1.3f) {
        const field_kernel::Fit fit =
            kernels->fit(list.rays(), padded, 200, x, 4.4f, support, 1, squares.data());
        const Eigen::Array3d exact =
            slow_fit(samples, Vec2d(x, static_cast<double>(4.4f)), static_cast<std::size_t>(support));
        EXPECT_TRUE(fit.has_weights);
        // Beside the rays weights are differences of squared distances that hardly differ.
        const double tolerance = x < 1 || x > 9 ? 5e-3 : 2e-5;
        EXPECT_LT((Eigen::Array3d(fit.red, fit.green, fit.blue) - exact).abs().maxCoeff(), tolerance)
            << support << " " << x;
      }
}

TEST(FieldKernel, FitsAreTheSameBitsOnEveryInstructionSet) {
  if (field_kernel::avx2_kernels() == nullptr)
    GTEST_SKIP() << "this machine has no AVX2: there is one set of kernels only";
  const auto samples = samples_of(203, 3);
  RayList list, here, there;
  const int padded = fill(list, samples);
  here.reserve(203);
  there.reserve(203);
  std::vector<float> squares(static_cast<std::size_t>(padded));
  const Kernels &portable = field_kernel::kPortableKernels, &wide = *field_kernel::avx2_kernels();
  for (const int support : {4, 9, 40})
    for (float x = 0; x < 10; x += 0.77f) {
      const int near = portable.within(list.rays(), 203, x, 5, 4, here.rays(), 0);
      EXPECT_EQ(wide.within(list.rays(), 203, x, 5, 4, there.rays(), 0), near);
      EXPECT_TRUE(std::equal(here.rays().x, here.rays().x + near, there.rays().x));
      const field_kernel::Fit a = portable.fit(list.rays(), padded, 203, x, 5, support, 2, squares.data());
      const field_kernel::Fit b = wide.fit(list.rays(), padded, 203, x, 5, support, 2, squares.data());
      EXPECT_TRUE(same_bits(a.red, b.red) && same_bits(a.green, b.green) && same_bits(a.blue, b.blue) &&
                  same_bits(a.square_support, b.square_support) &&
                  same_bits(a.square_nearest, b.square_nearest));
    }
}

TEST(FieldKernel, LooksUpAndSumsAsPlainLoopsDo) {
  constexpr int kWidth = 40, kDirections = 7, kHarmonics = 9, kPoints = 13;
  const auto pixels = numbers_of(kWidth * 30 + 16, 4);
  const auto values = numbers_of(kDirections * kColumn, 5), weights = numbers_of(kDirections * kHarmonics, 6);
  std::vector<std::vector<float>> all;
  for (const Kernels* kernels : all_kernels()) {
    std::vector<float> results;
    for (const int step : {1, 3}) {
      field_kernel::Run runs[kLanes];
      for (int i = 0; i < kLanes; ++i) runs[i] = {1.25 + 0.4 * i, 2.5 + i, kLanes, step};
      std::vector<float> along(kLanes + kLanes), across(kLanes * kLanes);
      kernels->interpolate_across({pixels.data(), kWidth}, runs, across.data(), kLanes);
      for (int i = 0; i < kLanes; ++i) {
        kernels->interpolate({pixels.data(), kWidth}, runs[i], along.data());
        for (int j = 0; j < kLanes; ++j) {
          const double x = runs[i].x + j * step, y = runs[i].y, fx = x - std::floor(x),
                       fy = y - std::floor(y);
          const float* p = pixels.data() + static_cast<int>(y) * kWidth + static_cast<int>(x);
          const double expected =
              (1 - fy) * ((1 - fx) * static_cast<double>(p[0]) + fx * static_cast<double>(p[1])) +
              fy * ((1 - fx) * static_cast<double>(p[kWidth]) + fx * static_cast<double>(p[kWidth + 1]));
          EXPECT_NEAR(along[static_cast<std::size_t>(j)], expected, 1e-6);
          EXPECT_EQ(across[static_cast<std::size_t>(j * kLanes + i)], along[static_cast<std::size_t>(j)]);
        }
      }
      results.insert(results.end(), across.begin(), across.end());
    }
    std::vector<float> sums(kHarmonics * kPoints, 1.0f);
    kernels->add_products(values.data(), weights.data(), kDirections, kHarmonics, sums.data(), kPoints,
                          kPoints);
    for (int h = 0; h < kHarmonics; ++h)
      for (int p = 0; p < kPoints; ++p) {
        double expected = 1;
        for (int d = 0; d < kDirections; ++d)
          expected += static_cast<double>(values[static_cast<std::size_t>(d * kColumn + p)]) *
                      static_cast<double>(weights[static_cast<std::size_t>(d * kHarmonics + h)]);
        EXPECT_NEAR(sums[static_cast<std::size_t>(h * kPoints + p)], expected, 1e-5);
      }
    results.insert(results.end(), sums.begin(), sums.end());
    all.push_back(std::move(results));
  }
  for (const auto& results : all) EXPECT_EQ(results, all.front());  // the same bits on every instruction set
}

TEST(FieldKernel, EveryPixelThatIsReadIsFitted) {
  const FieldGrid grid{{11, 9, 13}, Vec3d::Zero(), Vec3d(1, 0.7, 2)};
  for (const int pixels_a_cell : {1, 3})
    for (const Vec3d& direction : {Vec3d(0, 0, 1), Vec3d(0.9, -0.3, 0.5), Vec3d(-0.6, 0.61, 0.62)}) {
      const ShearPlane plane(grid, direction.normalized(), pixels_a_cell);
      auto samples = samples_of(150, 7);
      for (PlaneSample& s : samples) s.at *= 1.4f;
      NearestSamples nearest;
      nearest.build(samples);
      PlaneImage image;
      MovingLeastSquares().fit(plane, nearest, 9, image);
      std::vector<std::array<int, 2>> columns;
      plane.read_columns(columns);
      int read = 0;
      for (int y = 0; y < image.height; ++y)
        for (int x = columns[static_cast<std::size_t>(y)][0]; x < columns[static_cast<std::size_t>(y)][1];
             ++x, ++read) {
          const Vec2d at = plane.across(Vec2d(x, y));
          const auto i = static_cast<std::size_t>(y * image.width + x);
          const Eigen::Array3d exact = slow_fit(samples, at, 9);
          const Eigen::Array3d here(image.channel(0)[i], image.channel(1)[i], image.channel(2)[i]);
          EXPECT_LT((here - exact).abs().maxCoeff(), 1e-3);
          const LocalFit slow = fit_locally(nearest, at.cast<float>(), 9);
          EXPECT_EQ(image.channel(3)[i], static_cast<double>(slow.nearest_cells) <= kNearCells ? 1 : 0);
        }
      EXPECT_GT(read, 90);
      // And what is not read matters to no grid point.
      for (int k = 0; k < grid.size[2]; ++k)
        for (int j = 0; j < grid.size[1]; ++j)
          for (int i = 0; i < grid.size[0]; ++i) {
            const Vec2d at = plane.pixel_of(Vec3d(i, j, k));
            const auto [begin, end] = columns[static_cast<std::size_t>(at.y() + 1e-9)];
            EXPECT_GE(at.x() + 1e-9, begin);
            EXPECT_LT(at.x() - 1e-9, end);
          }
    }
}

}  // namespace
}  // namespace lightwell
