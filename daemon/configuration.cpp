// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/configuration.h"

#include <fmt/format.h>

#include <toml++/toml.h>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <variant>

#include "interface/atomic_file.h"
#include "interface/dds_domain.h"
#include "lighting/decomposition/best_lights.h"
#include "lighting/fit/few_lights.h"

namespace lightwell {
namespace {

using Value = std::variant<bool, std::int64_t, double, std::string>;

// A key of the file: where it lives, what it may be, what it means.
struct Key {
  std::string name;     // "section.key"
  std::string meaning;  // with unit
  std::string range;    // for people
  std::function<Value(const Configuration&)> get;
  std::function<bool(Configuration&, const Value&)> set;  // false: out of range
};

template <class Section>
Key integer(const char* name, const char* meaning, Section Configuration::*section, int Section::*field,
            int low, int high) {
  return {name, meaning, fmt::format("{} to {}", low, high),
          [=](const Configuration& c) -> Value { return std::int64_t{c.*section.*field}; },
          [=](Configuration& c, const Value& value) {
            const auto* v = std::get_if<std::int64_t>(&value);
            if (v == nullptr || *v < low || *v > high) return false;
            c.*section.*field = static_cast<int>(*v);
            return true;
          }};
}

template <class Section>
Key number(const char* name, const char* meaning, Section Configuration::*section, double Section::*field,
           double low, double high) {
  return {name, meaning, fmt::format("{:g} to {:g}", low, high),
          [=](const Configuration& c) -> Value { return c.*section.*field; },
          [=](Configuration& c, const Value& value) {
            double v = std::numeric_limits<double>::quiet_NaN();
            if (const auto* d = std::get_if<double>(&value)) v = *d;
            if (const auto* i = std::get_if<std::int64_t>(&value)) v = static_cast<double>(*i);
            if (!(v >= low && v <= high)) return false;
            c.*section.*field = v;
            return true;
          }};
}

template <class Section>
Key boolean(const char* name, const char* meaning, Section Configuration::*section, bool Section::*field) {
  return {name, meaning, "true or false", [=](const Configuration& c) -> Value { return c.*section.*field; },
          [=](Configuration& c, const Value& value) {
            const auto* v = std::get_if<bool>(&value);
            if (v == nullptr) return false;
            c.*section.*field = *v;
            return true;
          }};
}

// allowed empty: any text
template <class Section>
Key text(const char* name, const char* meaning, Section Configuration::*section, std::string Section::*field,
         std::vector<std::string> allowed = {}) {
  return {name, meaning, allowed.empty() ? "a string" : fmt::format("one of {}", fmt::join(allowed, ", ")),
          [=](const Configuration& c) -> Value { return c.*section.*field; },
          [=](Configuration& c, const Value& value) {
            const auto* v = std::get_if<std::string>(&value);
            if (v == nullptr) return false;
            if (!allowed.empty() && std::find(allowed.begin(), allowed.end(), *v) == allowed.end())
              return false;
            c.*section.*field = *v;
            return true;
          }};
}

const std::vector<Key>& keys() {
  using C = Configuration;
  static const std::vector<Key> table = {
      text("probe.name", "name of this probe in everything it publishes", &C::probe, &C::Probe::name),
      text("source.address",
           "aravis:ADDRESS, v4l2:/dev/videoN, libcamera:ID, recording:FILE or simulated:NAME", &C::source,
           &C::Source::address),
      integer("source.width", "pixels asked of the camera, 0: as it is", &C::source, &C::Source::width, 0,
              16384),
      integer("source.height", "pixels asked of the camera, 0: as it is", &C::source, &C::Source::height, 0,
              16384),
      text("source.pixel_format", "GenICam name asked of the camera, empty: as it is", &C::source,
           &C::Source::pixel_format),
      number("source.rate_hz", "frames a second asked of the camera, 0: as it is", &C::source,
             &C::Source::rate_hz, 0, 10000),
      number("source.exposure_us", "exposure asked of the camera in µs, 0: as it is", &C::source,
             &C::Source::exposure_us, 0, 1e7),
      text("source.controls",
           "controls of V4L2 and libcamera to set: name=value, …, as `lightwell devices` lists them",
           &C::source, &C::Source::controls),
      text("source.trigger",
           "input of a GenICam camera that starts its exposures (Line0), off, or empty: as it is, or any "
           "where the "
           "board makes triggers",
           &C::source, &C::Source::trigger),
      boolean("source.ptp", "GenICam: let PTP (IEEE 1588) keep the camera's clock; false: as it is",
              &C::source, &C::Source::ptp),
      integer("source.buffers", "frames the camera may fill ahead", &C::source, &C::Source::buffers, 4, 64),
      integer("source.packet_size", "GigE Vision packet in bytes; 1400 where jumbo frames do not pass",
              &C::source, &C::Source::packet_size, 576, 9000),
      integer("source.socket_buffer_bytes", "receive buffer; nearly a frame, capped by net.core.rmem_max",
              &C::source, &C::Source::socket_buffer_bytes, 65536, 1 << 30),
      number("source.speed", "recording: 1 as recorded, 0 as fast as frames are taken, none skipped",
             &C::source, &C::Source::speed, 0, 1000),
      boolean("source.loop", "recording: begin again at the end", &C::source, &C::Source::loop),
      text("calibration.directory",
           "folder with response.json, lens.json, flat.json; empty: the recording's or the "
           "simulation's own",
           &C::calibration, &C::CalibrationFiles::directory),
      integer("map.rings", "zenith angle steps of the radiance map", &C::map, &C::Map::rings, 1, 2048),
      integer("map.sectors", "azimuth steps of the radiance map", &C::map, &C::Map::sectors, 1, 8192),
      integer("lights.count", "lights a frame, 0: 64 of best, 300 of the others", &C::lights,
              &C::Lights::count, 0, 100000),
      text("lights.sampler", "best is steady by itself; relaxed to clusters are for the others", &C::lights,
           &C::Lights::sampler, {"best", "havran", "standard"}),
      boolean("lights.relaxed", "blue-noise relaxation of the sample points", &C::lights,
              &C::Lights::relaxed),
      Key{"lights.seed", "rotates the sample points, 0: not", "0 to 4294967295",
          [](const C& c) -> Value { return c.lights.seed; },
          [](C& c, const Value& value) {
            const auto* v = std::get_if<std::int64_t>(&value);
            if (v == nullptr || *v < 0 || *v > 4294967295) return false;
            c.lights.seed = *v;
            return true;
          }},
      text("lights.filter", "over time: fir is steady and lags by half its order, none has no lag",
           &C::lights, &C::Lights::filter, {"fir", "none"}),
      number("lights.pass_hz", "passed up to here, 0: a third of the frame rate", &C::lights,
             &C::Lights::pass_hz, 0, 10000),
      number("lights.stop_hz", "stopped from here, 0: 9/21 of the frame rate", &C::lights,
             &C::Lights::stop_hz, 0, 10000),
      integer("lights.order", "taps of the filter less one", &C::lights, &C::Lights::order, 2, 64),
      integer("lights.clusters", "most lights published, 0: all that were sampled", &C::lights,
              &C::Lights::clusters, 0, 100000),
      text("lights.mains", "flicker of lamps on mains of so many Hz is taken out of the map, without delay",
           &C::lights, &C::Lights::mains, {"off", "50", "60"}),
      integer("fit.lights", "ambient and so many lights fitted besides, for readers that afford few; 0: none",
              &C::fit, &C::Fit::lights, 0, kMostFittedLights),
      number("fit.max_error",
             "above 0: the fewest of them that leave a white sphere's irradiance no larger relative error",
             &C::fit, &C::Fit::max_error, 0, 1),
      text("record.directory", "where takes are written", &C::record, &C::Record::directory),
      text("record.codec", "raw is fast, ffv1 small; both lossless", &C::record, &C::Record::codec,
           {"raw", "ffv1"}),
      text("board.address",
           "sync board: usb, usb:SERIAL, serial:/dev/DEVICE; lines of this machine: gpio:/dev/gpiochipN; "
           "empty: none",
           &C::board, &C::Board::address),
      text("board.trigger_rate", "triggers a second, N or N/D (30000/1001); empty: as the board has it",
           &C::board, &C::Board::trigger_rate),
      text("board.reference", "what triggers follow: nothing, pulses (PPS, genlock) or LTC", &C::board,
           &C::Board::reference, {"none", "pulse", "timecode"}),
      text("board.reference_rate", "its pulses or frames a second, N or N/D", &C::board,
           &C::Board::reference_rate),
      number("board.pulse_us", "length of the trigger pulse in µs, 0: as the board has it", &C::board,
             &C::Board::pulse_us, 0, 100000),
      boolean("board.avoid_flicker", "trigger rate and exposure move so that they do not beat with lamps",
              &C::board, &C::Board::avoid_flicker),
      text("board.axes",
           "gravity turns the world upright: the board's axes along the camera's x (right in the image), y "
           "(down) "
           "and z (lens), as \"x,-z,y\"; empty: it does not",
           &C::board, &C::Board::axes),
      text("board.trigger_line", "gpio: the line that triggers the camera, by number or name; empty: none",
           &C::board, &C::Board::trigger_line),
      text("board.strobe_line", "gpio: the line that is high while the camera exposes; empty: none",
           &C::board, &C::Board::strobe_line),
      text("http.listen", "ADDRESS:PORT of page and interface, loopback only", &C::http, &C::Http::listen),
      integer("dds.domain", "DDS domain", &C::dds, &C::Dds::domain, 0, kMaxDdsDomain),
      text("dds.interface", "network interface of DDS; lo stays on this machine", &C::dds,
           &C::Dds::network_interface),
      number("dds.environment_hz", "radiance maps published a second, 0: none", &C::dds,
             &C::Dds::environment_hz, 0, 1000),
      text("log.level", "what is logged", &C::log, &C::Log::level, {"debug", "info", "warning", "error"}),
  };
  return table;
}

const Key* find(const std::string& name) {
  for (const Key& key : keys())
    if (key.name == name) return &key;
  return nullptr;
}

std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substitute = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substitute});
    }
  }
  return row.back();
}

