// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/lamp_tracks.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace lightwell {
namespace {

constexpr double kDegree = kPi / 180;
constexpr double kGate = 3 * kDegree;    // between a lamp and its ray
constexpr double kMargin = 3 * kDegree;  // from the edge of what a probe sees, where a lamp is cut
constexpr double kSmoothing_s = 0.1;     // of the position
constexpr double kPairFactor = 2;        // of intensity between two probes who alone see a lamp
constexpr std::size_t kTriedAProbe = 4;  // rays of a probe in the search for new lamps

// cos of the angle between a probe's ray and a place.
double agreement(const Vec3d& place, const Vec3d& position, const Vec3d& direction) {
  return (place - position).normalized().dot(direction);
}

// The sighting nearest to where a lamp should be, within an angle.
int nearest(const ProbeSightings& probe, const Vec3d& place, double gate_rad) {
  if (!probe.present || (place - probe.position).norm() <= kLeastLampDistance_m) return -1;
  int best = -1;
  double most = std::cos(gate_rad);
  for (std::size_t i = 0; i < probe.lamps.size(); ++i)
    if (const double cosine = agreement(place, probe.position, probe.lamps[i].direction); cosine > most) {
      most = cosine;
      best = static_cast<int>(i);
    }
  return best;
}

double intensity_of(const ProbeSightings& probe, int sighting, const Vec3d& place) {
  return luminance(probe.lamps[static_cast<std::size_t>(sighting)].illuminance) *
         (place - probe.position).squaredNorm();
}

SightRay sight_ray(const ProbeSightings& probe, int sighting) {
  return {probe.position, probe.lamps[static_cast<std::size_t>(sighting)].direction};
}

// Certainty: the position's deviation over the distance to the nearest probe that sees the lamp.
double relative_sigma(const LampPlace& place, std::span<const SightRay> rays) {
  double nearest_m = std::numeric_limits<double>::max();
  for (const SightRay& ray : rays) nearest_m = std::min(nearest_m, (place.position - ray.origin).norm());
  return place.sigma_m / nearest_m;
}

}  // namespace

bool looks_at(const ProbeSightings& probe, const Vec3d& place) {
  const Vec3d toward = place - probe.position;
  const double distance = toward.norm();
  return probe.present && distance > kLeastLampDistance_m &&
         toward.y() > distance * std::cos(std::max(0.0, probe.theta_max_rad - kMargin));
}

// Looks for a known lamp's rays.
void LampTracks::link(LampTrack& track, std::span<const ProbeSightings> probes) {
  track.links.resize(probes.size());
  for (std::size_t n = 0; n < probes.size(); ++n) {
    const double distance = std::max((track.position - probes[n].position).norm(), kLeastLampDistance_m);
    track.links[n].sighting = nearest(probes[n], track.position, kGate + track.sigma_m / distance);
  }
}

// Moves a lamp to where its rays say. False where it is to be given up.
bool LampTracks::follow(LampTrack& track, std::span<const ProbeSightings> probes, double elapsed_s) {
  std::vector<SightRay> rays;
  for (std::size_t n = 0; n < probes.size(); ++n) {
    const int sighting = track.links[n].sighting;
    if (sighting < 0) continue;
    // Where two lamps stand in one line their common centre is that of neither.
    const bool shared = std::any_of(tracks_.begin(), tracks_.end(), [&](const LampTrack& other) {
      return other.id != track.id && other.links[n].sighting == sighting;
    });
    if (!shared) rays.push_back(sight_ray(probes[n], sighting));
  }
  const double change = elapsed_s / kFade_s;
  const auto place = triangulate(rays, track.position);
  const bool certain = place && relative_sigma(*place, rays) < (track.weight > 0 ? kLeaveSigma : kEnterSigma);
  track.weight = std::clamp(track.weight + (certain ? change : -change), 0.0, 1.0);
  if (!certain) return track.weight > 0;
  track.position += (1 - std::exp(-elapsed_s / kSmoothing_s)) * (place->position - track.position);
  track.sigma_m = place->sigma_m;
  return true;
}

// Rays that no lamp claims: [probes], the brightest kTriedAProbe of each.
std::vector<LampTracks::FreeRays> LampTracks::free_rays(std::span<const ProbeSightings> probes) const {
  std::vector<FreeRays> free(probes.size());
  for (std::size_t n = 0; n < probes.size(); ++n)
    for (std::size_t i = 0; probes[n].present && i < probes[n].lamps.size(); ++i) {
      const bool claimed = std::any_of(tracks_.begin(), tracks_.end(), [&](const LampTrack& track) {
        return track.links[n].sighting == static_cast<int>(i);
      });
      if (!claimed && free[n].size() < kTriedAProbe) free[n].push_back(static_cast<int>(i));
    }
  return free;
}

// What all probes say to a lamp at a place that two rays gave; none where too few confirm it.
std::optional<LampTracks::Votes> LampTracks::vote(std::span<const ProbeSightings> probes,
                                                  std::span<const FreeRays> free, const Vec3d& guess) {
  Votes votes;
  votes.sightings.assign(probes.size(), -1);
  double least = std::numeric_limits<double>::max(), most = 0;
  for (std::size_t n = 0; n < probes.size(); ++n) {
    const Vec3d toward = (guess - probes[n].position).normalized();
    double nearest_cosine = std::cos(kGate);
    for (const int i : free[n])
      if (const double cosine = toward.dot(probes[n].lamps[static_cast<std::size_t>(i)].direction);
          cosine > nearest_cosine) {
        nearest_cosine = cosine;
        votes.sightings[n] = i;
      }
    if (const int found = votes.sightings[n]; found >= 0) {
      votes.rays.push_back(sight_ray(probes[n], found));
      least = std::min(least, intensity_of(probes[n], found, guess));
      most = std::max(most, intensity_of(probes[n], found, guess));
    } else if (looks_at(probes[n], guess)) {
      ++votes.denied;
    }
  }
  const std::size_t count = votes.rays.size();
  if (count < 2 || (count < 3 && (votes.denied > 0 || most > kPairFactor * least))) return std::nullopt;
  return votes;
}

