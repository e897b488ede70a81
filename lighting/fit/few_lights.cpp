// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/fit/few_lights.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "lighting/decomposition/decompose.h"
#include "lighting/fit/cold_fit.h"
#include "lighting/fit/fit_confidence.h"

namespace lightwell {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kFinish = 1e-6;    // of the cost: what an iteration must win to go on
constexpr int kQuickLights = 4;     // more have so many optima that they need a thorough search
constexpr int kWarmIterations = 6;  // the light of one frame is near that of the one before
// A light found anew replaces an old one of the frame before only where that clearly pays: lights that jump show.
constexpr double kWarmGain = 0.04;  // of the cost: 2 % of the residual
// A residual that grew so much since the frame before, or a probe of which so much changed (relative RMS, whatever its
// brightness), is another scene: the lights before may lead to a poor optimum of it.
constexpr double kCut = 1.5;
constexpr double kOtherProbe = 0.1;
constexpr double kSameLight = 20 * kPi / 180;  // moved so far since the frame before, a light is another

Vec3d mean_direction(const LightsTrial& trial, int a, int b) {
  const auto weighted = [&](int k) -> Vec3d {
    return trial.direction.col(k) * luminance(Rgbd(trial.power.row(k + 1).transpose()));
  };
  const Vec3d sum = weighted(a) + weighted(b);
  return sum.norm() > 0 ? Vec3d(sum.normalized()) : Vec3d(trial.direction.col(a));
}

double angle_between(const Vec3d& a, const Vec3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

}  // namespace

struct FewLights::State {
  State(const PolarGrid& grid, const FewLightsOptions& o)
      : options(o),
        probe(grid),
        faces(o.with_shadow),
        search(faces, kFinish),
        cold(faces, search),
        confidence(faces),
        left(faces.rows(), 3) {}

  const FewLightsFit& fit(const PolarMap& map) noexcept {
    probe.irradiance(map, irradiance);
    faces.set_probe(irradiance);
    if (options.with_shadow) {
      faces.set_ground(ground.irradiance(map));
      search.columns_changed();
    }
    return fit(coverage_of(map.grid), probe.total_illuminance());
  }

  const FewLightsFit& fit(const ProbeIrradiance& given) noexcept {
    faces.set_probe(given);
    if (options.with_shadow) search.columns_changed();
    return fit(Coverage::sphere, given.colwise().mean().transpose() * 4);
  }

  // Relative RMSE, of both parts alike where the ground counts too.
  [[nodiscard]] double residual_of(const LightsTrial& t) const noexcept {
    return std::sqrt(t.cost / faces.parts());
  }

  // The trial's lights whose powers are all held at 0 do nothing.
  void drop_dark() noexcept {
    for (int k = trial.count; k-- > 0;) {
      if ((trial.power.row(k + 1) > 0).any()) continue;
      remove(k);
      ++result.needless;
    }
  }

  void remove(int light) noexcept {
    trial.remove(light);
    trial.positive = {};
    search.solve_powers(trial);
  }

  // Closest pairs first, as long as the fit can do without telling them apart.
  void merge_close() noexcept {
    while (trial.count > 1) {
      int a = -1, b = -1;
      double closest = kMergeAngle;
      for (int i = 0; i < trial.count; ++i)
        for (int j = i + 1; j < trial.count; ++j) {
          const double angle = angle_between(trial.direction.col(i), trial.direction.col(j));
          if (angle >= closest) continue;
          closest = angle;
          a = i, b = j;
        }
      if (a < 0) return;
      LightsTrial merged = trial;
      merged.direction.col(a) = mean_direction(trial, a, b);
      merged.remove(b);
      merged.positive = {};
      search.refine(merged, 20);
      const double now = residual_of(trial);
      const double after = residual_of(merged);
      const double allowed =
          closest < kTwinAngle ? std::max(kTwinResidual, (1 + kMergeCost) * now) : (1 + kMergeCost) * now;
      if (after > allowed || after > std::max(now, options.max_error.value_or(kInfinity))) return;
      trial = merged;
      ++result.merged;
      result.merged_rad = std::max(result.merged_rad, closest);
    }
  }

  // Of lights that reproduce the probe exactly, those that it takes.
  void drop_beyond_exact() noexcept {
    for (int k = trial.count; k-- > 0;) {
      if (residual_of(trial) > kExactResidual) return;
      const LightsTrial fewer = search.without(trial, k);
      if (residual_of(fewer) > kExactResidual) continue;
      trial = fewer;
      ++result.needless;
    }
  }

  void fit_cold() noexcept {
    result.warm = false;
    trial.count = 0;
    trial.positive = {};
    search.solve_powers(trial);
    if (residual_of(trial) <= kEvenResidual && residual_of(trial) <= options.max_error.value_or(1)) {
      return;
    }
    if (!options.max_error) {
      trial = cold.fit(options.lights,
                       options.lights <= kQuickLights ? ColdFit::Effort::quick : ColdFit::Effort::thorough)
                  .trial;
      return;
    }
    fit_to_bound();
  }

