// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "lighting/result.h"

namespace lightwell {

// Everything lightwelld can be told. Defaults are what a probe with a GigE Vision camera on this machine
// needs; each key's meaning, unit and range stand in the table of configuration.cpp, which --print-config
// prints.
struct Configuration {
  struct Probe {
    std::string name = "probe";
    bool operator==(const Probe&) const = default;
  } probe;
  struct Source {
    std::string address = "aravis:127.0.0.1";
    int width = 0;
    int height = 0;
    std::string pixel_format;
    double rate_hz = 0;
    double exposure_us = 0;
    std::string controls;
    std::string trigger;
    bool ptp = false;
    int buffers = 8;
    int packet_size = 9000;
    int socket_buffer_bytes = 8 << 20;
    double speed = 1;
    bool loop = false;
    bool operator==(const Source&) const = default;
  } source;
  struct CalibrationFiles {
    std::string directory;
    bool operator==(const CalibrationFiles&) const = default;
  } calibration;
  struct Map {
    int rings = 90;
    int sectors = 360;
    bool operator==(const Map&) const = default;
  } map;
  struct Lights {
    int count = 0;
    std::string sampler = "best";
    bool relaxed = true;
    std::int64_t seed = 0;
    std::string filter = "fir";
    double pass_hz = 0;
    double stop_hz = 0;
    int order = 8;
    int clusters = 72;
    std::string mains = "off";
    bool operator==(const Lights&) const = default;
  } lights;
  struct Fit {
    int lights = 4;
    double max_error = 0;
    bool operator==(const Fit&) const = default;
  } fit;
  struct Record {
    std::string directory = ".";
    std::string codec = "raw";
    bool operator==(const Record&) const = default;
  } record;
  struct Board {
    std::string address;
    std::string trigger_rate;
    std::string reference = "none";
    std::string reference_rate = "1";
    double pulse_us = 0;
    bool avoid_flicker = false;
    std::string axes;
    std::string trigger_line, strobe_line;
    bool operator==(const Board&) const = default;
  } board;
  struct Http {
    std::string listen = "127.0.0.1:8650";
    bool operator==(const Http&) const = default;
  } http;
  struct Dds {
    int domain = 0;
    std::string network_interface = "lo";
    double environment_hz = 5;
    bool operator==(const Dds&) const = default;
  } dds;
  struct Log {
    std::string level = "info";
    bool operator==(const Log&) const = default;
  } log;

  friend bool operator==(const Configuration&, const Configuration&) = default;
};

// A value given on the command line: key as in the file ("source.address") and TOML text or a bare string.
using Overrides = std::vector<std::pair<std::string, std::string>>;

// Where a value comes from: "default", "lightwell.toml:12" or "command line".
using Origins = std::vector<std::pair<std::string, std::string>>;

struct LoadedConfiguration {
  Configuration configuration;
  Origins origins;
};

// file: may be empty (defaults only). Validated whole: unknown keys are errors that name the nearest known
// one, values out of range name file, line, key, value and range. Kind bad_input for the file's, usage for
// the command line's.
Result<LoadedConfiguration> load_configuration(const std::filesystem::path& file, const Overrides& overrides);

// The whole configuration as TOML; every value with its origin and meaning as a comment.
std::string print_configuration(const LoadedConfiguration& loaded);

}  // namespace lightwell
