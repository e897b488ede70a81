// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "cli/command.h"
#include "cli/decompose_options.h"
#include "cli/progress.h"
#include "interface/atomic_file.h"
#include "interface/environment_io.h"
#include "interface/light_set_io.h"
#include "interface/numbered_sequence.h"
#include "interface/option_range.h"
#include "interface/printable.h"
#include "interface/same_file.h"
#include "lighting/decomposition/best_lights.h"
#include "lighting/decomposition/decompose.h"
#include "lighting/lat_long_image.h"
#include "lighting/temporal/flicker_filter.h"
#include "lighting/temporal/temporal_choice.h"

namespace lightwell::cli {
namespace {

struct LightsOptions {
  std::string environment;
  std::string out;
  std::string method = "best";
  std::int64_t count = 0;
  DecomposeArguments decompose;
  bool sphere = false;
  bool hemisphere = false;
  double rotate_y_deg = 0;
  double rate_hz = 60;
  std::optional<std::string> temporal;
  std::optional<double> mains_hz;
  std::optional<double> exposure_ms;
  bool json = false;
};

// The options, checked: what the work needs.
struct Plan {
  Method method = Method::best;
  int count = 1;
  DecomposeOptions decompose;
  bool hemisphere = true;
  double rotate_y_rad = 0;
  double rate_hz = 60;
  TemporalChoice temporal = TemporalChoice::none;
  std::optional<FlickerOptions> flicker;
};

// Of one image there is none. Method best is steady by itself; the samplers, whose light i stays the same light,
// can be filtered; of the others every frame stands by itself.
Result<TemporalChoice> temporal_choice(const LightsOptions& options, Method method) {
  const bool sequence = is_numbered_sequence(options.environment);
  const bool sampled = sampler_of(method).has_value();
  if (!options.temporal) {
    if (!sequence) return TemporalChoice::none;
    return method == Method::best && options.count <= kMostPlacedLights ? TemporalChoice::best
           : sampled                                                    ? TemporalChoice::fir
                                                                        : TemporalChoice::none;
  }
  const auto choice = temporal_choice_from_name(*options.temporal);
  if (!choice) return usage("--temporal is " + *options.temporal + ", allowed: " + temporal_choice_names());
  if (*choice == TemporalChoice::none) return choice.value();
  if (!sequence)
    return usage("--temporal " + *options.temporal + " needs a numbered sequence, such as 'env_%04d.exr'");
  if (*choice == TemporalChoice::best && method != Method::best)
    return usage("--temporal best is what method best does itself; with --method " +
                 std::string(name(method)) +
                 (sampled ? " allowed: fir, minimum-phase, one-frame, none" : " allowed: none"));
  if (*choice == TemporalChoice::best && options.count > kMostPlacedLights)
    return usage("--temporal best with --count " + std::to_string(options.count) + ", allowed: up to " +
                 std::to_string(kMostPlacedLights) + " lights");
  if (*choice != TemporalChoice::best && !sampled)
    return usage("--temporal " + *options.temporal +
                 " needs a method that keeps a light's identity from frame to frame: standard, havran");
  return choice.value();
}

Result<Plan> plan_of(const LightsOptions& options) {
  Plan plan;
  const auto method = method_from_name(options.method);
  if (!method) return usage("--method is " + options.method + ", allowed: " + method_names());
  plan.method = *method;
  plan.count = static_cast<int>(options.count);
  const auto chosen = decompose_options(options.decompose, plan.method);
  if (!chosen) return chosen.error();
  plan.decompose = *chosen;
  plan.hemisphere = !options.sphere;
  plan.rotate_y_rad = options.rotate_y_deg * kPi / 180;
  plan.rate_hz = options.rate_hz;
  if (const Status named = check_output_name(options.out); !named) return named.error();
  if (const Status other = check_output_is_no_input(options.out, {options.environment}); !other)
    return other.error();
  const auto temporal = temporal_choice(options, plan.method);
  if (!temporal) return temporal.error();
  plan.temporal = *temporal;
  if (plan.temporal != TemporalChoice::none)
    if (const Status carried = check_carried(plan.decompose); !carried) return carried.error();
  if ((options.mains_hz || options.exposure_ms) && !is_numbered_sequence(options.environment))
    return usage(std::string(options.mains_hz ? "--mains" : "--exposure") +
                 " needs a numbered sequence, such as 'env_%04d.exr'");
  if (options.mains_hz && *options.mains_hz != 50 && *options.mains_hz != 60)
    return usage("--mains is " + std::to_string(*options.mains_hz) + ", allowed: 50, 60 Hz");
  if (options.exposure_ms && !options.mains_hz)
    return usage("--exposure tells how much of the mains' flicker is averaged: it needs --mains");
  if (options.mains_hz)
    plan.flicker =
        FlickerOptions{2 * *options.mains_hz, options.rate_hz, options.exposure_ms.value_or(0) / 1000};
  return plan;
}

// Reads an image as the map the lights are made from, and says what had to be repaired.
Result<PolarMap> read_map(const std::filesystem::path& file, const Plan& plan) {
  const auto environment = read_environment(file);
  if (!environment) return environment.error();
  if (const std::string remark = environment->remark(file); !remark.empty())
    std::fprintf(stderr, "lightwell: %s\n", printable(remark).c_str());
  return polar_map_from_lat_long(environment->image, plan.hemisphere, plan.rotate_y_rad);
}

// Frame after frame to light sets: one pipeline through all of them where the method has state, else each by
// itself.
class Decomposer {
 public:
  explicit Decomposer(const Plan& plan) : plan_(plan) {}

