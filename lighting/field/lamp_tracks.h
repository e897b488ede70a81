// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "lighting/field/lamp_sightings.h"
#include "lighting/field/triangulation.h"

namespace lightwell {

// What one probe says of lamps now.
struct ProbeSightings {
  Vec3d position = Vec3d::Zero();
  bool present = false;      // its sightings count
  double theta_max_rad = 0;  // zenith angle to which it looks
  std::span<const LampSighting> lamps;
};

constexpr double kLeastLampDistance_m = 0.05;  // nearer, a probe has the lamp on it: no direction
// Whether a probe would see a lamp at a place, which may be too dim or hidden.
bool looks_at(const ProbeSightings& probe, const Vec3d& place);

// A lamp whose place is known.
struct LampTrack {
  std::uint32_t id = 0;  // stays with the lamp
  Vec3d position = Vec3d::Zero();
  double sigma_m = 0;             // of the position, along its least certain axis
  double radius_m = 0;            // of a sphere as wide as probes see it
  Rgbd intensity = Rgbd::Zero();  // candela, mean over the probes that see it
  double weight = 0;              // 0 to 1: the part of its light that is taken to come from its place
  struct Link {
    int sighting = -1;   // of this probe; −1: none
    double share = 0;    // of the sighting that is this lamp: below 1 where two lamps stand in one line
    bool known = false;  // the probe looks there: what it sees of the lamp, be it nothing, is measured
    Rgbd intensity = Rgbd::Zero();  // toward this probe
  };
  std::vector<Link> links;  // [probes]
};

// Follows lamps that several probes see. Every ray of a known lamp is looked for where the lamp stood; rays that are left
// over are tried in pairs, and the place that most other probes confirm, and that none who looks there denies, becomes a
// lamp. Of more than kPairedAtOnce probes each update but the first tries a part of the pairs, all of them in turn. A lamp gains and loses its weight over kFade_s, and needs less certainty to stay than to begin, so that a doubtful
// one does not flicker.
class LampTracks {
 public:
  static constexpr double kFade_s = 0.3;
  static constexpr std::size_t kPairedAtOnce = 16;  // of 64 probes all pairs are tried in four updates
  static constexpr double kEnterSigma = 0.15,
                          kLeaveSigma = 0.3;  // of the distance to the nearest probe that sees it

  // elapsed_s: since the last update; 0 or more. Lamps of the first update have their full weight at once.
  void update(std::span<const ProbeSightings> probes, double elapsed_s);
  [[nodiscard]] const std::vector<LampTrack>& lamps() const { return tracks_; }

 private:
  void link(LampTrack& track, std::span<const ProbeSightings> probes);
  bool follow(LampTrack& track, std::span<const ProbeSightings> probes, double elapsed_s);
  using FreeRays = std::vector<int>;  // sightings of a probe
  struct Votes {
    std::vector<int> sightings;  // [probes], −1: none
    std::vector<SightRay> rays;  // of those who see it
    double denied = 0;           // probes who look there and see nothing

    [[nodiscard]] double score() const { return static_cast<double>(rays.size()) - denied / 2; }
  };
  [[nodiscard]] std::vector<FreeRays> free_rays(std::span<const ProbeSightings> probes) const;
  static std::optional<Votes> vote(std::span<const ProbeSightings> probes, std::span<const FreeRays> free,
                                   const Vec3d& guess);
  [[nodiscard]] std::optional<LampTrack> best_lamp(std::span<const ProbeSightings> probes,
                                                   std::span<const FreeRays> free) const;
  void find_new(std::span<const ProbeSightings> probes);
  void share_out(std::span<const ProbeSightings> probes);
  std::vector<LampTrack> tracks_;
  std::uint32_t next_id_ = 1;
  bool first_ = true;
  std::size_t turn_ = 0;  // of the pairs of probes
};

}  // namespace lightwell
