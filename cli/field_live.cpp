// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "cli/command.h"
#include "cli/field_grid_option.h"
#include "field/live_session.h"
#include "field/probe_list.h"
#include "interface/atomic_file.h"
#include "interface/dds_topics.h"
#include "interface/field_file.h"
#include "interface/option_range.h"
#include "interface/printable.h"

namespace lightwell::cli {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kMostPoints = 262144;  // of a FieldFrame

struct LiveArguments {
  std::vector<std::string> probes;
  std::string grid = "16,16,16", bounds, out, name = "stage", interface = "lo";
  double rate_hz = 30, hold_s = 1, fade_s = 1, seconds = 0;
  int domain = 0;
  bool no_lamps = false, json = false;
};

volatile std::sig_atomic_t interrupted = 0, wanted = 0;

double seconds_of(Clock::duration time) {
  return std::chrono::duration<double>(time).count();
}

// How long updates take: the maps that came and the field made of them.
class UpdateTimes {
 public:
  void add(double ms) { ms_.push_back(ms); }
  [[nodiscard]] double quantile(double q) {
    if (ms_.empty()) return 0;
    std::sort(ms_.begin(), ms_.end());
    return ms_[static_cast<std::size_t>(q * static_cast<double>(ms_.size() - 1) + 0.5)];
  }
  [[nodiscard]] std::size_t count() const { return ms_.size(); }
  void clear() { ms_.clear(); }