// The lamp that most rays confirm, of all that two rays give; none where there is no certain one. Most pairs of 64 probes'
// rays pass far from each other, and most places that are left lose by their votes alone, so few are triangulated.
std::optional<LampTrack> LampTracks::best_lamp(std::span<const ProbeSightings> probes,
                                               std::span<const FreeRays> free) const {
  std::optional<LampTrack> best;
  double best_score = 1;
  std::set<std::vector<int>> tried;  // by their sightings: many pairs of rays give the same lamp
  const auto try_pair = [&](const SightRay& a, const SightRay& b) {
    const auto guess = meeting_point(a, b, 2 * kLeastLampDistance_m);
    if (!guess || agreement(*guess, a.origin, a.direction) <= std::cos(kGate) ||
        agreement(*guess, b.origin, b.direction) <= std::cos(kGate))
      return;
    auto votes = vote(probes, free, *guess);
    // A probe who looks there and sees nothing counts half: something may stand between.
    if (!votes || votes->score() <= best_score || !tried.insert(votes->sightings).second) return;
    const auto place = triangulate(votes->rays, *guess);
    if (!place || place->residual_rad > kGate / 2 || relative_sigma(*place, votes->rays) > kEnterSigma)
      return;
    const double score = votes->score() - place->residual_rad / kGate;
    if (score <= best_score) return;
    best_score = score;
    best.emplace();
    best->position = place->position;
    best->sigma_m = place->sigma_m;
    best->links.resize(probes.size());
    for (std::size_t n = 0; n < probes.size(); ++n) best->links[n].sighting = votes->sightings[n];
  };
  const std::size_t turns = first_ ? 1 : (probes.size() + kPairedAtOnce - 1) / kPairedAtOnce;
  for (std::size_t p = 0; p < probes.size(); ++p)
    for (const int i : free[p])
      for (std::size_t q = p + 1; q < probes.size(); ++q) {
        if ((p + q) % turns != turn_ % turns) continue;
        for (const int j : free[q]) try_pair(sight_ray(probes[p], i), sight_ray(probes[q], j));
      }
  return best;
}

void LampTracks::find_new(std::span<const ProbeSightings> probes) {
  std::vector<FreeRays> free = free_rays(probes);
  while (auto found = best_lamp(probes, free)) {
    found->id = next_id_++;
    found->weight = first_ ? 1 : 0;
    for (std::size_t n = 0; n < probes.size(); ++n) std::erase(free[n], found->links[n].sighting);
    tracks_.push_back(std::move(*found));
  }
  ++turn_;
}

// What each probe measured of each lamp. Of a sighting that two lamps claim each has what its mean intensity foretells.
void LampTracks::share_out(std::span<const ProbeSightings> probes) {
  std::vector<double> foretold;  // candela, of each lamp
  for (const LampTrack& track : tracks_) foretold.push_back(std::max(luminance(track.intensity), 1e-9));
  for (std::size_t t = 0; t < tracks_.size(); ++t) {
    LampTrack& track = tracks_[t];
    Rgbd sum = Rgbd::Zero();
    double seen = 0, radius = 0;
    for (std::size_t n = 0; n < probes.size(); ++n) {
      LampTrack::Link& link = track.links[n];
      const double square = (track.position - probes[n].position).squaredNorm();
      link.known = link.sighting >= 0 || looks_at(probes[n], track.position);
      link.share = 0;
      link.intensity.setZero();
      if (link.sighting < 0) continue;
      double own = 0, all = 0;
      for (std::size_t o = 0; o < tracks_.size(); ++o)
        if (tracks_[o].links[n].sighting == link.sighting) {
          const double lux = foretold[o] / (tracks_[o].position - probes[n].position).squaredNorm();
          all += lux;
          if (o == t) own = lux;
        }
      const LampSighting& lamp = probes[n].lamps[static_cast<std::size_t>(link.sighting)];
      link.share = own / all;
      link.intensity = link.share * square * lamp.illuminance;
      sum += link.intensity;
      radius += std::sin(std::min(lamp.angular_radius_rad, kPi / 2)) * std::sqrt(square);
      ++seen;
    }
    if (seen > 0) {
      track.intensity = sum / seen;
      track.radius_m = radius / seen;
    }
  }
}

void LampTracks::update(std::span<const ProbeSightings> probes, double elapsed_s) {
  for (LampTrack& track : tracks_) link(track, probes);
  std::vector<std::uint32_t> lost;
  for (LampTrack& track : tracks_)
    if (!follow(track, probes, elapsed_s)) lost.push_back(track.id);
  std::erase_if(tracks_, [&](const LampTrack& track) {
    return std::find(lost.begin(), lost.end(), track.id) != lost.end();
  });
  find_new(probes);
  // A new lamp may stand in one line with another.
  for (LampTrack& track : tracks_) link(track, probes);
  // Shares rest on intensities, which rest on the other probes' shares.
  for (int round = 0; round < 3; ++round) share_out(probes);
  const bool any =
      std::any_of(probes.begin(), probes.end(), [](const ProbeSightings& p) { return p.present; });
  first_ = first_ && !any;
}

}  // namespace lightwell
