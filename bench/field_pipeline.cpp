// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <random>

#include "bench/field_rows.h"
#include "bench/splat_in_space.h"
#include "bench/temporary_folder.h"
#include "field/sample_store.h"
#include "lighting/harmonics.h"

namespace lightwell::bench {
namespace {

constexpr int kSide = 64, kDegree = 4, kPicture = 250;
constexpr std::size_t kProbes = 440;
const MirrorBallProbe kBall{0.05, std::nullopt, 2.1 * kPi / 180};

using Clock = std::chrono::steady_clock;
double ms_since(Clock::time_point begin) {
  return std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
}

// As in the paper: every pixel is a direction, with the weight of an even share of the sphere.
struct PixelDirections {
  std::vector<std::size_t> pixels;
  std::vector<MeasuredDirection> directions;

  PixelDirections() {
    for (int y = 0; y < kPicture; ++y)
      for (int x = 0; x < kPicture; ++x)
        if (const auto ray = ray_of(kBall, kPicture, kPicture, x + 0.5, y + 0.5)) {
          pixels.push_back(static_cast<std::size_t>(y * kPicture + x));
          directions.push_back({ray->direction, ray->origin, 0});
        }
  }
};

Status sort_pixels(const ProbeTake& take, const PixelDirections& sphere, const SampleStore& store) {
  for (std::size_t chunk = 0; chunk < store.chunks(); ++chunk) {
    std::vector<Rgb> radiance;
    for (std::size_t p = store.first_probe(chunk); p < store.last_probe(chunk); ++p) {
      const auto picture = take.picture(p);
      for (const std::size_t pixel : sphere.pixels) radiance.push_back(picture->pixels[pixel]);
    }
    if (const Status written = store.write(chunk, radiance); !written) return written;
  }
  return {};
}

// Buckets at random until the time is up, each read and splatted whole; the rest by the mean.
Row paper_row(const std::string& setting, const ProbeTake& take, double seconds) {
  const TemporaryFolder folder;
  const PixelDirections sphere;
  const SampleStore store(folder.path(), 0, take.positions.size(), sphere.directions.size());
  auto begin = Clock::now();
  verify_bug(sort_pixels(take, sphere, store).ok(), "bench: sorting refused");
  const double sorting_ms = ms_since(begin);

  SplatInSpace splat(unit_cube(kSide), kDegree);
  std::vector<std::size_t> buckets(store.buckets());
  for (std::size_t b = 0; b < buckets.size(); ++b) buckets[b] = b;
  std::shuffle(buckets.begin(), buckets.end(), std::mt19937(1));
  Eigen::VectorXd values(harmonic_count(kDegree));
  std::size_t timed = 0;
  begin = Clock::now();
  for (std::size_t i = 0; i < buckets.size() && ms_since(begin) < 1e3 * seconds; ++i) {
    const std::size_t first = store.first(buckets[i]), width = store.last(buckets[i]) - first;
    std::vector<Rgb> bucket(take.positions.size() * width), radiance(take.positions.size());
    verify_bug(store.read(buckets[i], bucket).ok(), "bench: reading back refused");
    for (std::size_t d = 0; d < width; ++d, ++timed) {
      for (std::size_t p = 0; p < radiance.size(); ++p) radiance[p] = bucket[p * width + d];
      harmonics(sphere.directions[first + d].direction, kDegree, values.data());
      const double share_sr = 4 * kPi / static_cast<double>(sphere.directions.size());
      splat.add(sphere.directions[first + d], take.positions, radiance, (share_sr * values).cast<float>());
    }
  }
  const double all = static_cast<double>(sphere.directions.size());
  const double resampling_ms = ms_since(begin) * all / static_cast<double>(timed);
  Row row = row_of_one_run(setting, "as in 2009, one thread", sorting_ms + resampling_ms);
  row.values = {{"threads", 1},
                {"directions", all},
                {"directions_timed", static_cast<double>(timed)},  // the whole is extrapolated from these
                {"sorting_s", sorting_ms / 1e3},
                {"resampling_s", resampling_ms / 1e3}};
  return row;
}

Row our_row(const std::string& setting, const ProbeTake& take, FieldMethod method, unsigned threads) {
  const TemporaryFolder folder;
  FieldBuildOptions options;
  options.grid = unit_cube(kSide);
  options.degree = kDegree;
  options.method = method;
  options.projection = kBall;
  options.threads = threads;
  options.scratch_folder = folder.path();
  double sorted_ms = 0;
  const auto begin = Clock::now();
  const auto build = build_field(take, options, [&](std::size_t done, std::size_t) {
    if (done <= take.positions.size()) sorted_ms = ms_since(begin);
  });
  verify_bug(build.ok(), "bench: a build refused");
  const double ms = ms_since(begin);
  Row row = row_of_one_run(setting,
                           std::string(method == FieldMethod::low ? "low" : "best") + ", " +
                               (threads == 1 ? "one thread" : std::to_string(threads) + " threads"),
                           ms);
  row.values = {{"threads", threads},
                {"directions", build->directions},
                {"sorting_s", sorted_ms / 1e3},
                {"resampling_s", (ms - sorted_ms) / 1e3}};
  return row;
}

}  // namespace

std::vector<Row> pipeline_rows(const Options& options) {
  const std::string setting = "pictures to field, 440 probes of 250x250, 64 cubed";
  const ProbeTake take = even_take(kProbes, kPicture, kPicture);
  std::vector<Row> rows = {paper_row(setting, take, 3 * options.seconds_per_case)};
  // Ours takes most of a minute on one thread: asked for with --seconds 10 or more.
  if (options.seconds_per_case >= 10) {
    rows.push_back(our_row(setting, take, FieldMethod::best, 1));
    rows.push_back(our_row(setting, take, FieldMethod::best, 2));
    rows.push_back(our_row(setting, take, FieldMethod::low, 1));
  }
  for (Row& row : rows)
    row.values.emplace_back("ratio_of_paper_to_this", rows[0].timing.p50_ms / row.timing.p50_ms);
  return rows;
}

}  // namespace lightwell::bench
