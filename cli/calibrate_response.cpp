// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <memory>
#include <string>

#include "calibration/photometric/response_report.h"
#include "cli/command.h"
#include "interface/atomic_file.h"
#include "interface/same_file.h"

namespace lightwell::cli {
namespace {

struct Options {
  std::string patches, out, model = "auto", channel;
  double luminance_error_percent = 1, code_sigma = 0.5, clip_code = 0, exposure_us = 10000;
  int bits = 0;
  bool json = false;
};

Result<calibration::ResponseFitOptions> fit_options(const Options& o) {
  calibration::ResponseFitOptions out;
  if (o.model != "auto") {
    out.curve = calibration::curve_from_name(o.model);
    if (!out.curve)
      return usage("--model = " + o.model.substr(0, 40) + ": allowed log, linlog, pwl, linear, auto");
  }
  const auto in_range = [](const char* option, double value, double low, double high,
                           const char* allowed) -> Status {
    if (value >= low && value <= high) return {};
    char text[120];
    std::snprintf(text, sizeof text, "%s = %g: allowed %s", option, value, allowed);
    return usage(text);
  };
  for (const Status& status :
       {in_range("--luminance-error", o.luminance_error_percent, 0.01, 50, "0.01 to 50 percent"),
        in_range("--code-sigma", o.code_sigma, 1e-3, 1e4, "0.001 to 10000 codes"),
        in_range("--bits", o.bits, 0, 16, "8 to 16, or 0 to guess"),
        in_range("--clip-code", o.clip_code, 0, 65535, "1 to 65535, or 0 for the largest code"),
        in_range("--exposure-us", o.exposure_us, 1e-3, 1e9, "0.001 to 1e9")})
    if (!status) return status.error();
  out.luminance_error = o.luminance_error_percent / 100;
  out.code_sigma = o.code_sigma;
  out.bits = o.bits;
  out.clip_code = o.clip_code;
  out.reference_exposure_us = o.exposure_us;
  return out;
}

int run(const Options& o) {
  const auto options = fit_options(o);
  if (!options) return fail(options.error());
  if (const Status other = check_output_is_no_input(o.out, {o.patches}); !other) return fail(other.error());
  const auto patches = calibration::read_patches(o.patches);
  if (!patches) return fail(patches.error());
  const auto report = calibration::calibrate_response(*patches, o.channel, *options);
  if (!report) return fail(report.error());
  if (const Status status = write_file_atomically(o.out, calibration::response_file(*report)); !status)
    return fail(status.error());
  if (o.json)
    std::printf("%s\n", calibration::report_to_json(*report)
                            .dump(2, ' ', false, nlohmann::json::error_handler_t::replace)
                            .c_str());
  else
    std::printf("%s", calibration::summary(*report).c_str());
  return 0;
}

}  // namespace

Command add_calibrate_response(CLI::App& group) {
  const auto options = std::make_shared<Options>();
  CLI::App* command =
      group.add_subcommand("response", "Fit how codes follow luminance to patches of known luminance");
  command->footer("Example: lightwell calibrate response patches.csv --out calibration/response.json");
  command
      ->add_option("PATCHES", options->patches,
                   "CSV: luminance_cd_m2, code [, code_sigma] [, channel] [, use = fit or check] [, name]")
      ->required()
      ->type_name("PATCHES.csv");
  command->add_option("--out", options->out, "response.json to write")->required()->type_name("FILE");
  command
      ->add_option("--model", options->model,
                   "log, linlog, pwl, linear; auto: the simplest that the patches support")
      ->type_name("MODEL");
  command
      ->add_option("--luminance-error", options->luminance_error_percent,
                   "Standard deviation of the patches' luminances, percent (1)")
      ->type_name("PERCENT");
  command
      ->add_option("--code-sigma", options->code_sigma,
                   "Standard deviation of codes that have none in the file (0.5)")
      ->type_name("CODES");
  command
      ->add_option("--bits", options->bits,
                   "Of a code; default: the fewest of 8, 10, 12, 14, 16 that hold all")
      ->type_name("N");
  command
      ->add_option("--clip-code", options->clip_code, "Codes from here on are clipped; default: the largest")
      ->type_name("CODE");
  command->add_option("--exposure-us", options->exposure_us, "Exposure of the patches, microseconds (10000)")
      ->type_name("US");
  command->add_option("--channel", options->channel, "Colour to fit where there are several; default: green")
      ->type_name("NAME");
  command->add_flag("--json", options->json, "The report as JSON on stdout");
  return {command, [options] { return run(*options); }};
}

}  // namespace lightwell::cli
