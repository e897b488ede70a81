// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "cli/command.h"
#include "cli/progress.h"
#include "interface/recording.h"
#include "interface/same_file.h"

namespace lightwell::cli {

Command add_repair(CLI::App& app) {
  struct Options {
    std::string broken, out;
    bool json = false;
  };
  const auto options = std::make_shared<Options>();
  CLI::App* command =
      app.add_subcommand("repair", "Save every whole frame of a cut or damaged take into a new one");
  command->footer("Example: lightwell repair broken.mkv --out take.mkv");
  command->add_option("BROKEN", options->broken, "Recording (.mkv); it is only read")->required();
  command->add_option("--out", options->out, "The new take; never overwrites")->required();
  command->add_flag("--json", options->json, "Machine-readable result on stdout");
  return {command, [options] {
            if (const Status other = check_output_is_no_input(options->out, {options->broken}); !other)
              return fail(other.error());
            constexpr std::size_t kSteps = 1000;
            Progress progress(kSteps);
            const auto report = repair_recording(options->broken, options->out, [&](double share) {
              progress.done(static_cast<std::size_t>(share * static_cast<double>(kSteps)));
            });
            if (!report) return fail(report.error());
            if (options->json) {
              const nlohmann::ordered_json json = {{"schema", "lightwell.repair/1"},
                                                   {"out", options->out},
                                                   {"recovered", report->recovered},
                                                   {"damaged", report->damaged},
                                                   {"calibration_lost", report->calibration_lost}};
              std::printf("%s\n", json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace).c_str());
              return 0;
            }
            std::printf("%s: %llu whole frames recovered, %llu damaged frames left out\n",
                        options->out.c_str(), static_cast<unsigned long long>(report->recovered),
                        static_cast<unsigned long long>(report->damaged));
            if (report->calibration_lost)
              std::printf("the attached calibration was damaged and is left out\n");
            return 0;
          }};
}

}  // namespace lightwell::cli
