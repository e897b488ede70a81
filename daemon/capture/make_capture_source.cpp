// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "daemon/capture/aravis_source.h"
#include "daemon/capture/capture_source.h"
#ifdef LIGHTWELL_LIBCAMERA
#include "daemon/capture/libcamera_source.h"
#endif
#include "daemon/capture/recording_source.h"
#include "daemon/capture/simulated_source.h"
#include "daemon/capture/v4l2_source.h"

namespace lightwell {
namespace {

using Made = Result<std::unique_ptr<CaptureSource>>;

Made make_aravis(const std::string& address, const CaptureOptions& options) {
  return make_aravis_source(address, options);
}

Made make_v4l2(const std::string& path, const CaptureOptions& options) {
  return make_v4l2_source(path, options);
}

#ifdef LIGHTWELL_LIBCAMERA
Made make_libcamera(const std::string& id, const CaptureOptions& options) {
  return make_libcamera_source(id, options);
}
#endif

struct Kind {
  std::string_view name;
  std::string_view what;
  Made (*make)(const std::string& rest, const CaptureOptions& options);
};

constexpr std::array kKinds = {
    Kind{"aravis", "ADDRESS", make_aravis},           Kind{"v4l2", "/dev/videoN", make_v4l2},
#ifdef LIGHTWELL_LIBCAMERA
    Kind{"libcamera", "ID", make_libcamera},
#endif
    Kind{"recording", "FILE", make_recording_source}, Kind{"simulated", "NAME", make_simulated_source},
};

std::string kinds() {
  std::string list;
  for (const Kind& kind : kKinds) {
    if (!list.empty()) list += ", ";
    list.append(kind.name).append(":").append(kind.what);
  }
  return list;
}

Status check_range(const char* field, double value, double low, double high) {
  if (value >= low && value <= high) return {};
  const auto text = [](double number) {
    std::string out = std::to_string(number);
    out.erase(out.find_last_not_of('0') + 1);
    if (out.back() == '.') out.pop_back();
    return out;
  };
  return Error{ErrorKind::usage, std::string("capture ") + field + " " + text(value) + " is not in " +
                                     text(low) + "…" + text(high)};
}

Status check(const CaptureOptions& o) {
  constexpr double kMaxSide = 65536;
  const std::array checks = {
      check_range("width", o.width, 0, kMaxSide),
      check_range("height", o.height, 0, kMaxSide),
      check_range("rate_hz", o.rate_hz, 0, 100'000),
      check_range("exposure_us", o.exposure_us, 0, 1e9),
      // One being filled, one in the slot, two leased.
      check_range("buffers", o.buffers, 4, 64),
      check_range("packet_size", o.packet_size, 576, 65000),
      check_range("socket_buffer_bytes", o.socket_buffer_bytes, 65536, 1 << 30),
      check_range("speed", o.speed, 0, 1000),
      check_range("trigger_rate_hz", o.trigger_rate_hz, 0, 100'000),
  };
  for (const Status& status : checks)
    if (!status) return status;
  if (!o.pixel_format.empty() && !pixel_format_from_name(o.pixel_format))
    return Error{ErrorKind::usage, "capture pixel_format " + o.pixel_format +
                                       " is not one of Mono8, Mono10, Mono12, Mono12p, Mono16, BayerRG8, "
                                       "BayerRG10, BayerRG12, BayerRG16"};
  return {};
}

}  // namespace

Made make_capture_source(const std::string& source, const CaptureOptions& options) {
  const std::size_t colon = source.find(':');
  const std::string_view kind_name = std::string_view(source).substr(0, colon);
  for (const Kind& kind : kKinds) {
    if (colon == std::string::npos || kind.name != kind_name) continue;
    if (colon + 1 == source.size()) {
      return Error{ErrorKind::usage,
                   "source " + source + ": " + std::string(kind.what) + " is missing after the colon"};
    }
    if (Status status = check(options); !status) return status.error();
    return kind.make(source.substr(colon + 1), options);
  }
  return Error{ErrorKind::usage, "source " + source + " is not known; one of " + kinds() + " is expected"};
}

}  // namespace lightwell