std::string nearest(const std::string& name) {
  const auto& table = keys();
  return std::min_element(table.begin(), table.end(),
                          [&](const Key& a, const Key& b) {
                            return edit_distance(a.name, name) < edit_distance(b.name, name);
                          })
      ->name;
}

std::string to_toml(const Value& value) {
  struct Writer {
    std::string operator()(bool v) const { return v ? "true" : "false"; }
    std::string operator()(std::int64_t v) const { return std::to_string(v); }
    std::string operator()(double v) const { return fmt::format("{}", v); }
    std::string operator()(const std::string& v) const {
      std::string out = "\"";
      for (const char c : v) {
        if (c == '"' || c == '\\') out += '\\';
        if (static_cast<unsigned char>(c) < 0x20)
          out += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
        else
          out += c;
      }
      return out + "\"";
    }
  };
  return std::visit(Writer{}, value);
}

std::optional<Value> to_value(const toml::node& node) {
  if (const auto* v = node.as_boolean()) return Value(v->get());
  if (const auto* v = node.as_integer()) return Value(v->get());
  if (const auto* v = node.as_floating_point()) return Value(v->get());
  if (const auto* v = node.as_string()) return Value(v->get());
  return std::nullopt;
}

void remember(Origins& origins, const std::string& key, const std::string& origin) {
  for (auto& [name, where] : origins)
    if (name == key) where = origin;
}

