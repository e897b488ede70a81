// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/libcamera/controls.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <string>
#include <system_error>

namespace lightwell {
namespace {

namespace controls = libcamera::controls;

std::string number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.5g", value);
  return text.data();
}

// A value in words for a control of this type; nullopt where the words are none.
std::optional<libcamera::ControlValue> parse(const libcamera::ControlId& id, const std::string& words) {
  const auto as_number = [&]<class T>(T) -> std::optional<libcamera::ControlValue> {
    T value{};
    const auto [end, error] = std::from_chars(words.data(), words.data() + words.size(), value);
    if (error != std::errc() || end != words.data() + words.size()) return std::nullopt;
    return libcamera::ControlValue(value);
  };
  switch (id.type()) {
    case libcamera::ControlTypeBool:
      if (words == "true" || words == "1") return libcamera::ControlValue(true);
      if (words == "false" || words == "0") return libcamera::ControlValue(false);
      return std::nullopt;
    case libcamera::ControlTypeInteger32:
      return as_number(std::int32_t{});
    case libcamera::ControlTypeInteger64:
      return as_number(std::int64_t{});
    case libcamera::ControlTypeFloat:
      return as_number(float{});
    default:
      return std::nullopt;
  }
}

bool within(const libcamera::ControlInfo& info, const libcamera::ControlValue& value) {
  const auto check = [&]<class T>(T) {
    return info.min().type() != value.type() || info.max().type() != value.type() ||
           (value.get<T>() >= info.min().get<T>() && value.get<T>() <= info.max().get<T>());
  };
  switch (value.type()) {
    case libcamera::ControlTypeInteger32:
      return check(std::int32_t{});
    case libcamera::ControlTypeInteger64:
      return check(std::int64_t{});
    case libcamera::ControlTypeFloat:
      return check(float{});
    default:
      return true;
  }
}

// "Name=value, …"
std::optional<CaptureFault> set_words(const libcamera::ControlInfoMap& offered, std::string rest,
                                      libcamera::ControlList& chosen) {
  while (!rest.empty()) {
    const std::size_t comma = std::min(rest.find(','), rest.size());
    std::string one = rest.substr(0, comma);
    rest.erase(0, comma + 1);
    std::erase(one, ' ');
    const std::size_t equals = std::min(one.find('='), one.size());
    const auto at = std::find_if(offered.begin(), offered.end(), [&](const auto& entry) {
      return entry.first->name() == one.substr(0, equals);
    });
    if (at == offered.end() || equals == one.size()) {
      std::string names;
      for (const auto& [id, info] : offered) names += (names.empty() ? "" : ", ") + id->name();
      return CaptureFault{SourceState::opening, "control \"" + one +
                                                    "\": Name=value is expected, with one of " +
                                                    (names.empty() ? "none: it has no controls" : names)};
    }
    const auto value = parse(*at->first, one.substr(equals + 1));
    if (!value || !within(at->second, *value))
      return CaptureFault{SourceState::opening,
                          "control " + one + ": the camera allows " + at->second.toString()};
    chosen.set(at->first->id(), *value);
  }
  return std::nullopt;
}

}  // namespace

std::optional<CaptureFault> choose_controls(const libcamera::ControlInfoMap& offered,
                                            const CaptureOptions& options, libcamera::ControlList& chosen,
                                            SessionSettings& settings) {
  if (auto fault = refuse_trigger(options, settings)) return fault;
  chosen = libcamera::ControlList(offered);
  const auto has = [&](const libcamera::ControlId& id) { return offered.count(&id) > 0; };
  if (auto fault = set_words(offered, options.controls, chosen)) return fault;
  if (options.rate_hz > 0) {
    if (!has(controls::FrameDurationLimits))
      return CaptureFault{SourceState::opening, "rate_hz " + number(options.rate_hz) +
                                                    ": the camera has no frame rate to set; leave it at 0"};
    const auto period_us = static_cast<std::int64_t>(std::llround(1e6 / options.rate_hz));
    chosen.set(controls::FrameDurationLimits, {period_us, period_us});
    settings.rate_hz = options.rate_hz;
  }
  if (options.exposure_us > 0 && has(controls::ExposureTime)) {
    const libcamera::ControlInfo& range = offered.at(&controls::ExposureTime);
    const libcamera::ControlValue wanted(static_cast<std::int32_t>(std::lround(options.exposure_us)));
    if (!within(range, wanted))
      return CaptureFault{SourceState::opening, "exposure " + number(options.exposure_us) +
                                                    " µs: the camera allows " + range.toString() + " µs"};
    if (has(controls::AeEnable)) chosen.set(controls::AeEnable, false);
    chosen.set(controls::ExposureTime, wanted.get<std::int32_t>());
  } else if (options.exposure_us > 0) {
    settings.remark += (settings.remark.empty() ? "" : "; ") +
                       std::string("has no exposure control; its exposure is taken as given");
  }
  settings.exposure_us = options.exposure_us;
  return std::nullopt;
}

}  // namespace lightwell
