// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "calibration/lens_calibration.h"
#include "calibration/lens_report.h"
#include "cli/command.h"
#include "interface/atomic_file.h"

namespace lightwell::cli {
namespace {

struct LensOptions {
  std::string corners;
  std::string out;
  bool json = false;
};

void print_text(const LensCalibration& c, const TargetViews& target_views, const std::string& out) {
  std::size_t used = 0;
  for (const ViewResult& view : c.views) {
    used += view.used;
    if (!view.used) std::printf("not used: %s: %s\n", view.name.c_str(), view.reason.c_str());
  }
  std::printf("views             %zu of %zu\n", used, c.views.size());
  std::printf("focal             %.3f %.3f px a radian\n", c.lens.focal.x(), c.lens.focal.y());
  std::printf("center            %.3f %.3f\n", c.lens.center.x(), c.lens.center.y());
  std::printf("k                ");
  for (int i = 0; i < c.freedom.coefficients; ++i)
    std::printf(" %.6f", c.lens.k[static_cast<std::size_t>(i)]);
  std::printf("\nerror             %.3f px rms, %.3f px on views held out\n", c.rms_px, c.held_out_rms_px);
  std::printf("field             to %.1f degrees off axis\n", c.lens.max_theta_rad * 180 / kPi);
  if (const std::string gaps = coverage_gaps(c, target_views); !gaps.empty())
    std::printf("no points         %s\n", gaps.c_str());
  std::printf("written           %s\n", out.c_str());
}

int run(const LensOptions& options) {
  const auto target_views = read_target_views(options.corners);
  if (!target_views) return fail(target_views.error());
  const auto calibration = calibrate_lens(*target_views);
  if (!calibration)
    return fail({calibration.error().kind, options.corners + ": " + calibration.error().message});
  const nlohmann::ordered_json report = lens_report(*calibration, *target_views);
  if (const Status status = write_file_atomically(options.out, report.dump() + "\n"); !status)
    return fail(status.error());
  if (options.json)
    std::printf("%s\n", report.dump().c_str());
  else
    print_text(*calibration, *target_views, options.out);
  return 0;
}

}  // namespace

Command add_calibrate_lens(CLI::App& calibrate) {
  const auto o = std::make_shared<LensOptions>();
  CLI::App* command = calibrate.add_subcommand(
      "lens", "Kannala-Brandt lens, to 180 degrees and beyond, from views of a board");
  command->footer("Example: lightwell calibrate lens --corners corners.json --out lens.json");
  command
      ->add_option(
          "--corners", o->corners,
          "Points of the target and their pixels: {\"image_size\": [w, h], \"views\": [{\"name\": .., "
          "\"points\": [[X, Y, Z, u, v], ..]}]}, mm and pixels")
      ->required();
  command->add_option("--out", o->out, "The lens, with its uncertainty, JSON")->required();
  command->add_flag("--json", o->json, "The same on stdout");
  return {command, [o] { return run(*o); }};
}

}  // namespace lightwell::cli
