// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "cli/command.h"
#include "cli/number_list.h"
#include "interface/field_file.h"

namespace lightwell::cli {
namespace {

struct QueryArguments {
  std::string field, at;
  std::optional<std::string> normal;
  bool json = false;
};

Result<Vec3d> vector_of(const std::string& option, const std::string& text) {
  const auto numbers = number_list(text, 3);
  if (!numbers) return usage(option + " is " + text + ", allowed: X,Y,Z, three numbers");
  return Vec3d((*numbers)[0], (*numbers)[1], (*numbers)[2]);
}

std::string bounds_text(const FieldGrid& grid) {
  char text[200];
  std::snprintf(text, sizeof text, "%g,%g,%g to %g,%g,%g metres", grid.low.x(), grid.low.y(), grid.low.z(),
                grid.high.x(), grid.high.y(), grid.high.z());
  return text;
}

int run(const QueryArguments& o) {
  const auto at = vector_of("--at", o.at);
  if (!at) return fail(at.error());
  std::optional<Vec3d> normal;
  if (o.normal) {
    const auto given = vector_of("--normal", *o.normal);
    if (!given) return fail(given.error());
    const double length = given->stableNorm();
    if (!(length > 1e-9)) return fail(usage("--normal is " + *o.normal + ", allowed: any length but 0"));
    normal = (*given / length).normalized();
  }
  const auto file = read_field(o.field);
  if (!file) return fail(file.error());
  const LightField& field = file->field;
  if (!field.grid.contains(*at))
    return fail(usage("--at is " + o.at + ", allowed: inside the field, " + bounds_text(field.grid)));
  const LightAtPoint light = light_at(field, *at);
  nlohmann::ordered_json json = {{"schema", "lightwell.field-query/1"},
                                 {"at", {at->x(), at->y(), at->z()}},
                                 {"degree", field.degree},
                                 {"confidence", light.confidence},
                                 {"sh", nlohmann::ordered_json::array()}};
  for (Eigen::Index i = 0; i < light.radiance.rows(); ++i)
    json["sh"].push_back({light.radiance(i, 0), light.radiance(i, 1), light.radiance(i, 2)});
  if (normal) {
    const Rgbd lux = irradiance(light, *normal);
    json["irradiance"] = {lux[0], lux[1], lux[2]};
  }
  if (o.json) {
    std::printf("%s\n", json.dump().c_str());
    return 0;
  }
  std::printf("confidence        %.3f\n", light.confidence);
  if (normal)
    std::printf("irradiance        %.6g %.6g %.6g lux\n", json["irradiance"][0].get<double>(),
                json["irradiance"][1].get<double>(), json["irradiance"][2].get<double>());
  for (int l = 0; l <= field.degree; ++l)
    for (int m = -l; m <= l; ++m) {
      const auto row = light.radiance.row(harmonic_index(l, m));
      std::printf("L %d %+d            %.6g %.6g %.6g\n", l, m, row[0], row[1], row[2]);
    }
  return 0;
}

}  // namespace

Command add_field_query(CLI::App& field) {
  const auto o = std::make_shared<QueryArguments>();
  CLI::App* command = field.add_subcommand("query", "Light at a place of a field");
  command->footer("Example: lightwell field query field.vdb --at 0.5,1,0 --normal 0,1,0 --json");
  command->add_option("field", o->field, "Field, OpenVDB, of lightwell field build")
      ->required()
      ->type_name("VDB");
  command->add_option("--at", o->at, "Where, metres, inside the field's bounds")
      ->required()
      ->type_name("X,Y,Z");
  command->add_option("--normal", o->normal, "Irradiance of a surface that faces there, too")
      ->type_name("X,Y,Z");
  command->add_flag("--json", o->json,
                    "sh: a line of R, G, B for every harmonic l(l + 1) + m; irradiance, confidence");
  return {command, [o] { return run(*o); }};
}

}  // namespace lightwell::cli