Status apply_file(const std::filesystem::path& file, LoadedConfiguration& loaded) {
  const auto text = read_text_file(file, 1 << 20);
  if (!text) return text.error();
  toml::table parsed;
  try {
    parsed = toml::parse(*text, file.string());
  } catch (const toml::parse_error& error) {
    return Error{ErrorKind::bad_input,
                 fmt::format("{}:{}: {}", file.string(), error.source().begin.line, error.description())};
  }
  for (const auto& [section, node] : parsed) {
    const auto* table = node.as_table();
    const std::string prefix(section.str());
    if (table == nullptr)
      return Error{ErrorKind::bad_input,
                   fmt::format("{}:{}: {} stands outside a section; every key belongs to one", file.string(),
                               node.source().begin.line, prefix)};
    for (const auto& [name, value] : *table) {
      const std::string full = prefix + "." + std::string(name.str());
      const std::string where = fmt::format("{}:{}", file.string(), value.source().begin.line);
      const Key* key = find(full);
      if (key == nullptr)
        return Error{ErrorKind::bad_input, fmt::format("{}: unknown key {}; the nearest known one is {}",
                                                       where, full, nearest(full))};
      const auto given = to_value(value);
      if (!given || !key->set(loaded.configuration, *given))
        return Error{ErrorKind::bad_input,
                     fmt::format("{}: {} = {}; allowed: {}", where, full,
                                 given ? to_toml(*given) : "(not a plain value)", key->range)};
      remember(loaded.origins, full, where);
    }
  }
  return {};
}

