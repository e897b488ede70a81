// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/assembly.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "daemon/capture/recording_source.h"
#include "daemon/capture/simulated_source.h"
#include "interface/calibration_io.h"
#include "interface/recording.h"
#include "lighting/radiometer.h"

namespace lightwell {
namespace {

// "recording:take.mkv" and the kind "recording" give "take.mkv".
std::optional<std::string> after_kind(const std::string& address, const std::string& kind) {
  if (address.compare(0, kind.size() + 1, kind + ":") != 0) return std::nullopt;
  return address.substr(kind.size() + 1);
}

// "N" or "N/D": a whole number, or a ratio of two. Limits are the board's to say.
Result<std::pair<std::uint32_t, std::uint32_t>> rate_of(const std::string& key, const std::string& text) {
  const auto whole = [](std::string_view digits) -> std::optional<std::uint32_t> {
    std::uint32_t value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc() || end != digits.data() + digits.size() || value == 0) return std::nullopt;
    return value;
  };
  const std::size_t slash = text.find('/');
  const auto numerator = whole(std::string_view(text).substr(0, slash));
  const auto denominator = slash == std::string::npos ? std::optional<std::uint32_t>(1)
                                                      : whole(std::string_view(text).substr(slash + 1));
  if (numerator && denominator) return std::pair(*numerator, *denominator);
  return Error{
      ErrorKind::usage,
      key + " = \"" + text + "\"; allowed: N or N/D a second, whole numbers from 1, as 25 or 30000/1001"};
}

Error no_calibration(const std::string& source) {
  return {ErrorKind::usage, source +
                                ": no calibration; give --calibration DIR (or calibration.directory) with "
                                "response.json and lens.json of this camera"};
}

}  // namespace

CaptureOptions capture_options(const Configuration& configuration) {
  const auto& source = configuration.source;
  CaptureOptions options;
  options.width = source.width;
  options.height = source.height;
  options.pixel_format = source.pixel_format;
  options.rate_hz = source.rate_hz;
  options.exposure_us = source.exposure_us;
  options.controls = source.controls;
  options.trigger = source.trigger;
  options.ptp = source.ptp;
  const auto& board = configuration.board;
  if (!board.address.empty() && !board.trigger_rate.empty()) {
    if (options.trigger.empty()) options.trigger = "any";
    if (const auto rate = rate_of("board.trigger_rate", board.trigger_rate))
      options.trigger_rate_hz = static_cast<double>(rate->first) / rate->second;
  }
  options.buffers = source.buffers;
  options.packet_size = source.packet_size;
  options.socket_buffer_bytes = source.socket_buffer_bytes;
  options.speed = source.speed;
  options.loop = source.loop;
  return options;
}

FramePathOptions frame_path_options(const Configuration& configuration) {
  const auto& given = configuration.lights;
  FramePathOptions options;
  options.radiometer.grid.rings = configuration.map.rings;
  options.radiometer.grid.sectors = configuration.map.sectors;
  options.method = given.sampler;
  options.lights.sampler = given.sampler == "standard" ? LightPipelineOptions::Sampler::standard
                           : given.sampler == "havran" ? LightPipelineOptions::Sampler::havran
                                                       : LightPipelineOptions::Sampler::best;
  const int usual = options.lights.sampler == LightPipelineOptions::Sampler::best ? 64 : 300;
  options.lights.count = given.count > 0 ? given.count : usual;
  options.lights.relaxed = given.relaxed;
  options.lights.seed = static_cast<std::uint32_t>(given.seed);
  options.lights.filter = given.filter == "none" ? TemporalFilter::none : TemporalFilter::fir;
  options.lights.pass_hz = given.pass_hz;
  options.lights.stop_hz = given.stop_hz;
  options.lights.filter_order = given.order;
  options.lights.clusters = given.clusters;
  options.flicker_hz = given.mains == "50" ? 100 : given.mains == "60" ? 120 : 0;
  return options;
}

std::optional<FewLightsOptions> fit_options(const Configuration& configuration) {
  if (configuration.fit.lights == 0) return std::nullopt;
  FewLightsOptions options;
  options.lights = configuration.fit.lights;
  if (configuration.fit.max_error > 0) options.max_error = configuration.fit.max_error;
  return options;
}