 private:
  std::vector<double> ms_;
};

void say(LiveSession& session) {
  for (const std::string& line : session.news()) std::fprintf(stderr, "lightwell: %s\n", line.c_str());
}

nlohmann::ordered_json status_of(const FieldFrame& frame, const LiveSession& session, UpdateTimes& times,
                                 double over_s) {
  nlohmann::ordered_json json = {{"schema", "lightwell.field-live/1"},
                                 {"number", frame.header.number},
                                 {"rate_hz", static_cast<double>(times.count()) / over_s},
                                 {"update_ms", {{"p50", times.quantile(0.5)}, {"p99", times.quantile(0.99)}}},
                                 {"confidence", frame.header.measured_part},
                                 {"probes", nlohmann::ordered_json::array()},
                                 {"lamps", nlohmann::ordered_json::array()}};
  for (std::size_t n = 0; n < frame.probes.size(); ++n) {
    const FieldFrame::Probe& probe = frame.probes[n];
    json["probes"].push_back(
        {{"name", printable(probe.name)},
         {"maps", session.states()[n].maps},
         {"age_s", session.states()[n].last_s ? nlohmann::ordered_json(probe.age_s) : nullptr},
         {"weight", probe.weight}});
  }
  for (const FieldFrame::Lamp& lamp : frame.lamps)
    json["lamps"].push_back({{"id", lamp.id},
                             {"position", {lamp.position.x(), lamp.position.y(), lamp.position.z()}},
                             {"sigma_m", lamp.sigma_m},
                             {"intensity", {lamp.intensity[0], lamp.intensity[1], lamp.intensity[2]}},
                             {"weight", lamp.weight}});
  return json;
}

// A FieldFrame's bounds are 32 bit numbers: points must stay apart.
Status check_cells(const FieldGrid& grid, const std::string& bounds) {
  constexpr float kSteps = 4;  // so that a cell is right to an eighth
  for (int axis = 0; axis < 3; ++axis) {
    const auto farthest = static_cast<float>(std::max(std::abs(grid.low[axis]), std::abs(grid.high[axis])));
    const double least_m = kSteps * (std::nextafter(farthest, 1e9f) - farthest);
    if (grid.cell()[axis] >= least_m) continue;
    char text[120];
    std::snprintf(text, sizeof text,
                  ": cells of %.3g m along %c, allowed so far from the origin: from %.3g m",
                  grid.cell()[axis], "XYZ"[axis], least_m);
    return usage("--bounds is " + bounds + text);
  }
  return {};
}

// Reads the options; the session itself is made where all is well.
Result<std::unique_ptr<LiveSession>> session_of(const LiveArguments& o) {
  const auto grid = field_grid(o.grid, o.bounds);
  if (!grid) return grid.error();
  if (grid->points() > kMostPoints)
    return usage("--grid is " + o.grid + ", allowed: up to " + std::to_string(kMostPoints) + " points");
  if (const Status apart = check_cells(*grid, o.bounds); !apart) return apart.error();
  std::vector<StageProbe> probes;
  std::vector<Vec3d> places;
  for (const std::string& text : o.probes) {
    const auto probe = parse_stage_probe(text);
    if (!probe) return probe.error();
    for (const StageProbe& other : probes)
      if (other.name == probe->name) return usage("--probe is " + text + ", allowed: each name once");
    probes.push_back(*probe);
    places.push_back(probe->position);
  }
  if (probes.size() > LiveField::kMostProbes)
    return usage("--probe is given " + std::to_string(probes.size()) + " times, allowed: 1 to " +
                 std::to_string(LiveField::kMostProbes));
  for (const std::string& remark : remarks_on_places(places, *grid))
    std::fprintf(stderr, "lightwell: %s\n", remark.c_str());
  LiveFieldOptions options;
  options.grid = *grid;
  options.hold_s = o.hold_s;
  options.fade_s = o.fade_s;
  options.lamps = !o.no_lamps;
  return std::make_unique<LiveSession>(options, std::move(probes));
}

Status store(const LiveArguments& o, const LightField& field) {
  const auto written = write_field(o.out, field, {"live", 0});
  if (!written) return written.error();
  std::fprintf(stderr, "lightwell: %s is written, %.2f MB\n", printable(o.out).c_str(),
               static_cast<double>(written->bytes) / 1e6);
  return {};
}

int run(const LiveArguments& o) {
  auto made = session_of(o);
  if (!made) return fail(made.error());
  LiveSession& session = **made;
  const auto domain = DdsDomain::open({.domain = o.domain, .interface = o.interface});
  if (!domain) return fail(domain.error());
  auto reader = EnvironmentReader::create(*domain, {.every_probe = true});
  if (!reader) return fail(reader.error());
  auto writer = FieldWriter::create(*domain, o.name);
  if (!writer) return fail(writer.error());
  std::signal(SIGINT, [](int) { interrupted = 1; });
  std::signal(SIGTERM, [](int) { interrupted = 1; });
  std::signal(SIGUSR1, [](int) { wanted = 1; });

  const auto begin = Clock::now();
  const auto period =
      std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1 / o.rate_hz));
  auto next = begin + period, said = begin;
  EnvironmentFrame map;
  FieldFrame* frame = nullptr;
  std::string refusal;
  std::set<std::string> contested;  // that was said
  UpdateTimes times;
  Clock::duration busy{};
  while (interrupted == 0) {
    const auto now = Clock::now();
    if (o.seconds > 0 && seconds_of(now - begin) >= o.seconds) break;
    if (now < next) {
      if ((*reader)->take(map, std::chrono::ceil<std::chrono::milliseconds>(next - now))) {
        const auto came = Clock::now();
        session.hear(map, seconds_of(came - begin));
        busy += Clock::now() - came;
      }
      if (const std::string& wrong = (*reader)->refusal(); wrong != refusal) {
        refusal = wrong;
        std::fprintf(stderr, "lightwell: a map is refused: %s\n", printable(refusal).c_str());
      }
      for (const std::string& name : (*reader)->contested())
        if (contested.insert(name).second)
          std::fprintf(stderr,
                       "lightwell: two publish as probe '%s': the first that was heard is followed, until it "
                       "is silent for 2 s\n",
                       printable(name).c_str());
      continue;
    }
    // A tick that was missed is left out, not made up for.
    next = std::max(next + period, now);
    frame = &session.make(seconds_of(now - begin));
    frame->header.publish_mono_ns =
        std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now().time_since_epoch()).count();
    busy += Clock::now() - now;
    times.add(1e3 * seconds_of(std::exchange(busy, {})));
    // Dropped where a reader holds it up: the next one is newer.
    if (session.heard_any()) static_cast<void>((*writer)->write(*frame));
    say(session);
    if (wanted != 0 && !o.out.empty()) {
      wanted = 0;
      if (const Status stored = store(o, frame->field); !stored) fail(stored.error());
    }
    if (seconds_of(now - said) >= 1) {
      if (o.json) {
        std::printf("%s\n", status_of(*frame, session, times, seconds_of(now - said)).dump().c_str());
        if (std::fflush(stdout) != 0) return fail({ErrorKind::failed, "cannot write to standard output"});
      }
      times.clear();
      said = now;
    }
  }
  if (!session.heard_any() || frame == nullptr)
    return fail({ErrorKind::failed, "none of the probes was heard (is lightwelld running, with dds.domain " +
                                        std::to_string(o.domain) + "?)"});
  if (!o.out.empty())
    if (const Status stored = store(o, frame->field); !stored) return fail(stored.error());
  return 0;
}

}  // namespace

