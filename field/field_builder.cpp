// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "field/field_builder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <optional>
#include <sstream>
#include <string>
#include <system_error>
#include <utility>

#include "field/field_state.h"
#include "field/parallel_for.h"
#include "field/sample_store.h"

namespace lightwell {
namespace {

// Of what makes numbers from pictures: one more wherever the same take comes to give other bits, so that an interrupted
// build of another version is not gone on with. (Its kernels give the same bits on every machine.)
constexpr int kNumerics = 4;

constexpr std::size_t kHeldOutBuckets = 24;  // spread over the sphere
constexpr std::size_t kHeldOutOfABucket = 4;
constexpr std::size_t kCheckedRays = 400'000;                  // a few seconds' fits
constexpr std::size_t kFewestChecked = 24, kMostChecked = 96;  // directions

// What stands between pictures and sums: one for the length of a build, on every rank.
class Builder {
 public:
  Builder(const ProbeTake& take, const FieldBuildOptions& options, const FieldProgress& progress,
          FieldRanks& ranks, const FieldState& state, const DirectionBins& bins)
      : take_(take),
        options_(options),
        progress_(progress),
        ranks_(ranks),
        state_(state),
        bins_(bins),
        store_(state.folder(), state.mark(), take.positions.size(), bins.directions().size()) {}

  // Ranks take chunks in turn, and meet after each so that a bad picture ends the build at once.
  Status sort_pictures(int width, int height) {
    const std::vector<std::size_t> missing = missing_chunks();
    Status room;
    if (ranks_.rank() == 0) room = store_.check_room(missing.size());
    if (room = ranks_.agree(room); !room) return room;
    report(probes() - probes_of(missing));
    for (std::size_t i = 0; i < missing.size(); i += ranks()) {
      Status sorted;
      if (i + rank() < missing.size()) sorted = sort_chunk(missing[i + rank()], width, height);
      if (sorted = ranks_.agree(sorted); !sorted) return sorted;
      report(probes() - probes_of(std::span(missing).subspan(std::min(i + ranks(), missing.size()))));
    }
    return {};
  }

  // Ranks take parts in turn; rank 0 adds them in order and keeps what has come so far.
  Status sum_directions(FieldBuild& build) {
    FieldSums total = rank() == 0 ? FieldSums(options_.grid, options_.degree) : FieldSums(LightField{});
    FieldState::Progress done;
    bool resumed = false;
    if (rank() == 0 && state_.found() == FieldState::Found::same)
      if (const auto found = state_.load(total)) {
        done = *found;
        resumed = true;
      }
    if (ranks_.any(resumed)) {
      ranks_.broadcast(std::as_writable_bytes(std::span(&done, 1)));
    } else if (options_.method == FieldMethod::best) {
      Status chosen;
      if (rank() == 0) chosen = choose_support(done);
      if (chosen = ranks_.agree(chosen); !chosen) return chosen;
      ranks_.broadcast(std::as_writable_bytes(std::span(&done, 1)));
    }
    build.support = static_cast<int>(done.support);
    build.held_out_error = done.held_out_error;
    if (options_.method == FieldMethod::best) {
      Status checked;
      if (rank() == 0) checked = check_rays(build);
      if (checked = ranks_.agree(checked); !checked) return checked;
    }

    FieldSums part(options_.grid, options_.degree);
    std::vector<DirectionEstimator> estimators(
        std::max(1u, options_.threads),
        DirectionEstimator(options_.grid, take_.positions, options_.method, build.support));
    auto saved = std::chrono::steady_clock::now();
    while (done.parts < kFieldParts) {
      const std::size_t together = std::min(ranks(), kFieldParts - static_cast<std::size_t>(done.parts));
      seen_ = {};
      Status summed;
      if (rank() < together) summed = sum_part(static_cast<std::size_t>(done.parts), part, estimators);
      if (summed = ranks_.agree(summed); !summed) return summed;
      add_parts(static_cast<std::size_t>(done.parts), together, part, total);
      done.parts += together;
      ranks_.sum(seen_);
      done.seen_directions += seen_[0];
      done.seen_psr += seen_[1];
      Status kept;
      if (const auto now = std::chrono::steady_clock::now();
          rank() == 0 && state_.is_kept() && now - saved >= options_.save_every) {
        kept = state_.save(done, total);
        saved = now;
      }
      if (kept = ranks_.agree(kept); !kept) return kept;
    }
    if (rank() == 0) build.field = std::move(total).take();
    build.directions = static_cast<int>(done.seen_directions);
    build.coverage = std::min(1.0, static_cast<double>(done.seen_psr) * 1e-12 / (4 * kPi));
    return {};
  }

