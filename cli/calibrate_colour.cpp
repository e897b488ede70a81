// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <memory>
#include <string>

#include "calibration/photometric/colour_fit.h"
#include "cli/command.h"
#include "interface/atomic_file.h"
#include "interface/calibration_io.h"
#include "interface/option_range.h"
#include "interface/printable.h"
#include "interface/response_json.h"
#include "interface/same_file.h"

namespace lightwell::cli {
namespace {

struct Options {
  std::string chart, response, out;
  bool json = false;
};

int run(const Options& o) {
  // Not --response: adding the matrix to that file is the usual way.
  if (const Status status = check_output_is_no_input(o.out, {o.chart}); !status) return fail(status.error());
  const auto response = read_response(o.response);
  if (!response) return fail(response.error());
  const auto patches = calibration::read_chart(o.chart, *response);
  if (!patches) return fail(patches.error());
  const auto fit = calibration::fit_colour(*patches, o.chart);
  if (!fit) return fail(fit.error());
  // All that stands in the file stays: the matrix is added, and the report.
  const auto text = read_text_file(o.response);
  if (!text) return fail(text.error());
  auto file = parse_json(*text, o.response);
  if (!file) return fail(file.error());
  file->erase("rec709_from_camera");  // of the identity none is written
  add_colour_matrix(*file, fit->rec709_from_camera);
  (*file)["rec709_from_camera_is"] = "colour chart";
  const std::string report =
      calibration::report_to_json(*fit).dump(2, ' ', false, nlohmann::json::error_handler_t::replace);
  (*file)["colour"] = nlohmann::json::parse(report);
  if (const Status status = write_file_atomically(o.out, file->dump() + "\n"); !status)
    return fail(status.error());
  if (o.json) {
    std::printf("%s\n", report.c_str());
    return 0;
  }
  const Eigen::Matrix3d& m = fit->rec709_from_camera;
  for (Eigen::Index r = 0; r < 3; ++r) std::printf("  %9.5f %9.5f %9.5f\n", m(r, 0), m(r, 1), m(r, 2));
  if (!fit->rejected.empty())
    std::printf("%s is left out: it contradicts all others\n", printable(fit->rejected).c_str());
  std::printf("error %.2f %% of luminance (root mean square), %s kept exactly\n", 100 * fit->rms_error,
              fit->white.c_str());
  return 0;
}

}  // namespace

Command add_calibrate_colour(CLI::App& group) {
  const auto options = std::make_shared<Options>();
  CLI::App* command = group.add_subcommand("colour", "Fit a colour camera's matrix to a colour chart");
  command->footer(
      "Example: lightwell calibrate colour chart.csv --response response.json --out response.json");
  command
      ->add_option("CHART", options->chart,
                   "CSV: code_r, code_g, code_b (or camera_r, …), X, Y, Z (or rec709_r, …) [, name] [, use]")
      ->required()
      ->type_name("CHART.csv");
  command->add_option("--response", options->response, "response.json of the camera")
      ->required()
      ->type_name("FILE");
  command->add_option("--out", options->out, "response.json to write, with rec709_from_camera")
      ->required()
      ->check(output_file())
      ->type_name("FILE");
  command->add_flag("--json", options->json, "The report as JSON on stdout");
  return {command, [options] { return run(*options); }};
}

}  // namespace lightwell::cli
