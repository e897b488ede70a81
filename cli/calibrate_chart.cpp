// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <memory>
#include <string>

#include "calibration/photometric/grey_chart.h"
#include "cli/command.h"
#include "interface/atomic_file.h"
#include "interface/option_range.h"

namespace lightwell::cli {
namespace {

struct Options {
  std::string patches = "6x2", out;
  double cell_mm = 40;
};

int run(const Options& o) {
  const auto chart = calibration::chart_from_text(o.patches);
  if (!chart) return fail(usage("--patches: " + chart.error().message));
  if (!(o.cell_mm >= 5 && o.cell_mm <= 1000)) return fail(usage("--cell-mm: allowed 5 to 1000"));
  if (const Status status = write_file_atomically(o.out, calibration::chart_svg(*chart, o.cell_mm)); !status)
    return fail(status.error());
  std::printf("%s: %d patches, %g x %g mm\n", o.out.c_str(), chart->patches(), chart->columns * o.cell_mm,
              (chart->rows + 2) * o.cell_mm);
  return 0;
}

}  // namespace

Command add_calibrate_chart(CLI::App& group) {
  const auto options = std::make_shared<Options>();
  CLI::App* command = group.add_subcommand(
      "chart",
      "Draw a grey chart whose patches `calibrate response --chart` finds by the markers at its corners");
  command->footer("Example: lightwell calibrate chart --patches 6x2 --cell-mm 45 --out chart.svg");
  command->add_option("--patches", options->patches, "Columns and rows of patches (6x2)")
      ->type_name("COLSxROWS");
  command->add_option("--cell-mm", options->cell_mm, "Width of a patch with its border, millimetres (40)")
      ->type_name("MM");
  command->add_option("--out", options->out, "SVG to write, to be printed at its own size")
      ->required()
      ->check(output_file())
      ->type_name("FILE.svg");
  return {command, [options] { return run(*options); }};
}

}  // namespace lightwell::cli
