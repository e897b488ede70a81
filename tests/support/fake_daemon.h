// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstring>
#include <mutex>
#include <string>

#include "daemon/clock.h"
#include "daemon/pipeline/snapshot.h"
#include "daemon/pipeline/status.h"
#include "daemon/record/take_name.h"

namespace lightwell::test {

// A daemon's status and recording without a daemon: answers what the test sets, refuses what the real one
// would.
class FakeControl : public DaemonControl {
 public:
  [[nodiscard]] DaemonStatus status() const override {
    const std::scoped_lock lock(mutex_);
    return status_;
  }
  Status start_recording(const std::string& file) override {
    const std::scoped_lock lock(mutex_);
    if (const Status name = check_take_name(file); !name) return name;
    if (status_.recording.active)
      return Error{ErrorKind::failed, "already recording " + status_.recording.file};
    status_.recording = {.active = true, .file = file, .error = {}};
    return {};
  }
  Status stop_recording() override {
    const std::scoped_lock lock(mutex_);
    if (!status_.recording.active) return Error{ErrorKind::failed, "not recording"};
    status_.recording.active = false;
    return {};
  }
  [[nodiscard]] std::optional<FitSnapshot> newest_fit() const override {
    const std::scoped_lock lock(mutex_);
    return fit_;
  }
  void set_fit(const FitSnapshot& fit) {
    const std::scoped_lock lock(mutex_);
    fit_ = fit;
  }
  template <class Change>
  void change(Change change) {
    const std::scoped_lock lock(mutex_);
    change(status_);
  }

 private:
  mutable std::mutex mutex_;
  DaemonStatus status_;
  std::optional<FitSnapshot> fit_;
};

inline Snapshot snapshot_shape(int channels = 3, std::size_t lights = 72) {
  Snapshot snapshot;
  snapshot.map = PolarMap::make({.rings = 30, .sectors = 120}, channels);
  snapshot.lights.reserve(lights);
  return snapshot;
}

// A sky with a warm sun at the given azimuth, its lights on a spiral with parents; not meant to be a good
// light set.
inline void paint_sky(Snapshot& snapshot, float sun_azimuth_rad, std::size_t lights = 72) {
  const Vec3f sun(std::sin(sun_azimuth_rad) * 0.7f, 0.714f, std::cos(sun_azimuth_rad) * 0.7f);
  const auto radiance = [&](const Vec3f& d) {
    const float toward = std::max(0.0f, d.dot(sun));
    return Rgb(Rgb(2000, 3500, 6000) * (0.4f + 0.6f * (1 - d[1])) +
               Rgb(90000, 60000, 30000) * std::pow(toward, 60.0f) +
               Rgb(9e6f, 7.5e6f, 5.5e6f) * std::pow(toward, 4000.0f));
  };
  PolarMap& map = snapshot.map;
  std::size_t bin = 0;
  Rgb total = Rgb::Zero();
  for (int ring = 0; ring < map.grid.rings; ++ring)
    for (int sector = 0; sector < map.grid.sectors; ++sector, ++bin) {
      const Rgb l = radiance(map.grid.bin_direction(ring, sector).cast<float>());
      for (int c = 0; c < map.channels; ++c) map.plane(c)[bin] = map.channels == 1 ? luminance(l) : l[c];
      total += map.rgb(bin) * map.solid_angle_sr[bin];
    }
  const RadianceHarmonics harmonics = MapHarmonics(map.grid).project(map);
  for (std::size_t i = 0; i < snapshot.harmonics.size(); ++i)
    snapshot.harmonics[i] = harmonics.row(static_cast<Eigen::Index>(i)).transpose().cast<float>();
  snapshot.lights.clear();
  Rgb sum = Rgb::Zero();
  for (std::size_t i = 0; i < lights; ++i) {
    const float y = (static_cast<float>(i) + 0.5f) / static_cast<float>(lights);
    const float azimuth = 2.39996f * static_cast<float>(i);
    const float flat = std::sqrt(1 - y * y);
    const Vec3f d = i == 0 ? sun.normalized() : Vec3f(std::sin(azimuth) * flat, y, std::cos(azimuth) * flat);
    snapshot.lights.push_back({.direction = d,
                               .illuminance = radiance(d) * (i == 0 ? 0.002f : 0.08f),
                               .parent = static_cast<std::int32_t>(i) - 1,
                               .id = static_cast<std::uint32_t>(i + 1),
                               .predicted_error = 0.3f / static_cast<float>(i + 1)});
    sum += snapshot.lights.back().illuminance;
  }
  for (DirectionalLight& light : snapshot.lights) light.illuminance *= total / sum;
  snapshot.total_illuminance = total;
  snapshot.measured_illuminance = total;
}

// Publishes one frame as the frame path does.
inline void publish(SnapshotChannel& channel, std::uint64_t number, float sun_azimuth_rad = 0) {
  Snapshot& snapshot = channel.begin_write();
  snapshot.number = number;
  snapshot.sequence = 1000 + number;
  snapshot.publish_mono_ns = mono_now_ns();
  snapshot.capture_mono_ns = snapshot.publish_mono_ns - 4'000'000;
  snapshot.received_mono_ns = snapshot.publish_mono_ns - 500'000;
  snapshot.capture_utc_ns = utc_now_ns();
  std::strcpy(snapshot.calibration_id.data(), "0123456789abcdef");
  snapshot.delay_frames = 4;
  snapshot.method = "havran";
  paint_sky(snapshot, sun_azimuth_rad, 72);
  channel.end_write();
}

}  // namespace lightwell::test
