// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <memory>
#include <optional>
#include <string>

#include "calibration/photometric/response_report.h"
#include "cli/command.h"
#include "interface/atomic_file.h"
#include "interface/calibration_io.h"
#include "interface/option_range.h"
#include "interface/printable.h"
#include "interface/same_file.h"

namespace lightwell::cli {
namespace {

struct Options {
  std::string patches, out, model = "auto", channel, recording, positions, chart, lens;
  double luminance_error_percent = 1, clip_code = 0;
  std::optional<double> code_sigma, exposure_us;
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
  const int largest = (1 << (o.bits >= 8 && o.bits <= 16 ? o.bits : 16)) - 1;
  for (const Status& status :
       {in_range("--luminance-error", o.luminance_error_percent, 0.01, 50, "0.01 to 50 percent"),
        in_range("--code-sigma", o.code_sigma.value_or(1), 1e-3, 1e4, "0.001 to 10000 codes"),
        in_range("--bits", o.bits, o.bits == 0 ? 0 : 8, 16, "8 to 16, or 0 to guess"),
        in_range("--clip-code", o.clip_code, o.clip_code == 0 ? 0 : 1, largest,
                 ("1 to " + std::to_string(largest) + ", or 0 for the largest code").c_str()),
        in_range("--exposure-us", o.exposure_us.value_or(1), 1e-3, 1e9, "0.001 to 1e9")})
    if (!status) return status.error();
  out.luminance_error = o.luminance_error_percent / 100;
  if (o.code_sigma) out.code_sigma = *o.code_sigma;
  out.bits = o.bits;
  out.clip_code = o.clip_code;
  out.reference_exposure_us = o.exposure_us.value_or(0);
  return out;
}

Status check_sources(const Options& o) {
  if (!o.recording.empty() && o.positions.empty() == o.chart.empty())
    return usage("--recording needs one of --positions and --chart, to know where the patches are");
  if (o.recording.empty() && !(o.positions.empty() && o.chart.empty()))
    return usage(std::string(o.chart.empty() ? "--positions" : "--chart") + " needs --recording");
  if (o.chart.empty() && !o.lens.empty()) return usage("--lens needs --chart");
  if (!o.recording.empty() && o.code_sigma)
    return usage("--code-sigma goes without --recording, whose frames tell it");
  return check_output_is_no_input(o.out, {o.patches, o.recording, o.positions, o.lens});
}

Result<calibration::RecordedPatches> measure(const Options& o, const calibration::ResponseFitOptions& fit) {
  calibration::RecordedPatchesOptions options;
  options.recording = o.recording;
  options.positions = o.positions;
  if (!o.chart.empty()) {
    const auto chart = calibration::chart_from_text(o.chart);
    if (!chart) return usage("--" + chart.error().message);
    options.chart = *chart;
  }
  if (!o.lens.empty()) {
    const auto lens = read_lens(o.lens);
    if (!lens) return lens.error();
    options.lens = *lens;
  }
  return calibration::measure_patches(o.patches, options, fit);
}

Result<calibration::ResponseReport> make_report(const Options& o) {
  const auto options = fit_options(o);
  if (!options) return options.error();
  if (const Status status = check_sources(o); !status) return status.error();
  if (o.recording.empty()) {
    const auto patches = calibration::read_patches(o.patches);
    if (!patches) return patches.error();
    return calibration::calibrate_response(*patches, o.channel, *options);
  }
  auto recorded = measure(o, *options);
  if (!recorded) return recorded.error();
  auto report = calibration::calibrate_response(recorded->set, o.channel, *options);
  if (report) report->recorded = *std::move(recorded);
  return report;
}

int run(const Options& o) {
  const auto report = make_report(o);
  if (!report) return fail(report.error());
  if (const Status status = write_file_atomically(o.out, calibration::response_file(*report)); !status)
    return fail(status.error());
  if (report->recorded)
    for (const std::string& line : report->recorded->left_out)
      std::fprintf(stderr, "lightwell: %s, left out\n", printable(line).c_str());
  for (const std::string& line : calibration::assumption_lines(*report))
    std::fprintf(stderr, "lightwell: %s\n", line.c_str());
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
  command->footer(
      "Examples: lightwell calibrate response patches.csv --out calibration/response.json\n"
      "          lightwell calibrate response luminances.csv --recording chart.mkv --chart 6x2 --out "
      "response.json");
  command
      ->add_option("PATCHES", options->patches,
                   "CSV: luminance_cd_m2, code [, code_sigma] [, channel] [, use = fit or check] [, name] "
                   "[, exposure_us]; with --recording: luminance_cd_m2, patch [, use]")
      ->required()
      ->type_name("PATCHES.csv");
  command->add_option("--out", options->out, "response.json to write")
      ->required()
      ->check(output_file())
      ->type_name("FILE");
  command
      ->add_option(
          "--recording", options->recording,
          "Take of the patches: codes and their noise are measured in its frames, of one exposure or several")
      ->type_name("TAKE.mkv");
  command
      ->add_option("--positions", options->positions,
                   "CSV: patch, x, y, w, h: where they are in the frames, pixels")
      ->type_name("FILE.csv");
  command
      ->add_option("--chart", options->chart,
                   "The patches are those of a chart of `calibrate chart`, found by its markers")
      ->type_name("COLSxROWS");
  command->add_option("--lens", options->lens, "lens.json, to find a chart that a fisheye bends")
      ->type_name("FILE");
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
                   "Of a code; default: the fewest of 8, 10, 12, 14, 16 that hold all, said as assumed")
      ->type_name("N");
  command
      ->add_option("--clip-code", options->clip_code,
                   "Codes from here on are clipped; default: the largest, "
                   "said as assumed")
      ->type_name("CODE");
  command
      ->add_option("--exposure-us", options->exposure_us,
                   "Exposure that the response holds for, microseconds; "
                   "default: the patches' own, else 10000, said as assumed")
      ->type_name("US");
  command->add_option("--channel", options->channel, "Colour to fit where there are several; default: green")
      ->type_name("NAME");
  command->add_flag("--json", options->json, "The report as JSON on stdout");
  return {command, [options] { return run(*options); }};
}

}  // namespace lightwell::cli