  Result<LightSet> next(const PolarMap& map) {
    const auto sampler = sampler_of(plan_.method);
    if (plan_.temporal == TemporalChoice::best) return next_best(map);
    if (plan_.temporal == TemporalChoice::none || !sampler)
      return decompose(map, plan_.method, plan_.count, plan_.decompose);
    if (!pipeline_)
      if (const Status status = prepare(map, *sampler); !status) return status.error();
    const auto lights = pipeline_->process(map);
    LightSet set;
    set.method = name(plan_.method);
    set.coverage = coverage_of(map.grid);
    set.lights.assign(lights.begin(), lights.end());
    filter_->apply(set);
    return set;
  }
  [[nodiscard]] double delay_frames() const { return filter_ ? filter_->delay_frames() : 0; }

 private:
  Result<LightSet> next_best(const PolarMap& map) {
    if (!best_) best_.emplace(map.grid, plan_.count, Effort::thorough);
    const auto lights = best_->process(map);
    LightSet set;
    set.method = name(Method::best);
    set.coverage = coverage_of(map.grid);
    set.lights.assign(lights.begin(), lights.end());
    set.has_parents = true;
    set.total_illuminance = best_->total_illuminance().cast<float>();
    if (!set.total_illuminance.isFinite().all())
      return Error{ErrorKind::bad_input, "total illuminance is beyond a 32 bit float (3.4e38 lux)"};
    return set;
  }

  Status prepare(const PolarMap& map, LightPipelineOptions::Sampler sampler) {
    const auto taps = temporal_taps(plan_.temporal, plan_.rate_hz);
    if (!taps) return taps.error();
    LightPipelineOptions options;
    options.count = plan_.count;
    options.sampler = sampler;
    options.relaxed = plan_.decompose.points == Points::relaxed;
    options.seed = plan_.decompose.seed;
    options.filter = TemporalFilter::none;
    options.clusters = 0;
    auto pipeline = LightPipeline::create(map.grid, map.channels, options);
    if (!pipeline) return pipeline.error();
    pipeline_.emplace(std::move(pipeline).value());
    filter_.emplace(*taps, static_cast<std::size_t>(plan_.count), map.grid.theta_max_rad);
    return {};
  }

