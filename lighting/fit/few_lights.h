// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lighting/fit/variable_projection.h"
#include "lighting/light_set.h"
#include "lighting/polar_map.h"
#include "lighting/result.h"

namespace lightwell {

// An ambient term and few directional lights that shade a white Lambertian sphere as a whole map does.
// source: Madsen, Sørensen, Vittrup 2003, "Real-time image-based lighting …", section 3, with the solid angle in its sum,
// powers that are never negative, and the number of lights from an error bound, which the paper leaves open.
struct FewLightsOptions {
  int lights = 4;  // 1 to 16: so many, or where max_error is given at most so many
  // Relative RMSE of the probe, above 0 to 1: the fewest lights that reach it.
  std::optional<double> max_error{};
  // Fits the probe's shadow on the ground as well (lighting/fit/shadow_ground.h): tells more than six lights apart.
  bool with_shadow = false;
};

// Lights closer than this are one light where the fit is hardly worse for it …
inline constexpr double kMergeAngle = 10 * kPi / 180;
inline constexpr double kMergeCost = 0.01;  // of the residual
// … and closer than this also where the fit stays below what a calibrated camera's map is known to.
inline constexpr double kTwinAngle = 3 * kPi / 180;
inline constexpr double kTwinResidual = 5e-3;
// Below this residual of the ambient term alone, light comes from nowhere in particular.
inline constexpr double kEvenResidual = 1e-3;
// Below this there is nothing left to fit: rounding of single-precision maps.
inline constexpr double kExactResidual = 1e-6;

struct FittedLight {
  Vec3d direction = Vec3d::UnitY();
  Rgbd illuminance = Rgbd::Zero();  // lux, ≥ 0
  std::uint32_t id = 0;             // the same light carries the same id from frame to frame
  // Standard deviations from the fit's own covariance, (residual² / 9) (JᵀJ)⁻¹ over directions and powers: a probe
  // that is lit by anything holds nine independent numbers (harmonics l ≤ 2), so that is what its misfit counts for.
  // They say how well the probe holds the light in place, not how well the map was measured. Infinite where it does not.
  double direction_sigma_rad = 0;
  Rgbd illuminance_sigma = Rgbd::Zero();
};

struct FewLightsFit {
  int count = 0;
  std::array<FittedLight, kMostFittedLights> lights;  // the first `count`, by falling luminance
  Rgbd ambient = Rgbd::Zero();                        // radiance from everywhere, cd/m², ≥ 0
  Rgbd total_illuminance = Rgbd::Zero();              // of the map, lux
  Coverage coverage = Coverage::sphere;               // of the map
  double residual = 0;         // relative RMSE of the probe, over its faces and RGB; 0 where it is black
  bool with_shadow = false;    // the ground was fitted too
  double shadow_residual = 0;  // the same of the ground, for its soft shadow
  bool warm = false;           // went on from the fit before

  // What became of the lights that were asked for.
  bool black = false;     // no light at all
  bool even = false;      // no direction: the ambient term alone is within kEvenResidual
  int merged = 0;         // lights that went into a neighbour
  double merged_rad = 0;  // the widest angle that was merged across
  int needless = 0;       // lights without power, or beyond what reproduces the probe exactly

  bool bounded = false;  // with max_error, for which alone the three below mean something
  bool reached = true;
  double residual_of_fewer =
      0;  // the least that one light fewer was found to leave; infinite where there is none
  // That fewer lights do not do: 1 − w (w + 1) / (n (n − 1)) after n random starts that ended in w different optima, the
  // Bayesian estimate of the part of all starts whose end has been seen (Boender, Rinnooy Kan 1987, "Bayesian stopping
  // rules for multistart global optimization methods").
  double confidence = 0;
};

// As a light set of method "fit", in progressive order.
LightSet light_set(const FewLightsFit& fit);
// What a person should know of it, a sentence each; empty where all is as asked.
std::vector<std::string> remarks(const FewLightsFit& fit);

// Fits map after map; each goes on from the one before and looks for one light anew besides. A map that the lights
// before do not fit (a cut, a lamp switched on) is fitted from the beginning.
class FewLights {
 public:
  // usage: lights, max_error
  static Result<FewLights> create(const PolarGrid& grid, const FewLightsOptions& options);
  FewLights(FewLights&&) noexcept;
  FewLights& operator=(FewLights&&) noexcept;
  ~FewLights();

  // map: of the grid given to create. Allocates nothing after create, but for the ground of with_shadow.
  const FewLightsFit& fit(const PolarMap& map) noexcept;
  // A probe of its own, as of a photographed sphere; total_illuminance is then four times its mean, and a shadow has no say.
  const FewLightsFit& fit(const ProbeIrradiance& probe) noexcept;
  // The next map is fitted from the beginning.
  void reset() noexcept;

 private:
  struct State;
  explicit FewLights(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

// One map. usage: options; bad_input where the light is beyond a float.
Result<FewLightsFit> fit_few_lights(const PolarMap& map, const FewLightsOptions& options);

}  // namespace lightwell
