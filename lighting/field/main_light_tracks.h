// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "lighting/field/main_lights.h"

namespace lightwell {

// Main lights of a field that changes, from field to field the same ones, so that shadows neither jump nor pop: a light goes
// uphill from where it was, holds still while noise alone would move it, and fades in and out. Their illuminances are those
// of the newest field: light that goes out takes its shadow with it at once.
// There are always as many lights as were asked for; those that are free have no illuminance. One thread at a time.
class MainLightTracks {
 public:
  explicit MainLightTracks(int count);  // 0 to kMostMainLights

  // The lights of the newest field, which may have another grid and degree. Those of the first one that has light are
  // find_main_lights(). dt_s: since the one before; low, high: as there. Valid until the next call.
  const MainLights& update(const LightField& field, double dt_s, const Vec3d& low, const Vec3d& high);

  static constexpr double kFade_s = 0.5;
  // What is shown holds while the light is within this of it.
  static constexpr double kHold_rad = 0.005;
  // 0 to 1, one a light.
  [[nodiscard]] const std::vector<double>& weights() const { return weights_; }

 private:
  void begin(const LightField& field, const Vec3d& low, const Vec3d& high);
  void follow(const Eigen::MatrixXd& points, int degree, double dt_s);
  void choose(const Eigen::MatrixXd& points, int degree);
  [[nodiscard]] std::vector<std::size_t> active() const;  // weight above 0, or wanted

  MainLights lights_;
  // Where each explains most. What is shown follows it: were the lights that are behind taken for what there is, the light that
  // they miss would count as another one.
  std::vector<Vec3d> directions_;
  std::vector<double> weights_;
  std::vector<bool> wanted_;
  bool began_ = false;
};

}  // namespace lightwell
