// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "cli/command.h"
#include "cli/number_list.h"
#include "interface/csv_table.h"
#include "interface/luminaire_file.h"

namespace lightwell::cli {
namespace {

constexpr double kFarthest_m = 1e6;

struct QueryArguments {
  std::string lamp;
  std::optional<std::string> at, toward, points;
  bool json = false;
};

struct Receiver {
  Vec3d point, normal;
};

Result<Receiver> receiver_of(const QueryArguments& o) {
  const auto vector = [](const char* option, const std::string& text) -> Result<Vec3d> {
    const auto numbers = number_list(text, 3);
    if (!numbers) return usage(std::string(option) + " is " + text + ", allowed: three numbers, X,Y,Z");
    return Vec3d((*numbers)[0], (*numbers)[1], (*numbers)[2]);
  };
  const auto at = vector("--at", *o.at);
  if (!at) return at.error();
  if (at->cwiseAbs().maxCoeff() > kFarthest_m)
    return usage("--at is " + *o.at + ", allowed: within 1e6 metres");
  const auto toward = vector("--toward", *o.toward);
  if (!toward) return toward.error();
  if (!(toward->stableNorm() > 1e-9))
    return usage("--toward is " + *o.toward + ", allowed: any length but 0");
  return Receiver{*at, toward->stableNormalized()};
}

Result<std::vector<Receiver>> receivers_of(const std::string& file) {
  const auto table = CsvTable::read(file);
  if (!table) return table.error();
  if (const Status all = table->require({"x", "y", "z", "u", "v", "w"}); !all) return all.error();
  std::vector<Receiver> receivers;
  for (std::size_t row = 0; row < table->rows(); ++row) {
    std::array<double, 6> numbers{};
    const std::array<const char*, 6> columns = {"x", "y", "z", "u", "v", "w"};
    for (std::size_t i = 0; i < 6; ++i) {
      const auto value = table->number(row, columns[i], -kFarthest_m, kFarthest_m, "-1e6 to 1e6");
      if (!value) return value.error();
      numbers[i] = *value;
    }
    const Vec3d normal(numbers[3], numbers[4], numbers[5]);
    if (!(normal.stableNorm() > 1e-9))
      return Error{ErrorKind::bad_input,
                   table->place(row) + ": the normal u,v,w is 0, allowed: any length but 0"};
    receivers.push_back({Vec3d(numbers[0], numbers[1], numbers[2]), normal.stableNormalized()});
  }
  return receivers;
}

int run(const QueryArguments& o) {
  const bool place = o.at.has_value() && o.toward.has_value();
  if (place == o.points.has_value() || o.at.has_value() != o.toward.has_value())
    return fail(usage("where to ask: --at X,Y,Z with --toward U,V,W, or --points FILE"));
  std::vector<Receiver> receivers;
  if (place) {
    const auto receiver = receiver_of(o);
    if (!receiver) return fail(receiver.error());
    receivers.push_back(*receiver);
  } else {
    auto listed = receivers_of(*o.points);
    if (!listed) return fail(listed.error());
    receivers = *std::move(listed);
  }
  const auto lamp = read_luminaire(o.lamp);
  if (!lamp) return fail(lamp.error());
  nlohmann::ordered_json json = {{"schema", "lightwell.luminaire-query/1"},
                                 {"illuminance", nlohmann::ordered_json::array()}};
  for (const Receiver& receiver : receivers) {
    const Rgbd lux = illuminance(*lamp, receiver.point, receiver.normal);
    if (o.json)
      json["illuminance"].push_back({lux[0], lux[1], lux[2]});
    else
      std::printf("%.6g %.6g %.6g lux\n", lux[0], lux[1], lux[2]);
  }
  if (o.json) std::printf("%s\n", json.dump().c_str());
  return 0;
}

}  // namespace

Command add_luminaire_query(CLI::App& luminaire) {
  const auto o = std::make_shared<QueryArguments>();
  CLI::App* command = luminaire.add_subcommand("query", "Illuminance of surfaces near a lamp");
  command->footer(
      "Example: lightwell luminaire query spot.exr --at 0,0,-2 --toward 0,0,1 --json\n"
      "The lamp's frame, metres: it is aimed along -Z, its plane C0 lies along +X, C90 along +Y");
  command->add_option("lamp", o->lamp, "Lamp, EXR, of lightwell luminaire")->required()->type_name("EXR");
  command->add_option("--at", o->at, "A point of the surface")->type_name("X,Y,Z");
  command->add_option("--toward", o->toward, "Its normal")->type_name("U,V,W");
  command->add_option("--points", o->points, "Many: CSV with columns x,y,z,u,v,w")->type_name("CSV");
  command->add_flag("--json", o->json, "illuminance: a line of R, G, B for every point, lux");
  return {command, [o] { return run(*o); }};
}

}  // namespace lightwell::cli
