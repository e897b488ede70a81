// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "field/field_builder.h"

#include <algorithm>
#include <mutex>
#include <optional>
#include <utility>

#include "field/bucket_file.h"
#include "field/parallel_for.h"

namespace lightwell {
namespace {

constexpr std::size_t kChunkBytes = std::size_t{32} << 20;  // of pictures' directions on their way to disk
constexpr std::size_t kHeldOutBuckets = 24;                 // spread over the sphere
constexpr std::size_t kHeldOutOfABucket = 4;

// What stands between pictures and sums: one for the length of a build.
class Builder {
 public:
  Builder(const ProbeTake& take, const FieldBuildOptions& options, const FieldProgress& progress,
          DirectionBins bins, BucketFile buckets)
      : take_(take),
        options_(options),
        progress_(progress),
        bins_(std::move(bins)),
        buckets_(std::move(buckets)) {}

  Status sort_pictures(int width, int height) {
    const std::size_t directions = bins_.directions().size();
    const std::size_t chunk = std::clamp<std::size_t>(kChunkBytes / (directions * sizeof(Rgb)), 1, 256);
    std::vector<Rgb> radiance;
    for (std::size_t first = 0; first < probes(); first += chunk) {
      const std::size_t count = std::min(chunk, probes() - first);
      radiance.resize(count * directions);
      std::optional<Error> error;
      std::size_t erroneous = probes();
      std::mutex mutex;
      parallel_for(count, options_.threads, [&](std::size_t i, unsigned) {
        const std::span<Rgb> out(radiance.data() + i * directions, directions);
        const Status cut = cut_picture(first + i, width, height, out);
        const std::scoped_lock lock(mutex);
        if (!cut && first + i < erroneous) {  // the first of them, whichever thread was first
          erroneous = first + i;
          error = cut.error();
        }
      });
      if (error) return *error;
      if (const Status written = buckets_.write(first, count, radiance); !written) return written;
      report(first + count);
    }
    return {};
  }

  // Over how many rays to fit.
  Status choose_support(FieldBuild& build) {
    SupportChoice choice;
    DirectionEstimator estimator(options_.grid, take_.positions, options_.method, 0);
    const std::size_t step = std::max<std::size_t>(1, buckets_.buckets() / kHeldOutBuckets);
    for (std::size_t b = step / 2; b < buckets_.buckets(); b += step) {
      if (const Status loaded = load(b); !loaded) return loaded;
      const std::size_t within = std::max<std::size_t>(1, width() / kHeldOutOfABucket);
      for (std::size_t d = 0; d < width(); d += within)
        estimator.hold_out(bins_.directions()[first_ + d], radiance_of(d), choice);
    }
    build.support = choice.best();
    build.held_out_error = choice.held_out_error();
    return {};
  }

  Status sum_directions(FieldBuild& build) {
    FieldSums sums(options_.grid, options_.degree);
    std::vector<DirectionEstimator> estimators(
        std::max(1u, options_.threads),
        DirectionEstimator(options_.grid, take_.positions, options_.method, build.support));
    std::vector<FieldDirection> batch;
    for (std::size_t b = 0; b < buckets_.buckets(); ++b) {
      if (const Status loaded = load(b); !loaded) return loaded;
      batch.resize(width(), {ShearPlane(options_.grid, Vec3d::UnitY(), 1), {}, {}, 0});
      parallel_for(width(), options_.threads, [&](std::size_t d, unsigned thread) {
        const MeasuredDirection& direction = bins_.directions()[first_ + d];
        estimators[thread].estimate(direction, radiance_of(d), batch[d]);
        batch[d].harmonics = bins_.harmonics().col(static_cast<Eigen::Index>(first_ + d)).cast<float>();
        batch[d].known_share = static_cast<float>(direction.solid_angle_sr / (4 * kPi));
      });
      parallel_for(static_cast<std::size_t>(sums.slabs()), options_.threads,
                   [&](std::size_t z, unsigned) { sums.add(batch, static_cast<int>(z)); });
      report(probes() + last_);
    }
    build.field = std::move(sums).take();
    return {};
  }

