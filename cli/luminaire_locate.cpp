// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/command.h"
#include "cli/probe_views.h"
#include "field/probe_list.h"
#include "interface/atomic_file.h"
#include "interface/frame_name.h"
#include "interface/luminaire_file.h"
#include "interface/option_range.h"
#include "interface/printable.h"
#include "interface/same_file.h"
#include "interface/writable_output.h"
#include "lighting/field/located_lamps.h"
#include "lighting/luminaire/located_luminaire.h"

namespace lightwell::cli {
namespace {

using Json = nlohmann::ordered_json;
constexpr double kDegree = kPi / 180;

struct LocateArguments {
  std::string probes, out, lamps, rest;
  double sigma_deg = 0.2;
  bool json = false;
};

struct Stage {
  ProbeList list;
  std::vector<ProbeView> views;
  std::vector<ProbeSightings> sightings;
  std::vector<LocatedLamp> lamps;
};

Json numbers(const auto& vector) {
  Json json = Json::array();
  for (Eigen::Index i = 0; i < vector.size(); ++i) json.push_back(vector(i));
  return json;
}

Json bound(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

std::vector<int> seen_by(const LocatedLamp& lamp) {
  std::vector<int> probes;
  for (std::size_t n = 0; n < lamp.sightings.size(); ++n)
    if (lamp.sightings[n] >= 0) probes.push_back(static_cast<int>(n));
  return probes;
}

LocatedLuminaire luminaire_of(const LocatedLamp& lamp, const ProbeList& list) {
  std::vector<LampEmission> emissions;
  for (std::size_t n = 0; n < list.positions.size(); ++n)
    if (lamp.known[n])
      emissions.push_back(
          {(list.positions[n] - lamp.location.position).normalized(), 1, lamp.intensity_toward[n]});
  return located_luminaire(emissions, lamp.radius_m);
}

Json near_json(const LocatedLamp& lamp, int id) {
  const LampLocation& at = lamp.location;
  Json covariance = Json::array();
  for (int row = 0; row < 3; ++row) covariance.push_back(numbers(Vec3d(at.covariance.row(row))));
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(at.covariance, Eigen::EigenvaluesOnly);
  const auto [near_m, far_m] = at.distance();
  return {{"id", id},
          {"position", numbers(at.position)},
          {"sigma_m", std::sqrt(std::max(0.0, axes.eigenvalues()[2]))},
          {"covariance_m2", covariance},
          {"distance_m", {{"probe", lamp.from}, {"near", near_m}, {"far", bound(far_m)}}},
          {"intensity", numbers(lamp.intensity)},
          {"radius_m", lamp.radius_m},
          {"seen_by", seen_by(lamp)},
          {"chi_square", at.chi_square},
          {"degrees_of_freedom", at.degrees_of_freedom}};
}

Json far_json(const LocatedLamp& lamp) {
  const auto [near_m, far_m] = lamp.location.distance();
  return {{"direction", numbers(lamp.location.direction)},
          {"illuminance", numbers(lamp.illuminance)},
          {"angular_radius_deg", lamp.angular_radius_rad / kDegree},
          {"distance_m", {{"probe", lamp.from}, {"near", near_m}, {"far", bound(far_m)}}},
          {"ambiguous", lamp.ambiguous},
          {"seen_by", seen_by(lamp)}};
}

Result<Stage> read_stage(const LocateArguments& o) {
  Stage stage;
  auto list = read_probe_list(o.probes);
  if (!list) return list.error();
  stage.list = *std::move(list);
  for (const std::filesystem::path& file : stage.list.files) {
    auto view = read_probe_view(file);
    if (!view) return view.error();
    if (!view->remark.empty()) std::fprintf(stderr, "lightwell: %s\n", view->remark.c_str());
    stage.views.push_back(*std::move(view));
  }
  for (std::size_t n = 0; n < stage.views.size(); ++n)
    stage.sightings.push_back(
        {stage.list.positions[n], true, stage.views[n].theta_max_rad, stage.views[n].lamps});
  return stage;
}

// Probes of one place, or one alone: a lamp's place asks for two.
void say_what_is_missing(const Stage& stage) {
  double base_m = 0;
  for (const Vec3d& position : stage.list.positions)
    base_m = std::max(base_m, (position - stage.list.positions.front()).norm());
  if (base_m > 0) return;
  std::fprintf(stderr,
               "lightwell: all probes (%zu) stand in one place: of no lamp the distance can be told\n",
               stage.list.positions.size());
}

// Lights whose rays cross in more than one way.
void say_what_is_ambiguous(const Stage& stage) {
  const auto count =
      std::count_if(stage.lamps.begin(), stage.lamps.end(), [](const LocatedLamp& l) { return l.ambiguous; });
  if (count > 0)
    std::fprintf(stderr,
                 "lightwell: %td sightings cross in more than one way that explains all: only their "
                 "directions are given, "
                 "a further probe out of line would tell\n",
                 count);
}

// Every file that will be written, before the first is.
struct Outputs {
  std::vector<std::filesystem::path> lamps;  // of the lamps that have a place; empty: not asked for
  std::vector<std::filesystem::path> rest;   // [probes]; empty: not asked for
};

Outputs outputs_of(const LocateArguments& o, const Stage& stage) {
  Outputs out;
  if (!o.lamps.empty()) {
    const auto name = FrameName::parse(o.lamps);
    int id = 0;
    for (const LocatedLamp& lamp : stage.lamps)
      if (lamp.location.is_near()) out.lamps.push_back(name->file(++id));
  }
  if (!o.rest.empty())
    for (std::size_t n = 0; n < stage.views.size(); ++n)
      out.rest.push_back(std::filesystem::path(o.rest) /
                         ("rest_" + std::to_string(n) +
                          (std::holds_alternative<LightSet>(stage.views[n].content) ? ".json" : ".exr")));
  return out;
}

// None is an input or another output, all can be written.
Status check_outputs(const LocateArguments& o, const Stage& stage, const Outputs& out) {
  std::vector<std::filesystem::path> all = out.lamps;
  all.insert(all.end(), out.rest.begin(), out.rest.end());
  if (!o.out.empty()) all.emplace_back(o.out);
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (const Status list = check_output_is_no_input(all[i], {o.probes}); !list) return list;
    for (const auto& input : stage.list.files)
      if (const Status other = check_output_is_no_input(all[i], {input}); !other) return other;
    for (std::size_t k = 0; k < i; ++k)
      if (is_one_output(all[k], all[i]))
        return Error{ErrorKind::usage, all[i].string() + " is written twice, allowed: another name for each"};
  }
  if (!out.rest.empty()) {
    std::error_code failed;
    std::filesystem::create_directories(o.rest, failed);
    if (failed) return Error{ErrorKind::failed, o.rest + ": " + failed.message()};
  }
  for (const std::filesystem::path& file : all)
    if (const Status can = check_can_write(file); !can) return can;
  return {};
}

Status write_rest(const Stage& stage, const std::vector<std::filesystem::path>& files) {
  for (std::size_t n = 0; n < files.size(); ++n) {
    std::vector<int> removed;
    for (const LocatedLamp& lamp : stage.lamps)
      if (lamp.location.is_near() && lamp.sightings[n] >= 0) removed.push_back(lamp.sightings[n]);
    if (const Status written = write_without(stage.views[n], removed, files[n]); !written) return written;
  }
  return {};
}

// The located ones' report; writes their files where asked.
Result<Json> near_lamps(const Stage& stage, const std::vector<std::filesystem::path>& files) {
  Json json = Json::array();
  int id = 0;
  for (const LocatedLamp& lamp : stage.lamps) {
    if (!lamp.location.is_near()) continue;
    Json one = near_json(lamp, ++id);
    const LocatedLuminaire luminaire = luminaire_of(lamp, stage.list);
    const Eigen::Quaterniond turn(luminaire.world_from_lamp);
    one["world_from_lamp"] = {turn.x(), turn.y(), turn.z(), turn.w()};
    if (luminaire.behind > 0)
      std::fprintf(
          stderr,
          "lightwell: lamp %d: %d of the probes that see it stand behind it, what they see is not in it\n",
          id, luminaire.behind);
    if (!files.empty()) {
      const std::filesystem::path& file = files[static_cast<std::size_t>(id - 1)];
      if (const Status written = write_luminaire(file, luminaire.lamp); !written) return written.error();
      one["file"] = file.string();
    }
    json.push_back(std::move(one));
  }
  return json;
}

Status check(const LocateArguments& o) {
  if (!o.lamps.empty()) {
    const auto name = FrameName::parse(o.lamps);
    if (!name || !name->numbered || name->format != FrameName::Format::exr)
      return usage("--lamps is " + o.lamps + ", allowed: a name with a number, lamp_%d.exr");
  }
  return check_output_is_no_input(o.out, {o.probes});
}

int run(const LocateArguments& o) {
  if (const Status checked = check(o); !checked) return fail(checked.error());
  auto stage = read_stage(o);
  if (!stage) return fail(stage.error());
  say_what_is_missing(*stage);
  stage->lamps = locate_lamps(stage->sightings, o.sigma_deg * kDegree);
  say_what_is_ambiguous(*stage);
  const Outputs out = outputs_of(o, *stage);
  if (const Status checked = check_outputs(o, *stage, out); !checked) return fail(checked.error());
  auto near = near_lamps(*stage, out.lamps);
  if (!near) return fail(near.error());
  Json far = Json::array();
  for (const LocatedLamp& lamp : stage->lamps)
    if (!lamp.location.is_near()) far.push_back(far_json(lamp));
  if (const Status written = write_rest(*stage, out.rest); !written) return fail(written.error());
  Json json = {{"schema", "lightwell.lamps/1"}, {"probes", Json::array()}};
  for (std::size_t n = 0; n < stage->views.size(); ++n)
    json["probes"].push_back({{"file", printable(stage->list.files[n].string())},
                              {"position", numbers(stage->list.positions[n])},
                              {"lamps_seen", stage->views[n].lamps.size()}});
  json["lamps"] = *near;
  json["directional"] = std::move(far);
  const std::string text = json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
  if (!o.out.empty())
    if (const Status written = write_file_atomically(o.out, text); !written) return fail(written.error());
  if (o.json) {
    std::fputs(text.c_str(), stdout);
  } else {
    for (const Json& lamp : json["lamps"])
      std::printf(
          "lamp %d at %.3f %.3f %.3f m, standard deviation %.3f m along its least certain axis; %.4g cd, "
          "%.3f m wide\n",
          lamp["id"].get<int>(), lamp["position"][0].get<double>(), lamp["position"][1].get<double>(),
          lamp["position"][2].get<double>(), lamp["sigma_m"].get<double>(),
          lamp["intensity"][1].get<double>(), 2 * lamp["radius_m"].get<double>());
    std::printf("%zu lamps located, %zu lights of which only the direction is known\n", json["lamps"].size(),
                json["directional"].size());
  }
  return 0;
}

}  // namespace

Command add_luminaire_locate(CLI::App& luminaire) {
  const auto o = std::make_shared<LocateArguments>();
  CLI::App* command = luminaire.add_subcommand("locate", "Where lamps stand that several probes see");
  command->footer(
      "Example: lightwell luminaire locate probes.csv --out lamps.json --lamps 'lamp_%d.exr' --rest rest\n"
      "probes.csv: columns x,y,z,file; files are pictures all around (EXR, HDR), or light sets (.json)");
  command->add_option("probes", o->probes, "CSV with columns x,y,z (metres, world) and file")
      ->required()
      ->type_name("PROBES.csv");
  command->add_option("--out", o->out, "What was found, JSON")->check(output_file())->type_name("FILE");
  command
      ->add_option("--lamps", o->lamps,
                   "A lamp file of each that has a place, lamp_%d.exr, as lightwell-render takes them")
      ->type_name("PATTERN");
  command
      ->add_option("--rest", o->rest,
                   "Folder for what the probes see without those lamps, rest_0.exr (or .json) ...")
      ->type_name("DIR");
  command
      ->add_option("--sigma", o->sigma_deg, "Standard deviation of a probe's directions, each way, degrees")
      ->check(numbers_above_0_to(10, "above 0 to 10 degrees"))
      ->capture_default_str();
  command->add_flag("--json", o->json, "What was found on stdout");
  return {command, [o] { return run(*o); }};
}

}  // namespace lightwell::cli
