// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <vector>

#include "lighting/luminaire/near_field.h"
#include "render/caster_outlines.h"
#include "render/scene.h"

namespace lightwell::render {

// Places of a scene's surfaces that stand for what a lamp lights: evenly over each primitive, as many for a small one as
// for a large one.
class Receivers {
 public:
  explicit Receivers(const Scene& scene);
  Receivers() = default;
  // Follows the scene that it was made of.
  void move(const Scene& scene);

  struct Place {
    Vec3f point, normal;    // unit, of the triangle: either side may be lit
    std::size_t primitive;  // of the scene
  };
  [[nodiscard]] std::span<const Place> places() const { return places_; }

 private:
  struct Origin {
    std::uint32_t first_index;
    float a, b;  // of the second and third corner
    std::size_t primitive;
  };
  std::vector<Origin> origins_;
  std::vector<Place> places_;
};

// What a lamp lights, and the outlines of what casts as they are seen from lamp_eye().
struct LampStage {
  std::span<const Receivers::Place> places;
  std::span<const CasterOutline> outlines;
};
// The middle of its positions, world.
Vec3d lamp_eye(const NearField& lamp, const Eigen::Isometry3d& world_from_lamp);

// Of so many places an even choice of this many is looked at, so that a lamp of many positions is not looked at for seconds:
// their product is at most 32768, or 64 places.
std::size_t places_looked_at(std::size_t places, std::size_t positions);

// How many positions of a lamp's near field, a side, are drawn as one: so many that the picture changes by no more than an
// error, relative RMS.
class LampDetail {
 public:
  explicit LampDetail(const NearField& lamp);
  LampDetail() = default;

  // What taking groups together changes where the lamp stands:
  struct Error {
    double pattern = 0;  // of the illuminance of the stage's places, as if nothing cast shadows
    // Of edges of shadows, which become steps. From a light of σ an edge at the distance D falls on what is behind it, at t,
    // as a ramp of √12 σ (1/D − 1/t), an angle as the lamp sees it. A step instead of a ramp errs by its width / 12 a length of
    // edge; of all of the lamp's ramp only the groups' steps are left, σ of the light about their middles. Set against four
    // times what the casters' bounds cover, or what they leave of the beam (its flux over the candela; a quarter at least),
    // each by the square of the light.
    double shadow = 0;
    [[nodiscard]] double total() const;
  };
  [[nodiscard]] Error error(const NearField& lamp, int group, const LampStage& stage,
                            const Eigen::Isometry3d& world_from_lamp) const;

  // The largest group whose error is within the bound. least: of what the renderer can hold. now: the group that is drawn,
  // which stays unless it errs more, or another would not err by half as much as is allowed; 0: none.
  [[nodiscard]] int choose(const NearField& lamp, double bound, const LampStage& stage,
                           const Eigen::Isometry3d& world_from_lamp, int least, int now) const;

 private:
  std::vector<double> fluxes_;  // of the positions
  double spread_m_ = 0;         // σ of all light about its middle
};

}  // namespace lightwell::render
