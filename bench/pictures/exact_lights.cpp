// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "bench/pictures/ray_tracer.h"
#include "lighting/direction.h"

namespace lightwell::pictures {
namespace {

constexpr int kLargestBlock = 4;  // pixels a side that are taken together
constexpr int kFinestParts = 16;  // a side that a pixel is cut into

class Cutter {
 public:
  Cutter(const LatLongImage& image, double most_share) : image_(image) {
    for (int y = 0; y < rows(); ++y)
      for (int x = 0; x < image.width; ++x)
        most_ += image.pixel_solid_angle_sr(y) * luminance(image.at(x, y));
    most_ *= most_share;
  }
  [[nodiscard]] int rows() const { return (image_.height + 1) / 2; }

  // A block of side × side pixels, cut where it carries too much.
  void block(int x, int y, int side) {
    Rgbd illuminance = Rgbd::Zero();
    Vec3d direction = Vec3d::Zero();
    for (int j = y; j < std::min(y + side, rows()); ++j)
      for (int i = x; i < std::min(x + side, image_.width); ++i) {
        const Rgbd part = image_.at(i, j).cast<double>() * image_.pixel_solid_angle_sr(j);
        illuminance += part;
        direction +=
            luminance(part) * direction_from_lat_long((i + 0.5) / image_.width, (j + 0.5) / image_.height);
      }
    const double power = luminance(illuminance);
    if (!(power > 0)) return;
    if (power <= most_) {
      lights.push_back({direction.normalized().cast<float>(), illuminance.cast<float>(), -1, 0});
    } else if (side > 1) {
      for (int part = 0; part < 4; ++part) {
        const int i = x + part % 2 * side / 2;
        const int j = y + part / 2 * side / 2;
        if (i < image_.width && j < rows()) block(i, j, side / 2);
      }
    } else {
      cut_pixel(x, y, std::clamp(static_cast<int>(std::ceil(std::sqrt(power / most_))), 1, kFinestParts));
    }
  }

  std::vector<DirectionalLight> lights;

 private:
  void cut_pixel(int x, int y, int parts) {
    for (int j = 0; j < parts; ++j) {
      const double top = (y + static_cast<double>(j) / parts) / image_.height;
      const double bottom = (y + (j + 1.0) / parts) / image_.height;
      const double solid_angle_sr =
          2 * kPi / image_.width / parts * (std::cos(kPi * top) - std::cos(kPi * bottom));
      for (int i = 0; i < parts; ++i)
        lights.push_back({direction_from_lat_long((x + (i + 0.5) / parts) / image_.width, (top + bottom) / 2)
                              .cast<float>(),
                          (image_.at(x, y).cast<double>() * solid_angle_sr).cast<float>(), -1, 0});
    }
  }

  const LatLongImage& image_;
  double most_ = 0;
};

}  // namespace

std::vector<DirectionalLight> exact_lights(const LatLongImage& image, double most_share) {
  Cutter cutter(image, most_share);
  for (int y = 0; y < cutter.rows(); y += kLargestBlock)
    for (int x = 0; x < image.width; x += kLargestBlock) cutter.block(x, y, kLargestBlock);
  return std::move(cutter.lights);
}

}  // namespace lightwell::pictures
