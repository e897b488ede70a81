// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/picture_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "lighting/field_error.h"
#include "lighting/orientation.h"

namespace lightwell {
namespace {

// Parts of pixels in a bin. On a lattice the area of a bin of so many is off by some √(4 √512 / 12) of them, half a
// percent, and by several times that where bins and pixels run alike.
constexpr double kPartsPerBin = 512;
constexpr int kMostPartsAlong = 256;  // of a pixel, beside the narrow bins at the pole

std::size_t outside(const PolarGrid& grid) {
  return grid.size();
}

// The bin that a direction of the world lies in.
std::size_t bin_of(const PolarGrid& grid, const Vec3d& world) {
  const Spherical s = spherical_from_direction(world);
  if (s.theta_rad > grid.theta_max_rad) return outside(grid);
  const int ring = std::min(grid.rings - 1, static_cast<int>(s.theta_rad / grid.theta_max_rad * grid.rings));
  const int sector = std::min(grid.sectors - 1, static_cast<int>(s.lambda_rad / (2 * kPi) * grid.sectors));
  return static_cast<std::size_t>(ring) * static_cast<std::size_t>(grid.sectors) +
         static_cast<std::size_t>(sector);
}

// What the bins have received.
struct Sums {
  std::vector<double> solid_angle_sr;
  std::vector<std::array<double, 3>> flux;
};

class Divider {
 public:
  Divider(const Lens& lens, const FlatField& flat, const PolarGrid& grid)
      : lens_(lens), flat_(flat), grid_(grid), world_from_camera_(world_from_camera_rotation(lens.zenith)) {}

  // Adds a pixel of a solid angle; its vignetting is that of each part. Returns the bin of its centre.
  std::size_t add(const Vec2d& pixel, double solid_angle_sr, const float* rgb, Sums& sums) {
    const Vec3d centre = lens_.unproject(pixel);
    const std::size_t bin = bin_of(grid_, world_from_camera_ * centre);
    bins_.clear();
    light_.clear();
    const int along = parts_along(centre, solid_angle_sr);
    for (int v = 0; v < along; ++v)
      for (int u = 0; u < along; ++u)
        add_part(pixel + Vec2d((u + 0.5) / along - 0.5, (v + 0.5) / along - 0.5));
    if (bins_.empty()) add_sliver(centre);
    const double share = solid_angle_sr / static_cast<double>(bins_.size());
    for (std::size_t i = 0; i < bins_.size(); ++i) {
      if (bins_[i] == outside(grid_)) continue;
      sums.solid_angle_sr[bins_[i]] += share;
      for (std::size_t c = 0; c < 3; ++c)
        sums.flux[bins_[i]][c] += share * light_[i] * static_cast<double>(rgb[c]);
    }
    return bin;
  }

 private:
  [[nodiscard]] int parts_along(const Vec3d& centre, double solid_angle_sr) const {
    const double theta = spherical_from_direction(world_from_camera_ * centre).theta_rad;
    const int ring =
        std::clamp(static_cast<int>(theta / grid_.theta_max_rad * grid_.rings), 0, grid_.rings - 1);
    const double parts = kPartsPerBin * solid_angle_sr / grid_.bin_solid_angle_sr(ring);
    return std::clamp(static_cast<int>(std::ceil(std::sqrt(parts))), 1, kMostPartsAlong);
  }
  void add_part(const Vec2d& at) {
    const Vec3d direction = lens_.unproject(at);
    const double theta = std::atan2(direction.head<2>().norm(), direction.z());
    if (theta > lens_.max_theta_rad) return;
    bins_.push_back(bin_of(grid_, world_from_camera_ * direction));
    light_.push_back(1 / flat_.transmission(theta));
  }

  // What the border leaves of a pixel may hold no part's centre: then it is of the border beside it.
  void add_sliver(const Vec3d& centre) {
    const double theta = lens_.max_theta_rad, s = std::sin(theta) / centre.head<2>().norm();
    const Vec3d border(s * centre.x(), s * centre.y(), std::cos(theta));
    bins_.push_back(bin_of(grid_, world_from_camera_ * border));
    light_.push_back(1 / flat_.transmission(theta));
  }