  void fit_to_bound() noexcept {
    double best = residual_of(trial);
    ColdFit::Found fewer{trial, 0, 0};
    result.residual_of_fewer = kInfinity;
    result.confidence = 1;
    while (best > *options.max_error && trial.count < options.lights) {
      const ColdFit::Found found = cold.fit(trial.count + 1, ColdFit::Effort::thorough);
      result.residual_of_fewer = best;
      const double n = fewer.starts, w = fewer.optima;
      result.confidence = fewer.starts > 2 ? std::max(0.0, 1 - w * (w + 1) / (n * (n - 1))) : 1;
      fewer = found;
      trial = found.trial;
      best = residual_of(trial);
    }
    result.reached = best <= *options.max_error;
  }

  // False: the lights of the frame before do not lead to this one's.
  bool fit_warm() noexcept {
    result.warm = true;
    const double before = result.residual;
    if ((faces.observed().topRows<kProbeNormals>() - probe_before).norm() > kOtherProbe) return false;
    search.refine(trial, kWarmIterations);
    const double bound = options.max_error.value_or(0);
    const double now = residual_of(trial);
    if (now > std::max({kCut * before, before + kEvenResidual, bound})) return false;
    ++frames;
    if (options.max_error) return follow_bound(now);
    if (trial.count < options.lights) return try_one_more();
    if (trial.count > 0) {
      const int light = static_cast<int>(frames % static_cast<std::uint64_t>(trial.count));
      search.exchange_one(trial, light, kWarmGain);
    }
    return true;
  }

  bool try_one_more() noexcept {
    if (residual_of(trial) <= (trial.count == 0 ? kEvenResidual : kExactResidual)) return true;
    const LightsTrial more = search.with_one_more(trial);
    if (more.cost < trial.cost * (1 - kWarmGain)) trial = more;
    return true;
  }

  // One light more where the bound is missed, one less where the bound is met by a margin without it.
  bool follow_bound(double now) noexcept {
    constexpr double kMargin = 0.9;
    if (now > *options.max_error) {
      return trial.count >= options.lights && !result.reached;  // else it may be had with other lights
    }
    result.reached = true;
    if (trial.count == 0) return true;
    const int light = static_cast<int>(frames % static_cast<std::uint64_t>(trial.count));
    const LightsTrial fewer = search.without(trial, light);
    if (residual_of(fewer) > kMargin * *options.max_error) return true;
    trial = fewer;
    return true;
  }

  // What was observed is in faces.
  const FewLightsFit& fit(Coverage coverage, const Rgbd& total) noexcept {
    cold.observations_changed();
    const bool had_lights = any_before && !result.black;
    const FewLightsFit before = any_before ? result : FewLightsFit{};
    result = {};
    result.residual = before.residual;
    result.reached = before.reached;
    result.residual_of_fewer = before.residual_of_fewer;
    result.confidence = before.confidence;
    result.coverage = coverage;
    result.bounded = options.max_error.has_value();
    result.with_shadow = faces.with_shadow();
    result.total_illuminance = total;
    any_before = true;
    if (!(faces.scale() > 0)) {
      trial.count = 0;
      result.black = true;
      result.residual = 0;
      result.reached = true;
      return result;
    }
    if (!had_lights || !fit_warm()) fit_cold();
    probe_before = faces.observed().topRows<kProbeNormals>();
    drop_dark();
    merge_close();
    drop_beyond_exact();
    report(before);
    return result;
  }

  // A light is the one of the frame before that is nearest to it, the brightest first to choose.
  void recognise(const FewLightsFit& before) noexcept {
    std::array<bool, kMostFittedLights> taken{};
    for (int k = 0; k < result.count; ++k) {
      FittedLight& light = result.lights[index(k)];
      int same = -1;
      double closest = kSameLight;
      for (int j = 0; j < before.count; ++j) {
        const double angle = angle_between(light.direction, before.lights[index(j)].direction);
        if (taken[index(j)] || angle >= closest) continue;
        closest = angle;
        same = j;
      }
      if (same >= 0) taken[index(same)] = true;
      light.id = same >= 0 ? before.lights[index(same)].id : next_id++;
    }
  }

