// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calibration/photometric/bracket_map.h"
#include "calibration/photometric/bracket_merge.h"
#include "calibration/photometric/brackets.h"
#include "cli/command.h"
#include "cli/progress.h"
#include "interface/atomic_file.h"
#include "interface/calibration_io.h"
#include "interface/environment_io.h"
#include "interface/exr_file.h"
#include "interface/option_range.h"
#include "interface/printable.h"
#include "interface/same_file.h"

namespace lightwell::cli {
namespace {

constexpr int kShrink = 4;  // squares of 16 pixels: less noise

struct Options {
  std::vector<std::string> images;
  std::vector<double> exposures;
  std::string out, radiance, solver = "debevec";
  std::string lens, flat, map;
  double scale = 1;
  bool json = false;
};

Status check_outputs(const Options& o) {
  const std::vector<std::pair<const char*, std::string>> outputs = {
      {"--out", o.out}, {"--radiance", o.radiance}, {"--map", o.map}};
  for (std::size_t i = 0; i < outputs.size(); ++i)
    for (std::size_t k = 0; k < i; ++k)
      if (is_one_output(outputs[i].second, outputs[k].second))
        return usage(std::string(outputs[i].first) + " and " + outputs[k].first + " name one file, " +
                     outputs[i].second + ", allowed two");
  std::vector<std::string> inputs = o.images;
  inputs.insert(inputs.end(), {o.lens, o.flat});
  for (const auto& output : outputs)
    for (const std::string& input : inputs)
      if (const Status status = check_output_is_no_input(output.second, {input}); !status) return status;
  return {};
}

Status check_usage(const Options& o) {
  if (o.solver != "debevec" && o.solver != "robertson")
    return usage("--solver = " + o.solver.substr(0, 40) + ": allowed debevec, robertson");
  if (o.map.empty() != o.lens.empty())
    return usage(o.map.empty() ? "--lens needs --map: it says where the map's light comes from"
                               : "--map needs --lens: where does each pixel look?");
  if (!o.flat.empty() && o.lens.empty()) return usage("--flat needs --lens and --map");
  return check_outputs(o);
}

// Where the lens looks and what it darkens, as far as they were asked for; read before the photographs are.
struct Optics {
  std::optional<Lens> lens;
  FlatField flat;
};

Result<Optics> read_optics(const Options& o) {
  Optics optics;
  if (o.lens.empty()) return optics;
  auto lens = read_lens(o.lens);
  if (!lens) return lens.error();
  optics.lens = *std::move(lens);
  if (o.flat.empty()) return optics;
  auto flat = read_flat_field(o.flat);
  if (!flat) return flat.error();
  optics.flat = *std::move(flat);
  if (const Status status = check(optics.flat, *optics.lens); !status)
    return Error{status.error().kind, o.flat + ": " + status.error().message};
  return optics;
}

// All files or none: nothing is renamed into place before everything is written.
Status write_all(const std::vector<std::pair<std::string, std::string>>& files) {
  std::vector<AtomicFileWriter> writers;
  for (const auto& [name, bytes] : files) {
    auto writer = AtomicFileWriter::create(name);
    if (!writer) return writer.error();
    if (Status status = writer->append(bytes); !status) return status;
    writers.push_back(*std::move(writer));
  }
  for (AtomicFileWriter& writer : writers)
    if (Status status = writer.commit(); !status) return status;
  return {};
}

// Writes what was asked for. The map, where it is among that.
Result<std::optional<calibration::BracketMap>> write(const Options& o,
                                                     const std::vector<calibration::Photograph>& photographs,
                                                     const Optics& optics,
                                                     const calibration::BracketFit& fit) {
  std::vector<std::pair<std::string, std::string>> files;
  std::optional<calibration::BracketMap> map;
  if (!o.radiance.empty() || !o.map.empty()) {
    const RadiancePicture radiance = calibration::merge_brackets(photographs, fit.response, kShrink);
    if (!o.radiance.empty()) {
      auto exr = exr_from_floats(radiance.width, radiance.height, "RGB", radiance.rgb, ExrContent::picture);
      if (!exr) return exr.error();
      files.emplace_back(o.radiance, *std::move(exr));
    }
    if (!o.map.empty()) {
      auto made = calibration::bracket_map(radiance, photographs.front(), kShrink, *optics.lens, optics.flat);
      if (!made) return made.error();
      map = *std::move(made);
      auto exr = environment_to_exr(lat_long_of_measured(map->map));
      if (!exr) return exr.error();
      files.emplace_back(o.map, *std::move(exr));
    }
  }
  files.emplace_back(o.out, calibration::bracket_response_file(fit));
  if (const Status status = write_all(files); !status) return status.error();
  return map;
}

// A common factor (a filter, a clock) changes no curve; other ratios do, and a wrong power of all of them foretells the
// photographs as well as the right one: only the file's own word can tell.
void warn_of_exif(const std::vector<calibration::Photograph>& photographs) {
  constexpr double kMost = 1.25;  // EXIF's times are nominal: 1/60 for 1/64
  const calibration::Photograph* first = nullptr;
  for (const auto& p : photographs) {
    if (!p.exif_exposure_s) continue;
    if (first == nullptr) first = &p;
    const double stated = p.exposure_s / first->exposure_s,
                 own = *p.exif_exposure_s / *first->exif_exposure_s;
    if (stated < kMost * own && own < kMost * stated) continue;
    std::fprintf(stderr,
                 "lightwell: --exposures gives %s %.4g times the exposure of %s, its EXIF data %.4g times: "
                 "the curve is "
                 "wrong if EXIF is right\n",
                 printable(p.file).c_str(), stated, printable(first->file).c_str(), own);
    return;
  }
}

Result<std::vector<calibration::Photograph>> read_all(const Options& o) {
  if (!o.exposures.empty() && o.exposures.size() != o.images.size())
    return usage("--exposures: " + std::to_string(o.exposures.size()) +
                 " values: allowed one for each of the " + std::to_string(o.images.size()) + " photographs");
  std::vector<calibration::Photograph> photographs;
  Progress progress(o.images.size());
  for (std::size_t i = 0; i < o.images.size(); ++i) {
    if (!o.exposures.empty() && !(o.exposures[i] > 0 && o.exposures[i] < 1e5))
      return usage("--exposures: allowed seconds above 0, below 1e5");
    auto photograph =
        calibration::read_photograph(o.images[i], o.exposures.empty() ? 0 : o.exposures[i], kShrink);
    if (!photograph) return photograph.error();
    photographs.push_back(*std::move(photograph));
    progress.done(i + 1);
  }
  warn_of_exif(photographs);
  return photographs;
}

std::string percent(const std::optional<double>& error) {
  char text[32] = "unknown";
  if (error) std::snprintf(text, sizeof text, "%.2f %%", 100 * *error);
  return text;
}

void print_text(const calibration::BracketFit& fit, const std::optional<calibration::BracketMap>& map) {
  for (const auto& p : fit.predictions)
    std::printf("%s  %10.6f s  foretold from the others to %s (median of %zu pixels)\n", p.file.c_str(),
                p.exposure_s, percent(p.median_error).c_str(), p.pixels);
  const auto& of = fit.channel_median_error;
  if (fit.median_error)
    std::printf("median error %s (red %s, green %s, blue %s) by the curve of green",
                percent(fit.median_error).c_str(), percent(of[0]).c_str(), percent(of[1]).c_str(),
                percent(of[2]).c_str());
  else
    std::printf("error unknown: no exposure was kept out, which takes four photographs or more that overlap");
  std::printf("; %s\n", fit.scale != 1 ? "luminance scaled as --scale says"
                        : fit.absolute ? "cd/m2 by aperture and ISO: check with `calibrate verify`"
                                       : "luminance in units of mid grey, as no aperture and ISO are known");
  if (!map) return;
  std::printf(
      "map: %.1f %% of the sphere seen, %.6g lux on a surface that faces as the lens does, %.6g lux "
      "on a level one; %u pixels clipped in every photograph\n",
      100 * static_cast<double>(map->map.coverage), map->facing_lux, map->upward_lux,
      map->map.clipped_pixels);
}

int run(const Options& o) {
  if (const Status status = check_usage(o); !status) return fail(status.error());
  if (const Status number = calibration::check_number_of_photographs(o.images.size()); !number)
    return fail(number.error());
  const auto optics = read_optics(o);
  if (!optics) return fail(optics.error());
  auto photographs = read_all(o);
  if (!photographs) return fail(photographs.error());
  auto fit =
      calibration::fit_brackets(*photographs, o.solver == "debevec" ? calibration::BracketSolver::debevec
                                                                    : calibration::BracketSolver::robertson);
  if (!fit) return fail(fit.error());
  if (const Status status = calibration::scale_luminance(*fit, o.scale); !status) return fail(status.error());
  const auto map = write(o, *photographs, *optics, *fit);
  if (!map) return fail(map.error());
  if (const std::string warning = calibration::channel_warning(*fit); !warning.empty())
    std::fprintf(stderr, "lightwell: %s\n", warning.c_str());
  if (!o.json) {
    print_text(*fit, *map);
    return 0;
  }
  auto report = calibration::report_to_json(*fit);
  if (*map) report["map"] = calibration::to_json(**map);
  std::printf("%s\n", report.dump(2, ' ', false, nlohmann::json::error_handler_t::replace).c_str());
  return 0;
}

}  // namespace

Command add_calibrate_brackets(CLI::App& group) {
  const auto options = std::make_shared<Options>();
  CLI::App* command = group.add_subcommand(
      "brackets", "Fit an ordinary camera's response to photographs at several exposures");
  command->footer(
      "Examples: lightwell calibrate brackets IMG_*.JPG --out response.json --radiance room.exr\n"
      "          lightwell calibrate brackets IMG_*.JPG --out response.json --lens lens.json --map room.exr");
  command->add_option("IMAGES", options->images, "JPEG photographs of one still scene, 3 or more")
      ->required();
  command->add_option("--out", options->out, "response.json to write")
      ->required()
      ->check(output_file())
      ->type_name("FILE");
  command->add_option("--exposures", options->exposures, "Seconds, one a photograph; default: from EXIF")
      ->delimiter(',')
      ->type_name("S,S,...");
  command
      ->add_option("--solver", options->solver,
                   "debevec (default, smooths) or robertson (does not; give it uneven steps)")
      ->type_name("NAME");
  command->add_option("--radiance", options->radiance, "The merged radiance, a quarter of the size")
      ->check(output_file())
      ->type_name("FILE.exr");
  command
      ->add_option(
          "--map", options->map,
          "The merged radiance as a latitude-longitude map, for `lights`, `verify` and the renderer; "
          "black where the lens does not look")
      ->check(output_file())
      ->type_name("FILE.exr");
  command->add_option("--lens", options->lens, "lens.json of the camera, at the photographs' full size")
      ->type_name("FILE");
  command->add_option("--flat", options->flat, "flat.json with the lens's vignetting, to be divided out")
      ->type_name("FILE");
  command
      ->add_option("--scale", options->scale,
                   "Multiplies all luminances: what `calibrate verify --environment MAP` says would agree")
      ->check(numbers_from(1e-6, 1e6, "1e-6 to 1e6"))
      ->type_name("X");
  command->add_flag("--json", options->json, "The report as JSON on stdout");
  return {command, [options] { return run(*options); }};
}

}  // namespace lightwell::cli