 private:
  [[nodiscard]] std::size_t probes() const { return take_.positions.size(); }
  [[nodiscard]] std::size_t width() const { return last_ - first_; }
  [[nodiscard]] std::size_t rank() const { return static_cast<std::size_t>(ranks_.rank()); }
  [[nodiscard]] std::size_t ranks() const { return static_cast<std::size_t>(ranks_.count()); }
  void report(std::size_t done) const {
    if (progress_ && rank() == 0) progress_(done, probes() + bins_.directions().size());
  }

  // As rank 0 finds them: what another machine sees of the folder may be a moment older.
  [[nodiscard]] std::vector<std::size_t> missing_chunks() const {
    std::vector<std::uint8_t> is_missing(store_.chunks(), 1);
    if (rank() == 0 && state_.found() == FieldState::Found::same)
      for (std::size_t c = 0; c < is_missing.size(); ++c) is_missing[c] = store_.holds(c) ? 0 : 1;
    ranks_.broadcast(std::as_writable_bytes(std::span(is_missing)));
    std::vector<std::size_t> missing;
    for (std::size_t c = 0; c < is_missing.size(); ++c)
      if (is_missing[c] != 0) missing.push_back(c);
    return missing;
  }
  [[nodiscard]] std::size_t probes_of(std::span<const std::size_t> chunks) const {
    std::size_t count = 0;
    for (const std::size_t c : chunks) count += store_.last_probe(c) - store_.first_probe(c);
    return count;
  }

  Status sort_chunk(std::size_t chunk, int width, int height) const {
    const std::size_t directions = bins_.directions().size(), first = store_.first_probe(chunk);
    const std::size_t count = store_.last_probe(chunk) - first;
    std::vector<Rgb> radiance(count * directions);
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
    return store_.write(chunk, radiance);
  }

  // The part of this rank of those that begin with `part`.
  Status sum_part(std::size_t part, FieldSums& sums, std::vector<DirectionEstimator>& estimators) {
    sums.clear();
    std::vector<FieldDirection> batch;
    const std::size_t own = part + rank(), buckets = store_.buckets();
    for (std::size_t b = own * buckets / kFieldParts; b < (own + 1) * buckets / kFieldParts; ++b) {
      if (const Status loaded = load(b); !loaded) return loaded;
      batch.resize(width(), {ShearPlane(options_.grid, Vec3d::UnitY(), 1), {}, {}, 0});
      parallel_for(width(), options_.threads, [&](std::size_t d, unsigned thread) {
        const MeasuredDirection& direction = bins_.directions()[first_ + d];
        estimators[thread].estimate(direction, radiance_of(d), batch[d]);
        batch[d].harmonics = bins_.harmonics().col(static_cast<Eigen::Index>(first_ + d)).cast<float>();
        batch[d].known_share = static_cast<float>(direction.solid_angle_sr / (4 * kPi));
      });
      count_seen();
      parallel_for(static_cast<std::size_t>(sums.slabs()), options_.threads,
                   [&](std::size_t z, unsigned) { sums.add(batch, static_cast<int>(z)); });
      // As if the other ranks were as far.
      const std::size_t before = store_.first(part * buckets / kFieldParts);
      const std::size_t here = last_ - store_.first(own * buckets / kFieldParts);
      report(probes() + std::min(before + here * ranks(), bins_.directions().size()));
    }
    return {};
  }

  // Of the loaded directions those that a probe saw: what the projection shows may be NaN in all pictures.
  void count_seen() {
    for (std::size_t d = 0; d < width(); ++d) {
      const auto radiance = radiance_of(d);
      if (std::all_of(radiance.begin(), radiance.end(), [](const Rgb& r) { return std::isnan(r.x()); }))
        continue;
      ++seen_[0];
      seen_[1] +=
          static_cast<std::uint64_t>(std::llround(bins_.directions()[first_ + d].solid_angle_sr * 1e12));
    }
  }

  // The parts of all ranks to the total, in order.
  void add_parts(std::size_t first, std::size_t together, const FieldSums& part, FieldSums& total) const {
    if (rank() == 0)
      parallel_for(static_cast<std::size_t>(total.slabs()), options_.threads,
                   [&](std::size_t slab, unsigned) {
                     const int z = static_cast<int>(slab);
                     total.add(part.radiance(z), part.confidence(z), z);
                   });
    std::vector<float> radiance(part.radiance(0).size()), confidence(part.confidence(0).size());
    for (std::size_t r = 1; r < together; ++r) {
      if (is_empty(first + r)) continue;
      for (int z = 0; z < part.slabs(); ++z)
        if (rank() == r) {
          ranks_.send(part.radiance(z));
          ranks_.send(part.confidence(z));
        } else if (rank() == 0) {
          ranks_.receive(static_cast<int>(r), radiance);
          ranks_.receive(static_cast<int>(r), confidence);
          total.add(radiance, confidence, z);
        }
    }
  }
  [[nodiscard]] bool is_empty(std::size_t part) const {
    return part * store_.buckets() / kFieldParts == (part + 1) * store_.buckets() / kFieldParts;
  }

