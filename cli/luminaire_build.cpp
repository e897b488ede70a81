// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "calibration/luminaire/lamp_build.h"
#include "cli/command.h"
#include "cli/luminaire_output.h"
#include "cli/progress.h"
#include "interface/luminaire_file.h"
#include "interface/option_range.h"
#include "interface/printable.h"

namespace lightwell::cli {
namespace {

struct BuildArguments {
  std::string folder, out;
  bool json = false;
};

nlohmann::ordered_json json_of(const calibration::BuiltLamp& built, const std::string& out) {
  const LampPlanes& planes = built.measured.irradiance.planes;
  const Rgbd flux = luminous_flux(built.lamp);
  return {{"schema", "lightwell.luminaire-build/1"},
          {"out", out},
          {"name", built.lamp.name},
          {"flux_lm", flux[1]},
          {"flux_lm_rgb", {flux[0], flux[1], flux[2]}},
          {"positions", planes.positions},
          {"positions_without_picture", built.completed},
          {"largest_deviation_spacings", built.largest_deviation},
          {"picture_size", built.picture_size},
          {"mark_rms_px", built.mark_rms_px},
          {"most_saturated", built.most_saturated},
          {"most_negative", built.most_negative},
          {"scale_of_reference", built.scale},
          {"remarks", built.remarks}};
}

int run(const BuildArguments& o) {
  const std::filesystem::path folder = o.folder;
  const auto rig = read_rig(folder);
  if (!rig) return fail(rig.error());
  std::vector<std::string> inputs = {folder / "rig.toml", folder / "positions.csv"};
  if (!rig->dark.empty()) inputs.push_back(folder / rig->dark);
  for (const Rig::Picture& picture : rig->pictures) inputs.push_back(folder / picture.file);
  if (const Status good = check_luminaire_output(o.out, ".exr", inputs); !good) return fail(good.error());
  std::optional<Progress> bar;
  const auto built = calibration::build_lamp(*rig, folder, calibration::exr_pictures(folder),
                                             [&](std::size_t done, std::size_t all) {
                                               if (!bar) bar.emplace(all);
                                               bar->done(done);
                                             });
  bar.reset();
  if (!built) return fail(built.error());
  for (const std::string& remark : built->remarks)
    std::fprintf(stderr, "lightwell: %s: %s\n", printable(o.folder).c_str(), printable(remark).c_str());
  if (const Status written = write_luminaire(o.out, built->lamp); !written) return fail(written.error());
  if (o.json) {
    std::printf(
        "%s\n",
        json_of(*built, o.out).dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace).c_str());
    return 0;
  }
  const auto& positions = built->measured.irradiance.planes.positions;
  std::printf("%s: %.6g lm, %dx%d positions\n", printable(o.out).c_str(), luminous_flux(built->lamp)[1],
              positions[0], positions[1]);
  return 0;
}

}  // namespace

Command add_luminaire_build(CLI::App& luminaire) {
  const auto o = std::make_shared<BuildArguments>();
  CLI::App* command = luminaire.add_subcommand("build", "A lamp from pictures that a rig took");
  command->footer(
      "Example: lightwell luminaire build bike-light --out bike-light.exr\n"
      "The folder holds rig.toml, positions.csv and the pictures: docs/user-guide/luminaires.md");
  command->add_option("folder", o->folder, "The rig's folder")->required()->type_name("DIR");
  command->add_option("--out", o->out, "The lamp, EXR")->required()->check(output_file())->type_name("FILE");
  command->add_flag("--json", o->json, "Machine-readable result on stdout");
  return {command, [o] { return run(*o); }};
}

}  // namespace lightwell::cli
