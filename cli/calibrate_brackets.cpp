// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "calibration/photometric/brackets.h"
#include "cli/command.h"
#include "cli/progress.h"
#include "interface/atomic_file.h"
#include "interface/exr_file.h"
#include "interface/option_range.h"
#include "interface/same_file.h"

namespace lightwell::cli {
namespace {

struct Options {
  std::vector<std::string> images;
  std::vector<double> exposures;
  std::string out, radiance, solver = "debevec";
  bool json = false;
};

Status check_outputs(const Options& o) {
  if (!o.radiance.empty() && o.radiance == o.out)
    return usage("--radiance and --out name one file, " + o.out + ", allowed two");
  for (const std::string& output : {o.out, o.radiance})
    for (const std::string& image : o.images)
      if (const Status status = check_output_is_no_input(output, {image}); !status) return status;
  return {};
}

// Both files or neither: nothing is renamed into place before both are written.
Status write(const Options& o, const std::vector<calibration::Photograph>& photographs,
             const calibration::BracketFit& fit) {
  auto out = AtomicFileWriter::create(o.out);
  if (!out) return out.error();
  if (Status status = out->append(calibration::bracket_response_file(fit)); !status) return status;
  if (o.radiance.empty()) return out->commit();
  const auto& picture = photographs.front().picture;
  const auto exr =
      exr_from_floats(picture.width, picture.height, "RGB",
                      calibration::merge_brackets(photographs, fit.response), ExrContent::picture);
  if (!exr) return exr.error();
  auto radiance = AtomicFileWriter::create(o.radiance);
  if (!radiance) return radiance.error();
  if (Status status = radiance->append(*exr); !status) return status;
  if (Status status = radiance->commit(); !status) return status;
  return out->commit();
}

Result<std::vector<calibration::Photograph>> read_all(const Options& o) {
  constexpr int kShrink = 4;  // a mean of 16 pixels: less noise, and a ninth picture still fits into memory
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
  return photographs;
}

std::string percent(const std::optional<double>& error) {
  char text[32] = "unknown";
  if (error) std::snprintf(text, sizeof text, "%.2f %%", 100 * *error);
  return text;
}

void print(const calibration::BracketFit& fit) {
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
  std::printf("; %s\n", fit.absolute ? "cd/m2 by aperture and ISO: check with `calibrate verify`"
                                     : "luminance in units of mid grey, as no aperture and ISO are known");
}

int run(const Options& o) {
  if (o.solver != "debevec" && o.solver != "robertson")
    return fail(usage("--solver = " + o.solver.substr(0, 40) + ": allowed debevec, robertson"));
  if (const Status outputs = check_outputs(o); !outputs) return fail(outputs.error());
  if (const Status number = calibration::check_number_of_photographs(o.images.size()); !number)
    return fail(number.error());
  auto photographs = read_all(o);
  if (!photographs) return fail(photographs.error());
  const auto fit =
      calibration::fit_brackets(*photographs, o.solver == "debevec" ? calibration::BracketSolver::debevec
                                                                    : calibration::BracketSolver::robertson);
  if (!fit) return fail(fit.error());
  if (const Status status = write(o, *photographs, *fit); !status) return fail(status.error());
  if (const std::string warning = calibration::channel_warning(*fit); !warning.empty())
    std::fprintf(stderr, "lightwell: %s\n", warning.c_str());
  if (o.json) {
    std::printf("%s\n", calibration::report_to_json(*fit)
                            .dump(2, ' ', false, nlohmann::json::error_handler_t::replace)
                            .c_str());
    return 0;
  }
  print(*fit);
  return 0;
}

}  // namespace

Command add_calibrate_brackets(CLI::App& group) {
  const auto options = std::make_shared<Options>();
  CLI::App* command = group.add_subcommand(
      "brackets", "Fit an ordinary camera's response to photographs at several exposures");
  command->footer("Example: lightwell calibrate brackets IMG_*.JPG --out response.json --radiance room.exr");
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
  command->add_flag("--json", options->json, "The report as JSON on stdout");
  return {command, [options] { return run(*options); }};
}

}  // namespace lightwell::cli