  Plan plan_;
  std::optional<BestLights> best_;
  std::optional<LightPipeline> pipeline_;
  std::optional<LightSetFilter> filter_;
};

void report(const LightsOptions& options, const Plan& plan, std::size_t frames, double delay_frames,
            double ms, const Rgb& total) {
  if (options.json) {
    nlohmann::ordered_json result = {{"method", name(plan.method)},
                                     {"coverage", plan.hemisphere ? "hemisphere" : "sphere"},
                                     {"count", plan.count},
                                     {"frames", frames},
                                     {"temporal", name(plan.temporal)},
                                     {"delay_frames", delay_frames},
                                     {"total_illuminance", {total[0], total[1], total[2]}},
                                     {"ms", ms},
                                     {"out", options.out}};
    describe(plan.decompose, result);
    std::printf("%s\n", result.dump().c_str());
  } else {
    std::fprintf(stderr, "lightwell: %zu %s of %d lights to %s\n", frames, frames == 1 ? "set" : "sets",
                 plan.count, options.out.c_str());
  }
}

int run_sequence(const LightsOptions& options, const Plan& plan) {
  const auto files = sequence_files(options.environment);
  if (!files) return fail(files.error());
  for (const std::filesystem::path& file : *files)
    if (const Status other = check_output_is_no_input(options.out, {file}); !other)
      return fail(other.error());
  auto out = AtomicFileWriter::create(options.out);
  if (!out) return fail(out.error());
  Decomposer decomposer(plan);
  std::optional<FlickerFilter> flicker;
  Progress progress(files->size());
  std::optional<PolarGrid> grid;
  Rgb total = Rgb::Zero();
  double ms = 0;
  for (std::size_t i = 0; i < files->size(); ++i) {
    auto map = read_map((*files)[i], plan);
    if (!map) return fail(map.error());
    if (grid && !(*grid == map->grid))
      return fail(
          {ErrorKind::bad_input, (*files)[i].string() + ": has another size than the frames before it"});
    grid = map->grid;
    if (plan.flicker && !flicker) {
      auto made = FlickerFilter::create(map->radiance.size(), *plan.flicker);
      if (!made) return fail(made.error());
      flicker.emplace(std::move(made).value());
    }
    const auto begin = std::chrono::steady_clock::now();
    if (flicker)
      flicker->apply(static_cast<double>(i) / plan.rate_hz, plan.flicker->exposure_s, map->radiance);
    const auto set = decomposer.next(*map);
    ms += std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
    if (!set) return fail({set.error().kind, (*files)[i].string() + ": " + set.error().message});
    if (const Status status = out->append(light_set_to_json(*set, true)); !status)
      return fail(status.error());
    total = set->total_illuminance;
    progress.done(i + 1);
  }
  if (const Status status = out->commit(); !status) return fail(status.error());
  report(options, plan, files->size(), decomposer.delay_frames(), ms, total);
  return 0;
}

int run_image(const LightsOptions& options, const Plan& plan) {
  const auto map = read_map(options.environment, plan);
  if (!map) return fail(map.error());
  const auto begin = std::chrono::steady_clock::now();
  const auto set = decompose(*map, plan.method, plan.count, plan.decompose);
  const std::chrono::duration<double, std::milli> ms = std::chrono::steady_clock::now() - begin;
  if (!set) return fail({set.error().kind, options.environment + ": " + set.error().message});
  if (const Status status = write_light_set(options.out, *set); !status) return fail(status.error());
  report(options, plan, 1, 0, ms.count(), set->total_illuminance);
  return 0;
}

int run(const LightsOptions& options) {
  const auto plan = plan_of(options);
  if (!plan) return fail(plan.error());
  return is_numbered_sequence(options.environment) ? run_sequence(options, *plan) : run_image(options, *plan);
}

}  // namespace

Command add_lights(CLI::App& app) {
  const auto o = std::make_shared<LightsOptions>();
  CLI::App* command = app.add_subcommand("lights", "Decompose an environment image into directional lights");
  command->footer(
      "Example: lightwell lights env.exr --count 64 --out lights.json\n"
      "         lightwell lights 'env_%04d.exr' --count 300 --method havran --rate 25 --out lights.jsonl");
  command
      ->add_option("environment", o->environment,
                   "Latitude–longitude image, EXR or Radiance HDR, or a numbered sequence ('env_%04d.exr')")
      ->required()
      ->type_name("ENV");
  command->add_option("--count", o->count, "Number of lights, 1 to 100000")
      ->required()
      ->check(whole_numbers(1, kMostLights))
      ->type_name("N");
  command->add_option("--method", o->method, "One of: " + method_names())
      ->capture_default_str()
      ->type_name("M");
  auto* hemisphere = command->add_flag("--hemisphere", o->hemisphere, "The half above the horizon (default)");
  command->add_flag("--sphere", o->sphere, "All of the image")->excludes(hemisphere);
  add_decompose_options(*command, o->decompose);
  command->add_option("--rotate-y", o->rotate_y_deg, "Turn the image about +Y: azimuth λ comes to λ + DEG")
      ->check(numbers_from(-360, 360, "-360 to 360 degrees"))
      ->type_name("DEG");
  command->add_option("--rate", o->rate_hz, "Frames a second of a sequence, Hz")
      ->check(numbers_above_0_to(100000, "above 0 to 100000 Hz"))
      ->capture_default_str()
      ->type_name("HZ");
  command
      ->add_option("--temporal", o->temporal,
                   "Of a sequence, one of: " + temporal_choice_names() +
                       ". Default best with method best, fir with standard and havran, none with the others")
      ->type_name("T");
  command
      ->add_option("--mains", o->mains_hz,
                   "Of a sequence: take out the flicker of lamps on mains of 50 or 60 Hz, without delay")
      ->check(numbers_from(50, 60, "50 or 60 Hz"))
      ->type_name("HZ");
  command
      ->add_option("--exposure", o->exposure_ms,
                   "With --mains: exposure of the frames, which averages flicker; default short")
      ->check(numbers_from(0, 1000, "0 to 1000 ms"))
      ->type_name("MS");
  command->add_option("--out", o->out, "Light set, JSON; of a sequence one set a line")
      ->required()
      ->type_name("FILE");
  command->add_flag("--json", o->json, "Machine-readable summary on stdout");
  return {command, [o] { return run(*o); }};
}

}  // namespace lightwell::cli
