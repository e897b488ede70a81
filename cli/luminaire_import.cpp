// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cctype>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/command.h"
#include "cli/luminaire_output.h"
#include "interface/luminaire_file.h"
#include "interface/option_range.h"
#include "interface/photometric_file.h"
#include "interface/plain_ray_file.h"
#include "interface/printable.h"
#include "interface/ray_file.h"

namespace lightwell::cli {
namespace {

struct ImportArguments {
  std::string file, out;
  RayBinning rays;
  double tilt_deg = 0;
  bool json = false;
};

struct Imported {
  Luminaire lamp;
  double stated_flux_lm = 0;  // 0: not said
  std::size_t rays = 0;
  std::vector<std::string> remarks;
};

std::string ending_of(const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return ending;
}

bool is_ray_file(const std::filesystem::path& file) {
  const std::string ending = ending_of(file);
  return ending == ".tm25ray" || ending == ".tm25" || ending == ".csv" || ending == ".txt" ||
         ending == ".dat";
}

// Who imports rays and not a table wants the light near by: 0.1 m away.
void remark_on_spacing(const LampPlanes& planes, std::vector<std::string>& remarks) {
  constexpr double kNear_m = 0.1;
  if (nearest_m(planes) <= kNear_m) return;
  char what[200];
  std::snprintf(
      what, sizeof what,
      "its %d x %d sources are %.3g m apart: nearer than %.3g m the light may err by more than 3 %%; more "
      "--positions serve nearer",
      planes.positions[0], planes.positions[1], planes.spacing_m, nearest_m(planes));
  remarks.emplace_back(what);
}

Result<Imported> import_rays(const ImportArguments& o) {
  const std::string ending = ending_of(o.file);
  auto file = ending == ".tm25ray" || ending == ".tm25" ? read_tm25(o.file) : read_plain_rays(o.file);
  if (!file) return file.error();
  Imported out;
  out.lamp = bin_rays(file->rays, o.rays);
  out.lamp.name = file->name;
  out.stated_flux_lm = file->stated_flux_lm;
  out.rays = file->rays.size();
  out.remarks = std::move(file->remarks);
  remark_on_spacing(out.lamp.near->intensity.planes, out.remarks);
  return out;
}

Result<Imported> import_photometry(const ImportArguments& o) {
  auto file = read_photometric_file(o.file);
  if (!file) return file.error();
  Imported out;
  out.lamp = {file->name, std::nullopt, std::move(file->lamp)};
  out.stated_flux_lm = file->stated_flux_lm.value_or(0);
  out.remarks = std::move(file->remarks);
  if (!file->tilt_deg.empty()) {
    const double factor = tilt_factor(*file, o.tilt_deg);
    for (double& value : out.lamp.far->candela) value *= factor;
    out.stated_flux_lm *= factor;
    char text[120];
    std::snprintf(text, sizeof text, "has TILT factors: its light is %.6g of the table's, for --tilt %g",
                  factor, o.tilt_deg);
    out.remarks.emplace_back(text);
  } else if (o.tilt_deg != 0) {
    return usage("--tilt is " + std::to_string(o.tilt_deg) + ", but " + o.file +
                 " has no TILT factors: allowed 0");
  }
  return out;
}

void report(const ImportArguments& o, const Imported& imported) {
  for (const std::string& remark : imported.remarks)
    std::fprintf(stderr, "lightwell: %s: %s\n", printable(o.file).c_str(), printable(remark).c_str());
  const double flux = luminous_flux(imported.lamp)[1];
  if (!o.json) {
    std::printf("%s: %.6g lm%s\n", printable(o.out).c_str(), flux,
                imported.lamp.near ? ", near field" : ", far field");
    return;
  }
  nlohmann::ordered_json json = {{"schema", "lightwell.luminaire-import/1"},
                                 {"out", o.out},
                                 {"name", imported.lamp.name},
                                 {"near_field", imported.lamp.near.has_value()},
                                 {"flux_lm", flux}};
  if (imported.stated_flux_lm > 0) json["stated_flux_lm"] = imported.stated_flux_lm;
  if (imported.rays > 0) {
    const LampPlanes& planes = imported.lamp.near->intensity.planes;
    json["rays"] = imported.rays;
    json["positions"] = planes.positions;
    json["spacing_m"] = planes.spacing_m;
    json["nearest_m"] = nearest_m(planes);
  }
  json["remarks"] = imported.remarks;
  std::printf("%s\n", json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace).c_str());
}

int run(const ImportArguments& o) {
  if (const Status good = check_luminaire_output(o.out, ".exr", {&o.file, 1}); !good)
    return fail(good.error());
  auto imported = is_ray_file(o.file) ? import_rays(o) : import_photometry(o);
  if (!imported) return fail(imported.error());
  if (const Status written = write_luminaire(o.out, imported->lamp); !written) return fail(written.error());
  report(o, *imported);
  return 0;
}

}  // namespace

Command add_luminaire_import(CLI::App& luminaire) {
  const auto o = std::make_shared<ImportArguments>();
  CLI::App* command = luminaire.add_subcommand("import", "A lamp from a file of its maker");
  command->footer(
      "Example: lightwell luminaire import spot.ies --out spot.exr\n"
      "         lightwell luminaire import led.tm25ray --out led.exr\n"
      "LM-63 (.ies) and EULUMDAT (.ldt) tell how a lamp shines far away, ray files near by too: of TM-25, or "
      "text (.csv, .txt, .dat)");
  command->add_option("file", o->file, "FILE.ies, FILE.ldt, FILE.tm25ray or FILE.csv")
      ->required()
      ->type_name("FILE");
  command
      ->add_option("--positions", o->rays.positions,
                   "Of a ray file: point sources a side; a long lamp has as many in all")
      ->check(whole_numbers(2, 64))
      ->capture_default_str();
  command
      ->add_option("--pixels", o->rays.pixels,
                   "Of a ray file: pixels a side of each source's image; else as fine as its noise allows")
      ->check(whole_numbers(8, 1024));
  command
      ->add_option(
          "--tilt", o->tilt_deg,
          "Of an .ies with TILT factors: degrees by which it hangs turned from where it was measured")
      ->check(numbers_from(0, 180, "0 to 180 degrees"))
      ->capture_default_str();
  command->add_option("--out", o->out, "The lamp, EXR")->required()->check(output_file())->type_name("FILE");
  command->add_flag("--json", o->json, "Machine-readable result on stdout");
  return {command, [o] { return run(*o); }};
}

}  // namespace lightwell::cli
