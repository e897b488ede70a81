// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "interface/host_port.h"
#include "interface/opentrackio_packet.h"
#include "interface/tracking_pose.h"

namespace lightwell {

enum class TrackingProtocol { opentrackio, freed };

struct TrackingOptions {
  TrackingProtocol protocol = TrackingProtocol::opentrackio;
  HostPort address;  // of this machine, or the multicast group that the tracker sends to
  // FreeD's zoom is in units of the tracker's own: focal length = zoom · this. Absent: the zoom is not used.
  std::optional<double> freed_mm_per_unit;
  // Where the stream does not tell it.
  std::optional<double> sensor_height_mm;
  // Of several cameras that one port hears the one to follow (TrackedCamera::number). Absent: the first that is heard.
  std::optional<int> camera;
};

inline constexpr int kMostTrackedCamera = 255;  // FreeD's; OpenTrackIO has 1 to 200

// "opentrackio:ADDRESS:PORT" or "freed:ADDRESS:PORT"; option: its name for errors. usage: anything else.
Result<TrackingOptions> parse_tracking(const std::string& text, const std::string& option = "--tracking");

// A datagram that has come.
struct TrackingArrival {
  std::int64_t arrived_mono_ns = 0;  // at this machine's network, CLOCK_MONOTONIC
  std::string sender;                // its address
  std::optional<int> other_camera;   // the number of one that is not followed; `camera` is then nothing
  // As OpenTrackIoReader::take and parse_freed.
  Result<std::optional<TrackedCamera>> camera;
};

// The UDP port to which a tracker sends.
class TrackingReceiver {
 public:
  // failed: the address is not this machine's, or the port is taken.
  static Result<TrackingReceiver> open(const TrackingOptions& options);
  TrackingReceiver(TrackingReceiver&& other) noexcept;
  TrackingReceiver& operator=(TrackingReceiver&&) = delete;
  ~TrackingReceiver();

  // The next datagram, nothing where none comes in time.
  std::optional<TrackingArrival> next(std::chrono::milliseconds patience = std::chrono::milliseconds(0));
  // The camera that is followed, once its number is known.
  [[nodiscard]] std::optional<int> camera() const { return options_.camera; }
  [[nodiscard]] std::uint16_t port() const;  // the one taken, where the options' was 0

 private:
  TrackingReceiver(const TrackingOptions& options, int socket) : options_(options), socket_(socket) {}
  Result<std::optional<TrackedCamera>> parse(std::span<const std::uint8_t> datagram);

  TrackingOptions options_;
  int socket_ = -1;
  OpenTrackIoReader reader_;
};

}  // namespace lightwell