Command add_field_live(CLI::App& field) {
  const auto o = std::make_shared<LiveArguments>();
  CLI::App* command = field.add_subcommand("live", "A field from several probes at once, as they see it now");
  command->footer(
      "Example: lightwell field live --probe left=-1,1,0 --probe right=1,1,0 --bounds -2,0,-2,2,2,2\n"
      "NAME: what a daemon publishes as (probe.name in its configuration). Publishes lightwell/FieldFrame.");
  command
      ->add_option("--probe", o->probes,
                   "A probe, its place (metres) and by how many degrees it stands turned about +Y; once for "
                   "each, up to 64")
      ->required()
      ->allow_extra_args(false)
      ->type_name("NAME=X,Y,Z[,HEADING]");
  command->add_option("--grid", o->grid, "Points along each axis")
      ->capture_default_str()
      ->type_name("NX,NY,NZ");
  command->add_option("--bounds", o->bounds, "Places of the outermost points, metres")
      ->required()
      ->type_name("X0,Y0,Z0,X1,Y1,Z1");
  command->add_option("--rate", o->rate_hz, "Fields a second")
      ->check(numbers_above_0_to(240, "above 0 to 240 Hz"))
      ->capture_default_str()
      ->type_name("HZ");
  command->add_option("--hold", o->hold_s, "A map this old still counts in full")
      ->check(numbers_from(0, 3600, "0 to 3600 seconds"))
      ->capture_default_str()
      ->type_name("S");
  command->add_option("--fade", o->fade_s, "A silent probe then fades out over this time")
      ->check(numbers_from(0, 3600, "0 to 3600 seconds"))
      ->capture_default_str()
      ->type_name("S");
  command->add_flag("--no-lamps", o->no_lamps, "Do not look for the places of small bright lamps");
  command->add_option("--seconds", o->seconds, "Ends after this time; 0: on Ctrl-C")
      ->check(numbers_from(0, 1e9, "0 to 1e9 seconds"))
      ->capture_default_str()
      ->type_name("S");
  command->add_option("--out", o->out, "Stores the newest field at the end, and on SIGUSR1; OpenVDB")
      ->check(output_file())
      ->type_name("FILE");
  command->add_option("--name", o->name, "Publishes the field under this name")
      ->capture_default_str()
      ->type_name("NAME");
  command->add_option("--domain", o->domain, "DDS domain of the probes")
      ->check(whole_numbers(0, kMaxDdsDomain))
      ->capture_default_str();
  command->add_option("--interface", o->interface, "Network interface of DDS; lo stays on this machine")
      ->capture_default_str()
      ->type_name("NAME");
  command->add_flag("--json", o->json, "A line of state a second on stdout");
  return {command, [o] { return run(*o); }};
}

}  // namespace lightwell::cli
