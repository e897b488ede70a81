// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <vector>

#include "lighting/luminaire/near_field.h"
#include "render/bounding_sphere.h"
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
    Vec3f point, normal;  // unit, of the triangle: either side may be lit
  };
  [[nodiscard]] std::span<const Place> places() const { return places_; }

 private:
  struct Origin {
    std::uint32_t first_index;
    float a, b;  // of the second and third corner
  };
  std::vector<Origin> origins_;
  std::vector<Place> places_;
};

// How many positions of a lamp's near field, a side, are drawn as one: so many that the picture changes by no more than an
// error, relative RMS.
class LampDetail {
 public:
  explicit LampDetail(const NearField& lamp);
  LampDetail() = default;

  // What taking groups together changes where the lamp stands:
  struct Error {
    double pattern = 0;  // of the illuminance of the receivers' places, as if nothing cast shadows
    // Of edges of shadows, which become steps: an object of radius R at the distance D throws edges of δ = σ R / (D − R),
    // σ: of the light about the groups' middles. A step instead of a ramp errs by its width / 12 a length of edge; edges as
    // long as the object's outline fall on four times its cross-section.
    double shadow = 0;
    [[nodiscard]] double total() const;
  };
  [[nodiscard]] Error error(const NearField& lamp, int group, std::span<const Receivers::Place> places,
                            const Sphere& objects, const Eigen::Isometry3d& world_from_lamp) const;

  // The largest group whose error is within the bound. least: of what the renderer can hold. now: the group that is drawn,
  // which stays unless it errs more, or another would not err by half as much as is allowed; 0: none.
  [[nodiscard]] int choose(const NearField& lamp, double bound, std::span<const Receivers::Place> places,
                           const Sphere& objects, const Eigen::Isometry3d& world_from_lamp, int least,
                           int now) const;

 private:
  std::vector<double> fluxes_;  // of the positions
  double spread_m_ = 0;         // σ of all light about its middle
};

}  // namespace lightwell::render