// "1500", "true", "0.5" are read as what they look like where the key's type wants that, else as text.
Value parse_like(const Value& example, const std::string& text) {
  if (std::holds_alternative<std::string>(example)) return text;
  if (text == "true") return true;
  if (text == "false") return false;
  char* end = nullptr;
  const long long integer = std::strtoll(text.c_str(), &end, 10);
  if (!text.empty() && *end == '\0') return std::int64_t{integer};
  const double number = std::strtod(text.c_str(), &end);
  if (!text.empty() && *end == '\0') return number;
  return text;
}

// What one key alone cannot know.
Status check_together(const Configuration& c) {
  const auto& l = c.lights;
  if ((l.pass_hz > 0) != (l.stop_hz > 0))
    return Error{ErrorKind::usage, "lights.pass_hz and lights.stop_hz are given together or not at all"};
  if (l.pass_hz > 0 && l.pass_hz >= l.stop_hz)
    return Error{ErrorKind::usage, fmt::format("lights.pass_hz = {:g}; allowed: below lights.stop_hz = {:g}",
                                               l.pass_hz, l.stop_hz)};
  if (l.sampler == "best" && l.count > kMostPlacedLights)
    return Error{ErrorKind::usage,
                 fmt::format("lights.count = {}; allowed with lights.sampler = \"best\": 0 to {}", l.count,
                             kMostPlacedLights)};
  return {};
}

}  // namespace

Result<LoadedConfiguration> load_configuration(const std::filesystem::path& file,
                                               const Overrides& overrides) {
  LoadedConfiguration loaded;
  for (const Key& key : keys()) loaded.origins.emplace_back(key.name, "default");
  if (!file.empty()) {
    const Status status = apply_file(file, loaded);
    if (!status) return status.error();
  }
  for (const auto& [name, given] : overrides) {
    const Key* key = find(name);
    verify_bug(key != nullptr, "command line option without a configuration key");
    if (!key->set(loaded.configuration, parse_like(key->get(loaded.configuration), given)))
      return Error{ErrorKind::usage,
                   fmt::format("command line: {} = {}; allowed: {}", name, given, key->range)};
    remember(loaded.origins, name, "command line");
  }
  const Status together = check_together(loaded.configuration);
  if (!together)
    return Error{file.empty() ? ErrorKind::usage : ErrorKind::bad_input,
                 (file.empty() ? "" : file.string() + ": ") + together.error().message};
  return loaded;
}

std::string print_configuration(const LoadedConfiguration& loaded) {
  std::string out;
  std::string section;
  for (const Key& key : keys()) {
    const auto dot = key.name.find('.');
    if (key.name.substr(0, dot) != section) {
      section = key.name.substr(0, dot);
      out += fmt::format("{}[{}]\n", out.empty() ? "" : "\n", section);
    }
    std::string origin;
    for (const auto& [name, where] : loaded.origins)
      if (name == key.name) origin = where;
    out += fmt::format("{} = {}  # {}; {}: {}\n", key.name.substr(dot + 1),
                       to_toml(key.get(loaded.configuration)), origin, key.meaning, key.range);
  }
  return out;
}

}  // namespace lightwell
