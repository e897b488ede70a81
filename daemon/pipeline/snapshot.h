// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "interface/timecode.h"
#include "lighting/frame_format.h"
#include "lighting/light_set.h"
#include "lighting/map_harmonics.h"
#include "lighting/polar_map.h"

namespace lightwell {

// What the frame path hands to everybody else, once a frame.
struct Snapshot {
  std::uint64_t number = 0;          // counts published frames of this daemon, from 1; 0: nothing yet
  std::uint64_t sequence = 0;        // the camera's
  std::int64_t capture_mono_ns = 0;  // mid-exposure
  std::int64_t capture_utc_ns = 0;
  std::int64_t received_mono_ns = 0;
  std::int64_t publish_mono_ns = 0;  // the lights were ready
  FrameFormat format;                // of the raw frame
  double exposure_us = 0;
  std::optional<Timecode> timecode{};
  float temperature_c = 0;                // of the camera; NaN: not known
  std::array<char, 17> calibration_id{};  // zero-terminated
  Coverage coverage = Coverage::hemisphere;
  Rgb total_illuminance = Rgb::Zero();                           // filtered, what the lights stand for
  Rgb measured_illuminance = Rgb::Zero();                        // of this very frame's map
  float delay_frames = 0;                                        // lag of the lights behind the map
  std::string method;                                            // of the lights, by name
  std::vector<DirectionalLight> lights;                          // capacity is kept from frame to frame
  std::array<Rgb, harmonic_count(kRadianceDegree)> harmonics{};  // of the map, lighting/map_harmonics.h
  PolarMap map;
  std::uint64_t shape = 0;  // changes with camera or calibration; the frame path's own
};

// One writer, several readers, each of which takes the newest snapshot and may keep it as long as it likes:
// the writer never waits for a reader. Snapshots are allocated once. At most kMaxReaders leases at a time.
class SnapshotChannel {
 public:
  static constexpr std::size_t kMaxReaders = 10;

  // prototype: a snapshot of the final shape; copied into every slot.
  explicit SnapshotChannel(const Snapshot& prototype);

  // Writer, one thread: fill what begin returns, then end. Neither allocates.
  Snapshot& begin_write() noexcept;
  void end_write() noexcept;

  // Keeps a snapshot from being overwritten while it lives.
  class Lease {
   public:
    Lease() = default;
    Lease(Lease&& other) noexcept;
    Lease& operator=(Lease&& other) noexcept;
    Lease(const Lease&) = delete;
    Lease& operator=(const Lease&) = delete;
    ~Lease();
    explicit operator bool() const noexcept { return snapshot_ != nullptr; }
    const Snapshot& operator*() const noexcept { return *snapshot_; }
    const Snapshot* operator->() const noexcept { return snapshot_; }

   private:
    friend class SnapshotChannel;
    Lease(SnapshotChannel* channel, const Snapshot* snapshot, std::size_t slot)
        : channel_(channel), snapshot_(snapshot), slot_(slot) {}
    SnapshotChannel* channel_ = nullptr;
    const Snapshot* snapshot_ = nullptr;
    std::size_t slot_ = 0;
  };

  // The newest snapshot whose number is above `after`; waits up to timeout for one, else an empty lease.
  // Zero timeout: only what is there.
  Lease wait_newer(std::uint64_t after, std::chrono::milliseconds timeout);
  // Wakes all waiting readers for good (shutdown); they get empty leases.
  void close() noexcept;

 private:
  std::mutex mutex_;
  std::condition_variable newer_;
  std::vector<Snapshot> slots_;
  std::vector<int> leases_;
  std::size_t latest_ = 0;
  std::size_t writing_ = 0;
  bool any_ = false;
  bool closed_ = false;
};

}  // namespace lightwell
