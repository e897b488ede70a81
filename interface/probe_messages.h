// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lighting/field/light_field.h"
#include "lighting/light_set.h"
#include "lighting/polar_map.h"

namespace lightwell {

// The messages of interface/lightwell.idl as the rest of the code sees them. Units and meaning stand there.

struct FrameHeader {
  std::string probe;                 // set by the writer
  std::uint64_t number = 0;          // published frames of the daemon, from 1
  std::uint64_t sequence = 0;        // the camera's
  std::int64_t capture_mono_ns = 0;  // comparable with this machine's clock only where the daemon runs on it
  std::int64_t capture_utc_ns = 0;
  std::int64_t publish_mono_ns = 0;
  std::string timecode;
  std::string calibration_id;
  Coverage coverage = Coverage::hemisphere;
  float measured_part = 0;  // of the whole sphere, 0 to 1
  Rgb total_illuminance = Rgb::Zero();
  float delay_frames = 0;
};

struct LightFrame {
  FrameHeader header;
  bool has_parents = false;
  Rgb ambient = Rgb::Zero();
  std::vector<DirectionalLight> lights;
  std::vector<Rgb> harmonics;  // 25, or none: not said

  // As a light set of method "live"; for take_lights and the renderer.
  [[nodiscard]] LightSet light_set() const;
};

struct FitFrame {
  FrameHeader header;
  Rgb ambient = Rgb::Zero();
  float residual = 0;
  std::string remarks;
  struct Light {
    DirectionalLight light;
    float direction_sigma_rad = 0;
  };
  std::vector<Light> lights;

  // As a light set of method "fit".
  [[nodiscard]] LightSet light_set() const;
};

struct EnvironmentFrame {
  FrameHeader header;
  PolarMap map;  // radiance and grid travel; solid angles are the grid's, peak is the radiance, clipped is 0
};

struct FieldFrame {
  FrameHeader header;
  LightField field;
  struct Probe {
    std::string name;
    Vec3d position = Vec3d::Zero();
    std::uint64_t number = 0;
    float age_s = 0;
    float weight = 0;
  };
  std::vector<Probe> probes;
  struct Lamp {
    std::uint32_t id = 0;
    Vec3d position = Vec3d::Zero();
    float sigma_m = 0;
    Rgb intensity = Rgb::Zero();
    float weight = 0;
  };
  std::vector<Lamp> lamps;
};

struct ProbeStatus {
  std::string probe;  // set by the writer
  std::string version;
  double uptime_s = 0;
  std::string source;
  std::string source_state;
  std::string source_description;
  double nominal_rate_hz = 0;
  double measured_rate_hz = 0;
  std::uint64_t published = 0;
  std::uint64_t received = 0;
  std::uint64_t skipped = 0;
  std::uint64_t lost = 0;
  std::uint64_t incomplete = 0;
  std::uint64_t reconnects = 0;
  std::uint64_t dropped_by_pipeline = 0;
  double latency_ms_p50 = 0;
  double latency_ms_p99 = 0;
  double frame_age_ms = 0;
  std::string calibration_id;
  std::string calibration_verdict;
  bool recording = false;
  std::string recording_file;
  std::uint64_t recording_frames = 0;
  std::uint64_t recording_dropped = 0;
  std::string alarm;
};

}  // namespace lightwell
