// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "interface/host_port.h"
#include "render/opentrackio_packet.h"
#include "render/tracking_pose.h"

namespace lightwell::render {

enum class TrackingProtocol { opentrackio, freed };

struct TrackingOptions {
  TrackingProtocol protocol = TrackingProtocol::opentrackio;
  HostPort address;  // of this machine, or the multicast group that the tracker sends to
  // FreeD's zoom is in units of the tracker's own: focal length = zoom · this. Absent: the zoom is not used.
  std::optional<double> freed_mm_per_unit;
  // Where the stream does not tell it.
  std::optional<double> sensor_height_mm;
};

// "opentrackio:ADDRESS:PORT" or "freed:ADDRESS:PORT". usage: anything else.
Result<TrackingOptions> parse_tracking(const std::string& text);

// The pose of a real camera, as a tracker sends it over UDP. Says on stderr, once each time, that it waits, who sends,
// that the stream stopped (the last pose is kept) and came back, and the first packet of a run of malformed ones.
class TrackingStream {
 public:
  // failed: the address is not this machine's, or the port is taken.
  static Result<TrackingStream> open(const TrackingOptions& options);
  TrackingStream(TrackingStream&& other) noexcept;
  TrackingStream& operator=(TrackingStream&&) = delete;
  ~TrackingStream();

  // Takes all packets that have come, without waiting; true where they brought a newer pose.
  bool update();
  // Nothing before the first good packet.
  [[nodiscard]] const std::optional<TrackedCamera>& camera() const { return camera_; }
  [[nodiscard]] std::uint16_t port() const;  // the one taken, where the options' was 0
  [[nodiscard]] std::size_t malformed() const { return malformed_; }

 private:
  TrackingStream(const TrackingOptions& options, int socket) : options_(options), socket_(socket) {}
  Result<std::optional<TrackedCamera>> parse(std::span<const std::uint8_t> datagram);
  void tell(bool arrived, const std::string& sender);

  enum class State { unknown, waiting, flowing, stopped };
  TrackingOptions options_;
  int socket_ = -1;
  OpenTrackIoReader reader_;
  std::optional<TrackedCamera> camera_;
  std::chrono::steady_clock::time_point last_;
  std::size_t malformed_ = 0;
  bool told_malformed_ = false;
  State told_ = State::unknown;
};

}  // namespace lightwell::render
