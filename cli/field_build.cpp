// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <sched.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <string>
#include <thread>

#include "cli/command.h"
#include "cli/field_grid_option.h"
#include "cli/field_pictures.h"
#include "cli/field_rays.h"
#include "cli/field_walk.h"
#include "cli/progress.h"
#include "cli/stop_notice.h"
#include "field/field_builder.h"
#include "field/field_state.h"
#include "field/launched_ranks.h"
#include "field/probe_list.h"
#include "interface/atomic_file.h"
#include "interface/field_file.h"
#include "interface/option_range.h"
#include "interface/printable.h"
#include "interface/same_file.h"
#include "interface/writable_output.h"
#include "lighting/field/field_sums.h"

namespace lightwell::cli {
namespace {

struct BuildArguments {
  std::string probes, grid, bounds, out;
  std::string method = "best";
  PictureArguments pictures;
  WalkArguments walk;
  int degree = 4, directions = 0, threads = 0;
  double save_every_s = 30;
  double max_error = 0;
  bool json = false;
};

// What the kernel says can be had without swapping; none where it does not say.
std::optional<double> available_memory_bytes() {
  std::ifstream file("/proc/meminfo");
  std::string word;
  double kib = 0;
  while (file >> word)
    if (word == "MemAvailable:" && file >> kib) return kib * 1024;
  return std::nullopt;
}

// The sums twice, or the sums, OpenVDB's copy of them, what it was before points are left out, and the bytes of the file;
// of other ranks on this machine the sums. Each rank cuts the sphere.
Status check_memory(const BuildArguments& o, const FieldBuildOptions& options, int ranks) {
  const double needed = FieldSums::bytes_needed(options.grid, o.degree) * (3.5 + ranks - 1) +
                        DirectionBins::bytes_needed(options.directions, o.degree) * ranks;
  const auto available = available_memory_bytes();
  if (!available || needed <= *available) return {};
  char text[200];
  std::snprintf(
      text, sizeof text,
      "--grid %s at degree %d in %d directions needs %.1f GB of memory, allowed: up to %.1f GB, what is free",
      o.grid.c_str(), o.degree, options.directions, needed / 1e9, *available / 1e9);
  return usage(text);
}

// This process's share of the machine: where a launcher has bound it to cores, those.
unsigned default_threads(int ranks) {
  const unsigned all = std::max(1u, std::thread::hardware_concurrency());
  cpu_set_t own;
  const unsigned allowed =
      ::sched_getaffinity(0, sizeof own, &own) == 0 ? static_cast<unsigned>(CPU_COUNT(&own)) : all;
  return std::clamp(all / static_cast<unsigned>(ranks), 1u, std::max(1u, allowed));
}

// A field that goes there has it for itself.
bool is_standard_output(const std::filesystem::path& out) {
  struct stat there {
  }, standard{};
  return ::stat(out.c_str(), &there) == 0 && ::fstat(STDOUT_FILENO, &standard) == 0 &&
         !S_ISREG(there.st_mode) && there.st_dev == standard.st_dev && there.st_ino == standard.st_ino;
}

bool is_dark(const LightField& field) {
  return std::all_of(field.radiance.begin(), field.radiance.end(), [](float value) { return value == 0; });
}

struct Prepared {
  FieldBuildOptions options;
  ProbeTake take;
  std::shared_ptr<WalkTake> walk;  // none where pictures are listed
  std::shared_ptr<PictureFaults> faults = std::make_shared<PictureFaults>();
};

void report(const BuildArguments& o, const Prepared& prepared, const FieldBuild& build,
            const FieldFileReport& file, double seconds) {
  const LightField& field = build.field;
  const double confidence = std::accumulate(field.confidence.begin(), field.confidence.end(), 0.0) /
                            static_cast<double>(field.confidence.size());
  const auto points = field.grid.points();
  const std::size_t probes = prepared.take.positions.size();
  if (!o.json) {
    if (is_standard_output(o.out)) return;
    if (prepared.walk) print_walk(*prepared.walk);
    std::printf("probes            %zu, %d directions, %.1f %% of the sphere seen\n", probes,
                build.directions, 100 * build.coverage);
    if (build.support > 0 && std::isfinite(build.held_out_error))
      std::printf("fit               over %d rays, held-out rays err %.3g of the RMS radiance\n",
                  build.support, build.held_out_error);
    else if (build.support > 0)
      std::printf(
          "fit               over %d rays; all in one place: how far the field errs cannot be foretold\n",
          build.support);
    std::printf("confidence        %.1f %% of all directions at all points have a measured ray near\n",
                100 * confidence);
    std::printf("written           %s, %.2f MB, %zu of %zu points, error %.2g\n", o.out.c_str(),
                static_cast<double>(file.bytes) / 1e6, file.stored_points, points, file.rms_error);
    return;
  }
  nlohmann::ordered_json json = {{"schema", "lightwell.field-build/1"},
                                 {"out", o.out},
                                 {"grid", field.grid.size},
                                 {"degree", field.degree},
                                 {"method", o.method},
                                 {"probes", probes},
                                 {"directions", build.directions},
                                 {"coverage", build.coverage},
                                 {"confidence", confidence},
                                 {"points", points},
                                 {"stored_points", file.stored_points},
                                 {"bytes", file.bytes},
                                 {"rms_error", file.rms_error},
                                 {"most_error", file.most_error},
                                 {"seconds", seconds}};
  if (build.support > 0) {
    json["support"] = build.support;
    json["held_out_error"] = build.held_out_error;
    json.update(rays_json(prepared.take, build));
  }
  if (prepared.walk) json["walk"] = walk_json(*prepared.walk, o.walk);
  std::printf("%s\n", json.dump(2).c_str());
}

// From a list of pictures.
Status prepare_list(const BuildArguments& o, Prepared& prepared) {
  if (const Status none = check_no_walk_options(o.walk); !none) return none;
  if (const Status other = check_output_is_no_input(o.out, {o.pictures.lens}); !other) return other;
  auto projection = projection_of(o.pictures);
  if (!projection) return projection.error();
  prepared.options.projection = *std::move(projection);
  auto list = read_probe_list(o.probes);
  if (!list) return list.error();
  for (const std::filesystem::path& file : list->files)
    if (const Status other = check_output_is_no_input(o.out, {file}); !other) return other;
  auto origin = origin_of(o.pictures, *list);
  if (!origin) return origin.error();
  prepared.options.made_from = *std::move(origin);
  prepared.take = take_of(*std::move(list), prepared.faults);
  return {};
}

// From a recording and the poses beside it.
Status prepare_walk(const BuildArguments& o, bool speaks, Prepared& prepared) {
  if (const Status none = check_no_picture_options(o.pictures); !none) return none;
  if (const Status other = check_output_is_no_walk(o.out, o.probes, o.walk); !other) return other;
  const FieldBuildOptions& options = prepared.options;
  auto walk = open_walk(o.probes, o.walk, options.grid, options.directions, speaks);
  if (!walk) return walk.error();
  prepared.walk = *std::move(walk);
  prepared.options.projection = prepared.walk->projection();
  prepared.options.made_from = prepared.walk->origin();
  prepared.take = WalkTake::probes(prepared.walk);
  return {};
}

// Everything that can be wrong before the first picture is read.
Result<Prepared> prepare(const BuildArguments& o, FieldRanks& ranks) {
  Prepared prepared;
  FieldBuildOptions& options = prepared.options;
  const auto grid = field_grid(o.grid, o.bounds);
  if (!grid) return grid.error();
  options.grid = *grid;
  if (o.method != "best" && o.method != "low")
    return usage("--method is " + o.method + ", allowed: best, low");
  options.method = o.method == "best" ? FieldMethod::best : FieldMethod::low;
  if (o.directions == 1)
    return usage("--directions is 1, allowed: 0, or 2 to " + std::to_string(kMostFieldDirections));
  options.degree = o.degree;
  options.directions = o.directions > 0 ? o.directions : direction_count_for(*grid);
  options.threads =
      o.threads > 0 ? static_cast<unsigned>(o.threads) : default_threads(ranks.on_this_machine());
  if (const Status enough = check_memory(o, options, ranks.on_this_machine()); !enough) return enough.error();
  if (const Status other = check_output_is_no_input(o.out, {o.probes}); !other) return other.error();
  const bool speaks = ranks.rank() == 0;
  if (o.json && is_standard_output(o.out))
    return usage("--out " + o.out + " is where --json writes, too, allowed: a file, or no --json");
  if (const Status writes = speaks ? check_can_write(o.out) : Status(); !writes) return writes.error();
  const Status inputs = is_take(o.probes) ? prepare_walk(o, speaks, prepared) : prepare_list(o, prepared);
  if (!inputs) return inputs.error();
  const std::filesystem::path out(o.out);
  options.scratch_folder = out.parent_path();
  options.state_name = out.filename().string() + ".part";
  options.save_every = std::chrono::seconds(static_cast<int>(o.save_every_s));
  options.ranks = &ranks;
  return prepared;
}

Result<FieldBuild> build(const Prepared& prepared, FieldRanks& ranks) {
  const bool speaks = ranks.rank() == 0;
  FieldBuildOptions options = prepared.options;
  options.remark = [](const std::string& line) {
    std::fprintf(stderr, "lightwell: %s\n", printable(line).c_str());
  };
  if (speaks)
    for (const std::string& remark : remarks_on_places(prepared.take.positions, options.grid))
      options.remark(remark);
  std::optional<Progress> bar;
  auto built = build_field(prepared.take, options, [&](std::size_t done, std::size_t total) {
    if (!bar) bar.emplace(total);
    bar->done(done);
  });
  bar.reset();
  if (!built) return built;  // on all ranks, which may not have one take
  for (const std::string& remark : prepared.faults->remarks(prepared.take, ranks))
    if (speaks) options.remark(remark);
  if (!speaks) return built;
  for (const std::string& remark : remarks_on_rays(prepared.take, *built)) options.remark(remark);
  if (is_dark(built->field)) options.remark("no probe has any light: the field is dark");
  return built;
}

int run_as(const BuildArguments& o, FieldRanks& ranks) {
  const auto begin = std::chrono::steady_clock::now();
  const bool speaks = ranks.rank() == 0;
  const auto prepared = prepare(o, ranks);
  if (const Status ready = ranks.agree(prepared ? Status() : prepared.error()); !ready)
    return speaks ? fail(ready.error()) : static_cast<int>(ready.error().kind);
  const StopNotice notice(prepared->options.scratch_folder / prepared->options.state_name);
  // Its state stays locked until it is removed: the same command, started again meanwhile, is told so.
  const auto built = build(*prepared, ranks);
  if (!built) return speaks ? fail(built.error()) : static_cast<int>(built.error().kind);
  if (!speaks) return 0;
  const auto file = write_field(o.out, built->field, {o.method, o.max_error});
  if (!file) return fail(file.error());
  built->state->remove();
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
  report(o, *prepared, *built, *file, taken.count());
  return 0;
}

int run(const BuildArguments& o) {
  const auto ranks = launched_ranks();
  if (!ranks) return launched_rank() == 0 ? fail(ranks.error()) : static_cast<int>(ranks.error().kind);
  if ((*ranks)->count() == 1) return run_as(o, **ranks);
  try {
    return run_as(o, **ranks);
  } catch (const std::exception& error) {  // the others wait for what this one will not do
    const bool memory = dynamic_cast<const std::bad_alloc*>(&error) != nullptr;
    const int code = fail({ErrorKind::failed, "rank " + std::to_string((*ranks)->rank()) + ": " +
                                                  (memory ? "not enough memory" : error.what())});
    (*ranks)->abort(code);
    return code;
  }
}

}  // namespace

Command add_field_build(CLI::App& field) {
  const auto o = std::make_shared<BuildArguments>();
  CLI::App* command = field.add_subcommand("build", "Resample pictures of many places to a grid of light");
  command->footer(
      "Example: lightwell field build probes.csv --grid 32,16,32 --bounds -2,0,-2,2,2,2 --out field.vdb\n"
      "         lightwell field build walk.mkv --grid 16,8,16 --bounds -1,0,-1,1,1,1 --out field.vdb\n"
      "probes.csv: x,y,z,file (metres; images of one size, EXR or Radiance HDR)");
  command
      ->add_option("probes", o->probes,
                   "List of probes, CSV with columns x,y,z,file; or a recording of a walk (TAKE.mkv)")
      ->required()
      ->type_name("FILE");
  command->add_option("--grid", o->grid, "Points along each axis, 2 to 4096, in all up to 512 cubed")
      ->required()
      ->type_name("NX,NY,NZ");
  command->add_option("--bounds", o->bounds, "Places of the outermost points, metres")
      ->required()
      ->type_name("X0,Y0,Z0,X1,Y1,Z1");
  command->add_option("--degree", o->degree, "Degree of the spherical harmonics, 1 to 8")
      ->check(whole_numbers(1, kMostFieldDegree))
      ->capture_default_str();
  command
      ->add_option("--method", o->method,
                   "best: local fits chosen by held-out rays; low: the splat of Löw et al. 2009")
      ->capture_default_str()
      ->type_name("METHOD");
  add_picture_options(*command, o->pictures);
  add_walk_options(*command, o->walk);
  command
      ->add_option("--directions", o->directions,
                   "Into how many directions to cut the sphere, 2 or more; 0: as many as the grid needs")
      ->check(whole_numbers(0, kMostFieldDirections))
      ->capture_default_str();
  command
      ->add_option(
          "--max-error", o->max_error,
          "Leave out points that coarser ones foretell within this part of the field's RMS; 0: store all")
      ->check(numbers_from(0, 1, "0 to 1"))
      ->capture_default_str()
      ->type_name("E");
  command->add_option("--threads", o->threads, "0: one a core; the result is the same, also under mpirun")
      ->check(whole_numbers(0, 1024))
      ->capture_default_str();
  command
      ->add_option("--save-every", o->save_every_s,
                   "Seconds between saves of what is summed, beside the output: an interrupted build goes on "
                   "from there")
      ->check(numbers_from(0, 86400, "0 to 86400 seconds"))
      ->capture_default_str()
      ->type_name("S");
  command->add_option("--out", o->out, "The field, OpenVDB")
      ->required()
      ->check(output_file())
      ->type_name("FILE");
  command->add_flag("--json", o->json, "Machine-readable result on stdout");
  return {command, [o] { return run(*o); }};
}

}  // namespace lightwell::cli