Result<std::optional<GpioOptions>> gpio_options(const Configuration& configuration) {
  const auto& given = configuration.board;
  const auto refuse = [](const std::string& key, const std::string& value, const std::string& allowed) {
    return Error{ErrorKind::usage, "board." + key + " = \"" + value + "\"; allowed: " + allowed};
  };
  const auto chip = after_kind(given.address, "gpio");
  if (!chip) {
    if (!given.trigger_line.empty())
      return refuse("trigger_line", given.trigger_line, "with address gpio:/dev/gpiochipN alone");
    if (!given.strobe_line.empty())
      return refuse("strobe_line", given.strobe_line, "with address gpio:/dev/gpiochipN alone");
    return std::optional<GpioOptions>();
  }
  if (chip->empty()) return refuse("address", given.address, "gpio:/dev/gpiochipN");
  if (given.trigger_line.empty() && given.strobe_line.empty())
    return refuse("trigger_line", "", "with address gpio it, strobe_line or both: a line's number or name");
  if (given.trigger_line == given.strobe_line)
    return refuse("strobe_line", given.strobe_line, "another line than trigger_line");
  if (given.reference != "none")
    return refuse("reference", given.reference, "none with address gpio; a sync board follows references");
  if (given.avoid_flicker) return refuse("avoid_flicker", "true", "false with address gpio");
  if (!given.axes.empty()) return refuse("axes", given.axes, "empty with address gpio");
  GpioOptions options{*chip, given.trigger_line, given.strobe_line, {}};
  if (given.trigger_line.empty()) {
    if (given.trigger_rate.empty()) return std::optional(options);
    return refuse("trigger_rate", given.trigger_rate, "empty without trigger_line");
  }
  const auto rate = rate_of("board.trigger_rate", given.trigger_rate);
  if (!rate) return rate.error();
  const double rate_hz = static_cast<double>(rate->first) / rate->second;
  if (rate_hz < 1 || rate_hz > 1000)
    return refuse("trigger_rate", given.trigger_rate, "1 to 1000 a second with address gpio");
  std::tie(options.pulses.rate_numerator, options.pulses.rate_denominator) = *rate;
  const double longest_us = 0.5e6 / rate_hz;
  if (given.pulse_us > longest_us)
    return refuse("pulse_us", fmt::format("{:g}", given.pulse_us),
                  fmt::format("at most {:g}, half the trigger's period, with address gpio", longest_us));
  options.pulses.pulse_ns = static_cast<std::uint32_t>(
      given.pulse_us > 0 ? given.pulse_us * 1e3 : std::min(500.0, longest_us / 2) * 1e3);
  return std::optional(options);
}

Result<std::optional<BoardOptions>> board_options(const Configuration& configuration) {
  const auto& given = configuration.board;
  if (given.address.empty() || after_kind(given.address, "gpio")) return std::optional<BoardOptions>();
  const auto address = parse_sync_address(given.address);
  if (!address) return Error{ErrorKind::usage, address.error().message + ", gpio:/dev/gpiochipN"};
  BoardOptions options;
  options.address = *address;
  const auto reference_rate = rate_of("board.reference_rate", given.reference_rate);
  if (!reference_rate) return reference_rate.error();
  if (given.trigger_rate.empty()) return std::optional(options);
  const auto rate = rate_of("board.trigger_rate", given.trigger_rate);
  if (!rate) return rate.error();
  BoardOptions::Trigger trigger;
  std::tie(trigger.rate_numerator, trigger.rate_denominator) = *rate;
  std::tie(trigger.reference_numerator, trigger.reference_denominator) = *reference_rate;
  trigger.pulse_ns = static_cast<std::uint32_t>(given.pulse_us * 1e3);
  // More than the board takes is cut: what is longer than a second is no exposure of a light that moves.
  trigger.exposure_ns = static_cast<std::uint32_t>(std::min(configuration.source.exposure_us * 1e3, 1e9));
  trigger.reference = given.reference == "pulse"      ? SYNC_REFERENCE_PULSE
                      : given.reference == "timecode" ? SYNC_REFERENCE_TIMECODE
                                                      : SYNC_REFERENCE_NONE;
  options.trigger = trigger;
  return std::optional(options);
}

Result<Adaptation::Options> adaptation_options(const Configuration& configuration,
                                               const Calibration& calibration) {
  const auto& given = configuration.board;
  std::optional<Eigen::Matrix3d> rotation;
  if (!given.axes.empty()) {
    const auto turned = camera_from_board(given.axes);
    if (!turned) return turned.error();
    rotation = *turned;
  }
  std::vector<FlatAtTemperature> flats;
  if (!configuration.calibration.directory.empty()) {
    auto found = flats_by_temperature(configuration.calibration.directory);
    if (!found) return found.error();
    flats = std::move(*found);
  }
  const auto board = board_options(configuration);
  if (!board) return board.error();
  Adaptation::Options options{CalibrationChoice(calibration, std::move(flats), rotation), std::nullopt,
                              false};
  if (*board && (*board)->trigger) {
    const BoardOptions::Trigger& trigger = *(*board)->trigger;
    options.trigger = TriggerChoice{static_cast<double>(trigger.rate_numerator) / trigger.rate_denominator,
                                    configuration.source.exposure_us};
    // What follows a reference has its rate from there.
    options.avoid_flicker = given.avoid_flicker && trigger.reference == SYNC_REFERENCE_NONE;
  }
  return options;
}

Result<Calibration> choose_calibration(const Configuration& configuration) {
  const std::string& directory = configuration.calibration.directory;
  const std::string& source = configuration.source.address;
  if (!directory.empty()) return read_calibration(directory);
  if (const auto name = after_kind(source, "simulated"))
    return simulated_calibration(*name, capture_options(configuration));
  if (const auto file = after_kind(source, "recording")) {
    auto attached = recording_calibration(*file);
    if (!attached) return attached.error();
    if (*attached) return **attached;
  }
  return no_calibration(source);
}

Status check_frames_fit(const Configuration& configuration, const Calibration& calibration) {
  const std::string& source = configuration.source.address;
  std::optional<FrameFormat> format;
  if (const auto name = after_kind(source, "simulated")) {
    const auto simulated = simulated_format(*name, capture_options(configuration));
    if (!simulated) return simulated.error();
    format = *simulated;
  }
  if (const auto file = after_kind(source, "recording")) {
    const auto take = RecordingReader::open(*file);
    if (!take) return take.error();
    format = (*take)->header().format;
  }
  if (!format) return {};
  const auto radiometer =
      Radiometer::create(calibration, *format, frame_path_options(configuration).radiometer);
  return radiometer ? Status() : Status(radiometer.error());
}

}  // namespace lightwell