  // The trial in lux, brightest light first.
  void report(const FewLightsFit& before) noexcept {
    const FitSigmas sigmas = confidence.sigmas(trial);
    const double scale = faces.scale();
    result.count = trial.count;
    result.ambient = trial.power.row(0).transpose() * scale;
    for (int k = 0; k < trial.count; ++k) {
      FittedLight& light = result.lights[index(k)];
      light.direction = trial.direction.col(k);
      light.illuminance = trial.power.row(k + 1).transpose() * scale;
      light.direction_sigma_rad = sigmas.direction_rad[index(k)];
      light.illuminance_sigma = sigmas.power.row(k).transpose() * scale;
    }
    std::sort(result.lights.begin(), result.lights.begin() + result.count,
              [](const FittedLight& a, const FittedLight& b) {
                return luminance(a.illuminance) > luminance(b.illuminance);
              });
    recognise(before);
    search.residual(trial, left);
    result.residual = left.topRows<kProbeNormals>().norm();
    if (faces.with_shadow()) result.shadow_residual = left.bottomRows<kGroundPoints>().norm();
    result.even = trial.count == 0 && result.residual <= kEvenResidual;
  }

  static std::size_t index(int i) { return static_cast<std::size_t>(i); }

  FewLightsOptions options;
  LambertianProbe probe;
  ShadowGround ground;
  FaceObservations faces;
  LightSearch search;
  ColdFit cold;
  FitConfidence confidence;
  Eigen::Matrix<double, Eigen::Dynamic, 3> left;
  ProbeIrradiance irradiance;
  Eigen::Matrix<double, kProbeNormals, 3> probe_before;  // of norm 1
  LightsTrial trial;
  std::uint32_t next_id = 1;
  std::uint64_t frames = 0;
  bool any_before = false;
  FewLightsFit result;
};

LightSet light_set(const FewLightsFit& fit) {
  static constexpr double kMost = std::numeric_limits<float>::max();
  const auto single = [](const Rgbd& power) -> Rgb { return power.min(kMost).cast<float>(); };
  LightSet set;
  set.method = "fit";
  set.coverage = fit.coverage;
  set.total_illuminance = single(fit.total_illuminance);
  set.ambient = single(fit.ambient);
  for (int k = 0; k < fit.count; ++k) {
    const FittedLight& light = fit.lights[static_cast<std::size_t>(k)];
    DirectionalLight out;
    out.direction = light.direction.cast<float>();
    out.illuminance = single(light.illuminance);
    out.id = light.id;
    set.lights.push_back(out);
  }
  return set;
}

std::vector<std::string> remarks(const FewLightsFit& fit) {
  std::vector<std::string> sentences;
  const auto count = [](int n, const char* one, const char* many) {
    return std::to_string(n) + (n == 1 ? one : many);
  };
  if (fit.black) sentences.emplace_back("the map is black: no lights");
  if (fit.even) sentences.emplace_back("no direction: the light comes evenly from everywhere");
  if (fit.merged > 0) {
    char angle[16];
    std::snprintf(angle, sizeof angle, "%.1f", fit.merged_rad * 180 / kPi);
    sentences.push_back(count(fit.merged, " light", " lights") + " merged with a neighbour up to " + angle +
                        " degrees away, which the probe does not tell apart");
  }
  if (fit.needless > 0)
    sentences.push_back(count(fit.needless, " light", " lights") + " left out: the others do without");
  if (!fit.reached) sentences.emplace_back("the error asked for was not reached");
  return sentences;
}

FewLights::FewLights(std::unique_ptr<State> state) : state_(std::move(state)) {}
FewLights::FewLights(FewLights&&) noexcept = default;
FewLights& FewLights::operator=(FewLights&&) noexcept = default;
FewLights::~FewLights() = default;

Result<FewLights> FewLights::create(const PolarGrid& grid, const FewLightsOptions& options) {
  if (options.lights < 1 || options.lights > kMostFittedLights)
    return Error{ErrorKind::usage, "lights = " + std::to_string(options.lights) + ", allowed 1 to " +
                                       std::to_string(kMostFittedLights)};
  if (options.max_error && !(*options.max_error > 0 && *options.max_error <= 1))
    return Error{ErrorKind::usage,
                 "max_error = " + std::to_string(*options.max_error) + ", allowed above 0 to 1"};
  if (options.max_error && options.with_shadow)
    return Error{ErrorKind::usage, "max_error bounds the probe alone: not together with the shadow"};
  return FewLights(std::make_unique<State>(grid, options));
}

const FewLightsFit& FewLights::fit(const PolarMap& map) noexcept {
  return state_->fit(map);
}

const FewLightsFit& FewLights::fit(const ProbeIrradiance& probe) noexcept {
  return state_->fit(probe);
}

void FewLights::reset() noexcept {
  state_->any_before = false;
}

Result<FewLightsFit> fit_few_lights(const PolarMap& map, const FewLightsOptions& options) {
  auto fitter = FewLights::create(map.grid, options);
  if (!fitter) return fitter.error();
  const FewLightsFit fit = fitter->fit(map);
  if (!(fit.total_illuminance <= static_cast<double>(std::numeric_limits<float>::max())).all())
    return Error{ErrorKind::bad_input, "the total illuminance is beyond a single-precision number"};
  return fit;
}

}  // namespace lightwell