  const Lens& lens_;
  const FlatField& flat_;
  const PolarGrid& grid_;
  Eigen::Matrix3d world_from_camera_;
  std::vector<std::size_t> bins_;  // of the pixel's parts
  std::vector<double> light_;      // for one unit that the pixel received
};

Status check_sizes(const RadiancePicture& picture, const Lens& lens, const FlatField& flat) {
  if (const Status status = check(lens); !status) return status;
  if (const Status status = check(flat, lens); !status) return status;
  if (picture.width != lens.image_size[0])
    return field_error("lens.image_size[0]", lens.image_size[0],
                       std::to_string(picture.width) + ", the picture's width");
  if (picture.height != lens.image_size[1])
    return field_error("lens.image_size[1]", lens.image_size[1],
                       std::to_string(picture.height) + ", the picture's height");
  return {};
}

PolarMap map_of(const Sums& sums, const PolarGrid& grid) {
  PolarMap map = PolarMap::make(grid, 3);
  double measured_sr = 0;
  for (std::size_t bin = 0; bin < grid.size(); ++bin) {
    map.solid_angle_sr[bin] = static_cast<float>(sums.solid_angle_sr[bin]);
    measured_sr += sums.solid_angle_sr[bin];
    // By the solid angle as stored, so that their product is the light that came.
    const auto stored = static_cast<double>(map.solid_angle_sr[bin]);
    for (int c = 0; c < 3; ++c)
      map.plane(c)[bin] =
          stored > 0 ? static_cast<float>(sums.flux[bin][static_cast<std::size_t>(c)] / stored) : 0.0F;
  }
  map.coverage = static_cast<float>(measured_sr / (4 * kPi));
  return map;
}

}  // namespace

Lens shrunk(const Lens& lens, int factor) {
  Lens out = lens;
  for (std::size_t i = 0; i < 2; ++i) out.image_size[i] = (lens.image_size[i] + factor - 1) / factor;
  out.focal = lens.focal / factor;
  out.center = (lens.center.array() + 0.5) / factor - 0.5;  // pixels have their centres at whole numbers
  return out;
}

Result<PolarMap> polar_map_from_picture(const RadiancePicture& picture, const Lens& lens,
                                        const FlatField& flat, const PolarGrid& grid) {
  if (const Status status = check_sizes(picture, lens, flat); !status) return status.error();
  Sums sums{std::vector<double>(grid.size(), 0), std::vector<std::array<double, 3>>(grid.size())};
  std::vector<std::uint32_t> clipped(grid.size(), 0);
  std::array<std::vector<float>, 3> peak;
  for (auto& plane : peak) plane.assign(grid.size(), 0);
  std::uint32_t clipped_pixels = 0;
  bool any = false;
  Divider divider(lens, flat, grid);
  std::size_t pixel = 0;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x, ++pixel) {
      const double solid_angle = lens.pixel_solid_angle_sr(Vec2d(x, y));
      if (!(solid_angle > 1e-12)) continue;  // rounding at the border
      any = true;
      const float* rgb = &picture.rgb[3 * pixel];
      const std::size_t bin = divider.add(Vec2d(x, y), solid_angle, rgb, sums);
      if (bin == outside(grid)) continue;
      const double light = 1 / flat.transmission(std::min(lens.theta_rad(Vec2d(x, y)), lens.max_theta_rad));
      for (std::size_t c = 0; c < 3; ++c)
        peak[c][bin] = std::max(peak[c][bin], static_cast<float>(light * static_cast<double>(rgb[c])));
      if (picture.clipped.empty() || picture.clipped[pixel] == 0) continue;
      ++clipped[bin];
      ++clipped_pixels;
    }
  if (!any) return Error{ErrorKind::bad_input, "lens.center: no pixel of the image sees the field of view"};
  PolarMap map = map_of(sums, grid);
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t bin = 0; bin < grid.size(); ++bin)
      map.peak[c * grid.size() + bin] = std::max(peak[c][bin], map.radiance[c * grid.size() + bin]);
  for (std::size_t bin = 0; bin < grid.size(); ++bin)
    map.clipped[bin] = static_cast<std::uint16_t>(std::min<std::uint32_t>(65535, clipped[bin]));
  map.clipped_pixels = clipped_pixels;
  return map;
}

}  // namespace lightwell
