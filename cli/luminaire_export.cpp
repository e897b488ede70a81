// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "cli/command.h"
#include "cli/luminaire_output.h"
#include "interface/luminaire_file.h"
#include "interface/option_range.h"
#include "interface/photometric_file.h"
#include "interface/printable.h"
#include "lighting/luminaire/far_projection.h"

namespace lightwell::cli {
namespace {

struct ExportArguments {
  std::string lamp, out;
  FarGrid grid;
  bool json = false;
};

PhotometricFile far_file(const Luminaire& lamp, const FarGrid& grid) {
  PhotometricFile file;
  file.lamp = far_field_of(lamp, grid);
  file.name = lamp.name;
  if (lamp.near) {
    const LampPlanes& planes = lamp.near->intensity.planes;
    file.opening_m = planes.spacing_m * Vec3d(planes.positions[0], planes.positions[1], 0);
  }
  return file;
}

int run(const ExportArguments& o) {
  if (const Status good = check_luminaire_output(o.out, ".ies", {&o.lamp, 1}); !good)
    return fail(good.error());
  const auto lamp = read_luminaire(o.lamp);
  if (!lamp) return fail(lamp.error());
  const PhotometricFile file = far_file(*lamp, o.grid);
  const double exported = luminous_flux(file.lamp), flux = luminance(luminous_flux(*lamp));
  constexpr double kNoted = 0.01;
  if (std::abs(exported - flux) > kNoted * flux)
    std::fprintf(
        stderr,
        "lightwell: %s: %.6g lm at the table's angles, the lamp has %.6g: more --planes and --angles\n",
        printable(o.out).c_str(), exported, flux);
  if (const Status written = write_ies(o.out, file); !written) return fail(written.error());
  if (!o.json) {
    std::printf("%s: %.6g lm\n", printable(o.out).c_str(), exported);
    return 0;
  }
  const nlohmann::ordered_json json = {{"schema", "lightwell.luminaire-export/1"},
                                       {"out", o.out},
                                       {"name", lamp->name},
                                       {"flux_lm", exported},
                                       {"lamp_flux_lm", flux},
                                       {"planes", file.lamp.horizontal_deg.size()},
                                       {"angles", file.lamp.vertical_deg.size()}};
  std::printf("%s\n", json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace).c_str());
  return 0;
}

}  // namespace

Command add_luminaire_export(CLI::App& luminaire) {
  const auto o = std::make_shared<ExportArguments>();
  CLI::App* command = luminaire.add_subcommand("export", "A lamp's far field for other programs");
  command->footer(
      "Example: lightwell luminaire export led.exr --out led.ies\n"
      "LM-63-2002, absolute photometry; a lamp without a near field keeps its own table");
  command->add_option("lamp", o->lamp, "Lamp, EXR, of lightwell luminaire")->required()->type_name("EXR");
  command->add_option("--out", o->out, "LM-63")->required()->check(output_file())->type_name("FILE.ies");
  command->add_option("--planes", o->grid.planes, "Of a near field: C planes")
      ->check(whole_numbers(1, 720))
      ->capture_default_str();
  command->add_option("--angles", o->grid.angles, "Of a near field: angles from 0 to 180 degrees")
      ->check(whole_numbers(3, 3601))
      ->capture_default_str();
  command->add_flag("--json", o->json, "Machine-readable result on stdout");
  return {command, [o] { return run(*o); }};
}

}  // namespace lightwell::cli
