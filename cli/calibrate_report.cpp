// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <memory>
#include <string>

#include "calibration/report/html_report.h"
#include "cli/command.h"
#include "interface/atomic_file.h"
#include "interface/option_range.h"
#include "interface/same_file.h"

namespace lightwell::cli {

Command add_calibrate_report(CLI::App& group) {
  struct Options {
    std::string directory, out;
  };
  const auto options = std::make_shared<Options>();
  CLI::App* command =
      group.add_subcommand("report", "Write one page about a calibration: how good it is, and where not");
  command->footer("Example: lightwell calibrate report calibration --out report.html");
  command->add_option("DIR", options->directory, "Folder with response.json, lens.json, flat.json")
      ->required();
  command->add_option("--out", options->out, "The page, with everything in it")
      ->required()
      ->check(output_file())
      ->type_name("FILE.html");
  return {command, [options] {
            const std::filesystem::path directory = options->directory;
            if (const Status status = check_output_is_no_input(
                    options->out,
                    {directory / "response.json", directory / "lens.json", directory / "flat.json"});
                !status)
              return fail(status.error());
            const auto page = calibration::calibration_page(options->directory);
            if (!page) return fail(page.error());
            if (const Status status = write_file_atomically(options->out, *page); !status)
              return fail(status.error());
            return 0;
          }};
}

}  // namespace lightwell::cli