  [[nodiscard]] const DirectionBins& bins() const { return bins_; }

 private:
  [[nodiscard]] std::size_t probes() const { return take_.positions.size(); }
  [[nodiscard]] std::size_t width() const { return last_ - first_; }
  void report(std::size_t done) const {
    if (progress_) progress_(done, probes() + bins_.directions().size());
  }

  Status cut_picture(std::size_t probe, int width, int height, std::span<Rgb> out) const {
    const auto picture = take_.picture(probe);
    if (!picture) return picture.error();
    if (picture->width != width || picture->height != height)
      return Error{ErrorKind::bad_input, take_.name(probe) + ": is " + std::to_string(picture->width) + "x" +
                                             std::to_string(picture->height) + " pixels, allowed " +
                                             std::to_string(width) + "x" + std::to_string(height) +
                                             ", the size of " + take_.name(0)};
    bins_.mean_radiance(picture->pixels, out);
    return {};
  }

  // A bucket as it was written, then by direction.
  Status load(std::size_t bucket) {
    first_ = buckets_.first(bucket);
    last_ = buckets_.last(bucket);
    by_probe_.resize(probes() * width());
    by_direction_.resize(by_probe_.size());
    if (const Status read = buckets_.read(bucket, by_probe_); !read) return read;
    for (std::size_t p = 0; p < probes(); ++p)
      for (std::size_t d = 0; d < width(); ++d) by_direction_[d * probes() + p] = by_probe_[p * width() + d];
    return {};
  }
  [[nodiscard]] std::span<const Rgb> radiance_of(std::size_t d) const {
    return std::span(by_direction_).subspan(d * probes(), probes());
  }

  const ProbeTake& take_;
  const FieldBuildOptions& options_;
  const FieldProgress& progress_;
  DirectionBins bins_;
  BucketFile buckets_;
  std::size_t first_ = 0, last_ = 0;
  std::vector<Rgb> by_probe_, by_direction_;
};

Status check_picture(const LatLongImage& picture, const ProbeProjection& projection,
                     const std::string& name) {
  const auto* fisheye = std::get_if<FisheyeProbe>(&projection);
  if (fisheye == nullptr) return {};
  const auto [width, height] = fisheye->lens.image_size;
  if (picture.width == width && picture.height == height) return {};
  return Error{ErrorKind::bad_input, name + ": is " + std::to_string(picture.width) + "x" +
                                         std::to_string(picture.height) + " pixels, allowed " +
                                         std::to_string(width) + "x" + std::to_string(height) +
                                         ", lens.image_size"};
}

}  // namespace

Result<FieldBuild> build_field(const ProbeTake& take, const FieldBuildOptions& options,
                               const FieldProgress& progress) {
  verify_bug(!take.positions.empty(), "a take of no probes");
  const auto first = take.picture(0);
  if (!first) return first.error();
  if (const Status fits = check_picture(*first, options.projection, take.name(0)); !fits) return fits.error();
  const int cells =
      options.directions > 0 ? options.directions : direction_count_for(options.grid.longest_side());
  DirectionBins bins(options.projection, first->width, first->height, cells, options.degree);
  if (bins.directions().empty())
    return Error{ErrorKind::bad_input, take.name(0) + ": the projection sees no direction in its pixels"};
  auto buckets = BucketFile::create(options.scratch_folder, take.positions.size(), bins.directions().size());
  if (!buckets) return buckets.error();
  Builder builder(take, options, progress, std::move(bins), *std::move(buckets));
  FieldBuild build;
  build.directions = static_cast<int>(builder.bins().directions().size());
  build.coverage = builder.bins().coverage();
  if (const Status sorted = builder.sort_pictures(first->width, first->height); !sorted)
    return sorted.error();
  if (options.method == FieldMethod::best)
    if (const Status chosen = builder.choose_support(build); !chosen) return chosen.error();
  if (const Status summed = builder.sum_directions(build); !summed) return summed.error();
  return build;
}

}  // namespace lightwell
