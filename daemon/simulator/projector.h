// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "daemon/simulator/scene.h"
#include "lighting/lens.h"
#include "lighting/orientation.h"

namespace lightwell::simulator {

// Light onto pixels without loss: what a plane of radiances holds, Σ radiance × solid angle, is what went in.
//
// A plane is [height][width] radiance in cd/m² of each pixel's own channel: luminance on a monochrome sensor,
// one of R, G, B on an RGGB one. A ray's energy goes to the pixels around its image by bilinear weights (a
// tent of one pixel; of two on a Bayer sensor, whose optical low-pass filter does the same, so that each of
// the four colour sites gets its whole share). At the border of the field weights follow how much of a pixel
// lies inside, and sum to 1 still. The camera is tilted as the lens's zenith says; sums are exact for a level one.
class Projector {
 public:
  Projector(const Lens& lens, bool bayer);

  [[nodiscard]] std::size_t pixels() const { return solid_angle_sr_.size(); }
  [[nodiscard]] const Lens& lens() const { return lens_; }
  [[nodiscard]] bool bayer() const { return bayer_; }
  // Of each pixel, sr.
  [[nodiscard]] std::span<const float> solid_angles() const { return solid_angle_sr_; }

  void add_disc(const DiscLight& light, std::span<float> plane) const;
  void add_ray(const Vec3d& direction, const Rgbd& illuminance, std::span<float> plane) const;
  // The image over the lens's field. smooth: interpolated at each pixel's centre and scaled so that the sum
  // is exact (by less than 1 % for what deserves the name); else every pixel of the image is cut into rays
  // closer than the camera's pixels, each with its exact energy.
  [[nodiscard]] std::vector<float> project(const Layer& layer) const;

 private:
  struct Taps {
    std::uint32_t cell[2] = {};  // of two neighbouring columns in the upper row
    std::uint32_t down = 0;      // from the upper row to the lower
    float u = 0, v = 0;          // toward the right, downward
  };
  void add_at(const Vec2d& image_point, const Rgbd& illuminance, std::span<float> plane) const;
  [[nodiscard]] double channel(const Rgbd& colour, int x, int y) const;
  [[nodiscard]] std::vector<float> interpolate(const LatLongImage& image) const;
  [[nodiscard]] std::vector<float> scatter(const LatLongImage& image) const;
  const std::vector<Taps>& taps(int width, int height) const;

  Lens lens_;
  Eigen::Matrix3d camera_from_world_;
  bool level_;
  bool bayer_;
  std::vector<float> solid_angle_sr_;
  std::vector<float> inside_;  // 0 to 1, part of the pixel inside the field
  bool whole_field_;           // no part of the field lies outside the image
  mutable int taps_width_ = 0, taps_height_ = 0;
  mutable std::vector<Taps> taps_;  // for the last grid that was asked for
};

}  // namespace lightwell::simulator
