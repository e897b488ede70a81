// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "interface/probe_messages.h"
#include "lighting/field/live_field.h"
#include "lighting/result.h"

namespace lightwell {

struct StageProbe {
  std::string name;  // as its daemon publishes it
  Vec3d position = Vec3d::Zero();
  double heading_deg =
      0;  // the world's azimuth of the probe's own azimuth 0: by how much it was set up turned about +Y
};

// NAME=X,Y,Z or NAME=X,Y,Z,HEADING, metres and degrees. usage: names what was given and what is allowed.
Result<StageProbe> parse_stage_probe(const std::string& text);

// A live field as messages: maps of probes come in, fields go out, and what happens to the probes is said in words, each
// thing once. Knows no clock and no network. One thread at a time.
class LiveSession {
 public:
  // probes: 1 to LiveField::kMostProbes, of different names.
  LiveSession(const LiveFieldOptions& options, std::vector<StageProbe> probes);

  // A map as it came. now_s: of any clock that only rises, the same for all calls.
  void hear(const EnvironmentFrame& map, double now_s);
  // The field now; valid until the next call. publish_mono_ns is the caller's.
  FieldFrame& make(double now_s);
  // Lines since the last call: probes that are heard, silent, back, unknown, or not heard for kMissing_s.
  std::vector<std::string> news();

  static constexpr double kMissing_s = 5;
  struct ProbeState {
    std::uint64_t maps = 0, number = 0;
    std::optional<double> last_s;  // when its last map came
    bool silent = false, missing_said = false;
  };
  [[nodiscard]] const std::vector<StageProbe>& probes() const { return probes_; }
  [[nodiscard]] const std::vector<ProbeState>& states() const { return states_; }
  [[nodiscard]] bool heard_any() const;

 private:
  void watch(double now_s);
  LiveFieldOptions options_;
  std::vector<StageProbe> probes_;
  std::vector<ProbeState> states_;
  LiveField field_;
  PolarMap turned_;
  FieldFrame frame_;
  std::set<std::string> strangers_;
  std::optional<double> begin_s_;
  std::vector<std::string> news_;
};

}  // namespace lightwell
