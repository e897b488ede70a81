// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <memory>
#include <string>

#include "calibration/photometric/flat_fit.h"
#include "cli/command.h"
#include "interface/atomic_file.h"
#include "interface/calibration_io.h"

namespace lightwell::cli {
namespace {

struct Options {
  std::string recording, dark, lens, response, out;
  bool json = false;
};

int run(const Options& o) {
  const auto lens = read_lens(o.lens);
  if (!lens) return fail(lens.error());
  const auto response = read_response(o.response);
  if (!response) return fail(response.error());
  const auto even = calibration::mean_frame(o.recording);
  if (!even) return fail(even.error());
  std::optional<calibration::MeanFrame> dark;
  if (!o.dark.empty()) {
    auto read = calibration::mean_frame(o.dark);
    if (!read) return fail(read.error());
    dark = *std::move(read);
  }
  const auto fit = calibration::fit_flat_field(*even, dark, *lens, *response, o.recording);
  if (!fit) return fail(fit.error());
  if (const Status status = write_file_atomically(o.out, calibration::flat_file(*fit, *even)); !status)
    return fail(status.error());
  if (o.json) {
    std::printf("%s\n", calibration::report_to_json(*fit, *even).dump(2).c_str());
    return 0;
  }
  std::printf("vignetting   T(t) = 1");
  for (std::size_t i = 0; i < 3; ++i)
    if (static_cast<int>(i) < fit->vignetting_terms)
      std::printf(" %+.5f t^%zu", fit->flat.vignetting[i], 2 * (i + 1));
  std::printf(", %.1f %% left at the edge\n", 100 * fit->flat.transmission(lens->max_theta_rad));
  std::printf("fixed pattern %.3f codes rms, known to %.3f codes, from %s\n", fit->offset_rms_codes,
              fit->offset_sigma_codes, fit->from_dark ? "dark frames" : "the even frames");
  std::printf("scene        even to %.1f %%, %zu pixels, %llu frames", 100 * fit->tilt, fit->pixels,
              static_cast<unsigned long long>(even->frames));
  if (even->temperature_c) std::printf(", %.1f degrees C", *even->temperature_c);
  std::printf("\n");
  return 0;
}

}  // namespace

Command add_calibrate_flat(CLI::App& group) {
  const auto options = std::make_shared<Options>();
  CLI::App* command =
      group.add_subcommand("flat", "Measure fixed pattern and vignetting from frames of an even scene");
  command->footer(
      "Example: lightwell calibrate flat even.mkv --lens lens.json --response response.json --out flat.json");
  command
      ->add_option("RECORDING", options->recording,
                   "Take of an even scene: a diffuser before the lens, overcast sky")
      ->required();
  command->add_option("--lens", options->lens, "lens.json")->required()->type_name("FILE");
  command->add_option("--response", options->response, "response.json")->required()->type_name("FILE");
  command->add_option("--dark", options->dark, "Take with the lens capped: the fixed pattern from it")
      ->type_name("RECORDING");
  command->add_option("--out", options->out, "flat.json to write")->required()->type_name("FILE");
  command->add_flag("--json", options->json, "The report as JSON on stdout");
  return {command, [options] { return run(*options); }};
}

}  // namespace lightwell::cli