  // Over how many rays to fit.
  Status choose_support(FieldState::Progress& chosen) {
    SupportChoice choice;
    DirectionEstimator estimator(options_.grid, take_.positions, options_.method, 0);
    const std::size_t step = std::max<std::size_t>(1, store_.buckets() / kHeldOutBuckets);
    for (std::size_t b = step / 2; b < store_.buckets(); b += step) {
      if (const Status loaded = load(b); !loaded) return loaded;
      const std::size_t within = std::max<std::size_t>(1, width() / kHeldOutOfABucket);
      for (std::size_t d = 0; d < width(); d += within)
        estimator.hold_out(bins_.directions()[first_ + d], radiance_of(d), choice);
    }
    chosen.support = choice.best();
    chosen.held_out_error = choice.held_out_error();
    return {};
  }

  // Whether all probes saw one field: every probe in directions spread over the sphere, fewer the more probes there are.
  Status check_rays(FieldBuild& build) {
    RayConsistency consistency(probes());
    DirectionEstimator estimator(options_.grid, take_.positions, options_.method, build.support);
    const std::size_t wanted = std::clamp(kCheckedRays / probes(), kFewestChecked, kMostChecked);
    const std::size_t together = std::min<std::size_t>(kHeldOutOfABucket, wanted);
    const std::size_t step = std::max<std::size_t>(1, store_.buckets() * together / wanted);
    for (std::size_t b = step / 2; b < store_.buckets(); b += step) {
      if (const Status loaded = load(b); !loaded) return loaded;
      const std::size_t within = std::max<std::size_t>(1, width() / together);
      for (std::size_t d = 0; d < width(); d += within)
        estimator.check(bins_.directions()[first_ + d], radiance_of(d), consistency);
    }
    build.doubtful = consistency.doubtful();
    build.close_difference = consistency.close_difference();
    return {};
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
    first_ = store_.first(bucket);
    last_ = store_.last(bucket);
    by_probe_.resize(probes() * width());
    by_direction_.resize(by_probe_.size());
    if (const Status read = store_.read(bucket, by_probe_); !read) return read;
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
  FieldRanks& ranks_;
  const FieldState& state_;
  const DirectionBins& bins_;
  SampleStore store_;
  std::size_t first_ = 0, last_ = 0;
  std::vector<Rgb> by_probe_, by_direction_;
  std::array<std::uint64_t, 2> seen_ =
      {};  // directions and picosteradians of this rank's part, then of all ranks'
};

Status check_picture(const LatLongImage& picture, const ProbeProjection& projection,
                     const std::string& name) {
  if (std::holds_alternative<MirrorBallProbe>(projection)) {
    constexpr double kSquareWithin = 0.02;  // of a side, as pictures are cropped by hand
    const double aspect = static_cast<double>(picture.width) / picture.height;
    if (std::abs(std::log(aspect)) <= kSquareWithin) return {};
    return Error{ErrorKind::bad_input,
                 name + ": is " + std::to_string(picture.width) + "x" + std::to_string(picture.height) +
                     " pixels, allowed for a mirror ball: a square, cropped to the ball (within 2 %)" +
                     (picture.width == 2 * picture.height ? "; 2:1 is a latitude-longitude image" : "")};
  }
  const auto* fisheye = std::get_if<FisheyeProbe>(&projection);
  if (fisheye == nullptr) return {};
  const auto [width, height] = fisheye->lens.image_size;
  if (picture.width == width && picture.height == height) return {};
  return Error{ErrorKind::bad_input, name + ": is " + std::to_string(picture.width) + "x" +
                                         std::to_string(picture.height) + " pixels, allowed " +
                                         std::to_string(width) + "x" + std::to_string(height) +
                                         ", lens.image_size"};
}

// All that the numbers come from, but for what the caller says of the pictures.
FieldOrigin origin_of(const ProbeTake& take, const FieldBuildOptions& o, std::size_t directions) {
  std::ostringstream text;
  text.precision(17);
  const auto [nx, ny, nz] = o.grid.size;
  text << "grid " << nx << ' ' << ny << ' ' << nz << "\nbounds " << o.grid.low.transpose() << ' '
       << o.grid.high.transpose() << "\ndegree " << o.degree << "\nmethod "
       << (o.method == FieldMethod::best ? "best" : "low") << "\ndirections " << directions << "\nprobes "
       << take.positions.size() << "\npictures ";
  return {"numerics " + std::to_string(kNumerics), text.str()};
}

// Each rank has read its list, or chosen its frames, by itself: with others than rank 0's it would wait for messages that
// never come, or give its part of another field.
Status check_same_take(const ProbeTake& take, const LatLongImage& first, const FieldOrigin& origin,
                       FieldRanks& ranks) {
  struct {
    std::uint64_t probes, content;
  } own = {take.positions.size(), fnv1a(origin.text())};
  own.content = fnv1a(std::to_string(first.width) + 'x' + std::to_string(first.height), own.content);
  for (std::size_t i = 0; i < take.positions.size(); ++i) {
    const Vec3d& at = take.positions[i];
    own.content = fnv1a({reinterpret_cast<const char*>(at.data()), sizeof at}, own.content);
    own.content = fnv1a(take.name(i) + '\n', own.content);
  }
  auto rank_0 = own;
  ranks.broadcast(std::as_writable_bytes(std::span(&rank_0, 1)));
  const std::string who = "rank " + std::to_string(ranks.rank()) + " has ";
  Status same;
  if (own.probes != rank_0.probes)
    same =
        Error{ErrorKind::bad_input, who + std::to_string(own.probes) + " probes, rank 0 has " +
                                        std::to_string(rank_0.probes) + ", allowed: the same on all ranks"};
  else if (own.content != rank_0.content)
    same = Error{ErrorKind::bad_input,
                 who +
                     "other places, pictures, frames, options or another program than rank 0"
                     ", allowed: the same on all ranks"};
  return ranks.agree(same);
}

Result<DirectionBins> bins_of(const ProbeTake& take, const FieldBuildOptions& options,
                              const LatLongImage& first) {
  if (const Status fits = check_picture(first, options.projection, take.name(0)); !fits) return fits.error();
  const int cells = options.directions > 0 ? options.directions : direction_count_for(options.grid);
  DirectionBins bins(options.projection, first.width, first.height, cells, options.degree);
  if (bins.directions().empty())
    return Error{ErrorKind::bad_input, take.name(0) + ": the projection sees no direction in its pixels"};
  return bins;
}

void say_what_was_found(const FieldState& state, const FieldBuildOptions& options) {
  if (!options.remark) return;
  if (state.found() == FieldState::Found::same)
    options.remark("goes on where an interrupted build stands, in " + state.folder().string());
  if (state.found() == FieldState::Found::other_take)
    options.remark(state.folder().string() + ": was of other pictures or options, begins anew");
  if (state.found() == FieldState::Found::other_program)
    options.remark(state.folder().string() +
                   ": was of another version of this program, which gives other numbers; begins anew");
}

}  // namespace

Result<FieldBuild> build_field(const ProbeTake& take, const FieldBuildOptions& options,
                               const FieldProgress& progress) {
  verify_bug(!take.positions.empty(), "a take of no probes");
  FieldRanks alone;
  FieldRanks& ranks = options.ranks != nullptr ? *options.ranks : alone;
  const auto first = take.picture(0);
  const Result<DirectionBins> bins = first ? bins_of(take, options, *first) : first.error();
  if (const Status ready = ranks.agree(bins ? Status() : bins.error()); !ready) return ready.error();
  FieldOrigin origin = origin_of(take, options, bins->directions().size());
  if (const Status same = check_same_take(take, *first, origin, ranks); !same) return same.error();
  origin.take += options.made_from + '\n';
  auto state = FieldState::open(options.scratch_folder, options.state_name, origin, ranks);
  if (!state) return state.error();
  if (ranks.rank() == 0) say_what_was_found(*state, options);
  Builder builder(take, options, progress, ranks, *state, *bins);
  FieldBuild build;
  if (const Status sorted = builder.sort_pictures(first->width, first->height); !sorted) {
    // What was sorted now was quick to get, and a bad picture's take will be another one. What stood there before may be
    // hours of sums, and a picture that is gone may come back.
    if (ranks.rank() == 0 && state->found() != FieldState::Found::same) state->remove();
    return sorted.error();
  }
  if (const Status summed = builder.sum_directions(build); !summed) return summed.error();
  if (state->is_kept()) build.state = std::make_unique<FieldState>(*std::move(state));
  return build;
}

}  // namespace lightwell
