// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <filesystem>
#include <memory>

#include "bench/suite.h"
#include "cli/command.h"
#include "interface/atomic_file.h"
#include "interface/option_range.h"

namespace lightwell::cli {
namespace {

struct Asked {
  std::string suite = "all";
  std::string json_file;
  std::string svg_folder;
  bench::Options options;
};

std::vector<bench::Figure> figures_of(const bench::Suite& suite, const std::vector<bench::Row>& rows) {
  if (suite.figures != nullptr) return suite.figures(rows);
  return {{suite.name, bench::to_svg(suite.name, rows)}};
}

int run(const Asked& asked) {
  // Before minutes of work, not after.
  for (const std::filesystem::path& folder :
       {std::filesystem::path(asked.svg_folder), std::filesystem::path(asked.json_file).parent_path()})
    if (!folder.empty() && !std::filesystem::is_directory(folder))
      return fail({ErrorKind::failed, folder.string() + ": no such folder"});
  std::vector<std::pair<std::string, std::vector<bench::Row>>> results;
  for (const bench::Suite& suite : bench::suites()) {
    if (asked.suite != "all" && asked.suite != suite.name) continue;
    std::fprintf(stderr, "running suite %s\n", suite.name.c_str());
    results.emplace_back(suite.name, suite.run(asked.options));
    std::printf("%s", bench::to_text(suite.name, results.back().second).c_str());
    std::fflush(stdout);
  }
  if (!asked.json_file.empty())
    if (const Status status = write_file_atomically(asked.json_file, bench::to_json(results)); !status)
      return fail(status.error());
  if (!asked.svg_folder.empty())
    for (const bench::Suite& suite : bench::suites())
      for (const auto& [name, rows] : results)
        if (name == suite.name)
          for (const bench::Figure& figure : figures_of(suite, rows))
            if (const Status status = write_file_atomically(
                    std::filesystem::path(asked.svg_folder) / (figure.name + ".svg"), figure.svg);
                !status)
              return fail(status.error());
  return 0;
}

}  // namespace

Command add_bench(CLI::App& app) {
  const auto asked = std::make_shared<Asked>();
  CLI::App* command = app.add_subcommand("bench", "Measures speed against error, with peers in the same run");
  std::vector<std::string> names = {"all"};
  for (const bench::Suite& suite : bench::suites()) names.push_back(suite.name);
  command->add_option("--suite", asked->suite, "Which suite")
      ->check(CLI::IsMember(names))
      ->capture_default_str();
  command->add_option("--json", asked->json_file, "Write all numbers, CPU, compiler, flags and commit here");
  command->add_option("--svg", asked->svg_folder, "Write plots of each suite into this folder");
  command->add_option("--data", asked->options.data_folder,
                      "Folder of reference data (env/, fisheye_cal/…): cases that need it run too");
  command->add_option("--seconds", asked->options.seconds_per_case, "Time for each case")
      ->check(numbers_from(0, 600, "0 to 600 seconds"))
      ->capture_default_str();
  command->add_option("--peers", asked->options.peers_folder,
                      "Folder of peers in Python (bench/peers): the lights and render suites run them too");
  command->add_option("--references", asked->options.references_folder,
                      "Folder of stored references of the render suite (bench/references); else traced anew");
  command->add_option(
      "--only", asked->options.only_setting,
      "Of the coherence suite, sequences whose name contains this; of the render suite, scenes, or "
      "growth, gloss, steadiness, field light, lamp");
  command->add_option("--followers", asked->options.only_name,
                      "Of the coherence suite, followers whose name contains this");
  command->add_option("--lights", asked->options.lights, "Of the coherence suite, lights of a set")
      ->check(whole_numbers(1, 100000))
      ->capture_default_str();
  command->footer("Example: lightwell bench --suite frame --json out.json --svg .");
  return {command, [asked] { return run(*asked); }};
}

}  // namespace lightwell::cli
