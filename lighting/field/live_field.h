// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "lighting/field/lamp_tracks.h"
#include "lighting/field/light_field.h"
#include "lighting/field/live_sums.h"
#include "lighting/map_harmonics.h"

namespace lightwell {

struct LiveFieldOptions {
  FieldGrid grid;
  double hold_s = 1;  // a map this old counts in full
  double fade_s = 1;  // a probe then fades out over this time, and in when it is back
  int cells = 384;    // of the sphere; a finer cut changes no error of ten probes
  bool lamps =
      true;  // small bright lamps that several probes see are placed, else they are spread like all light
};

// A small field of degree 4 from several probes at fixed places, kept up to date as their maps come. Light is interpolated
// across each direction by kriging, for which the weights stand ready (lighting/field/ray_kriging.h); what the cut into
// directions loses of a probe's own harmonics is given back by place, so that at a probe's place the field is what it
// measured. Lamps that several probes see are taken out, placed and put back as near lamps (lighting/field/lamp_tracks.h).
// A probe that says nothing, or nothing of a direction, counts as what the others foretell for its place: it fades without
// a jump, and the weights need not change. Where all are silent the last light stays and only confidence fades, to 0.
// One thread at a time.
class LiveField {
 public:
  // positions: metres, world; 1 to kMostProbes.
  static constexpr std::size_t kMostProbes = 64;
  LiveField(const LiveFieldOptions& options, std::vector<Vec3d> positions);
  ~LiveField();
  LiveField(const LiveField&) = delete;
  LiveField& operator=(const LiveField&) = delete;

  // The newest map of a probe, at a time of any clock that only rises. Values that are not finite were not measured. Maps
  // may have different grids; a wider one than all before takes .1 s, for the weights are made anew.
  void update(std::size_t probe, const PolarMap& map, double time_s);
  // The field at a time. Valid until the next call.
  const LightField& make(double time_s);

  // What is known from each probe, 0 to 1, at the last make: 0 once it is silent.
  [[nodiscard]] std::span<const double> weights() const { return weights_; }
  [[nodiscard]] const std::vector<LampTrack>& lamps() const { return tracks_.lamps(); }
  [[nodiscard]] const std::vector<Vec3d>& positions() const { return positions_; }

 private:
  struct Probe;
  struct Direction;
  void prepare(const PolarGrid& widest);
  void age(double time_s);
  void find_confidence();
  void add_own_harmonics(const std::vector<RadianceHarmonics>& remainders, bool changed);

  LiveFieldOptions options_;
  std::vector<Vec3d> positions_;
  SpherePartition partition_;
  std::vector<Probe> probes_;
  std::vector<double> weights_;  // [probes], what is known from each
  std::vector<double>
      shares_;  // [probes], how each counts in the mix: as weights_, but not fading where all are silent
  std::optional<double> last_s_;
  std::vector<Direction> directions_;
  Eigen::MatrixXd cell_harmonics_;  // [25][directions]
  std::optional<PolarGrid> widest_;
  Kriging places_;
  Eigen::MatrixXf place_weights_;  // [points][probes]
  Eigen::MatrixXd place_completion_;
  std::optional<LiveSums> sums_;
  LampTracks tracks_;
  std::vector<float> radiance_;  // [directions][3][probes]
  LightField field_;
};

}  // namespace lightwell
