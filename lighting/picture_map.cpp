// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/picture_map.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "lighting/field_error.h"
#include "lighting/orientation.h"

namespace lightwell {
namespace {

// Parts of pixels in a bin, spread so that no outline runs along a row of them: the area of a bin of so many is off by
// some √(4 √512 / 12) of them, half a percent.
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
    for (int i = 0; i < along * along; ++i) add_part(pixel + next_part());
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
  // Martin Roberts' sequence R2: 1/g and 1/g² where g³ = g + 1. It goes on from pixel to pixel.
  Vec2d next_part() {
    part_ += Vec2d(0.7548776662466927, 0.5698402909980532);
    part_ -= part_.array().floor().matrix();
    return part_ - Vec2d(0.5, 0.5);
  }
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
    const double theta = lens_.max_theta_rad, off_axis = centre.head<2>().norm();
    // On the axis itself the border is as near on all sides.
    const Vec2d away = off_axis > 0 ? Vec2d(centre.head<2>() / off_axis) : Vec2d::UnitX();
    const Vec3d border(std::sin(theta) * away.x(), std::sin(theta) * away.y(), std::cos(theta));
    bins_.push_back(bin_of(grid_, world_from_camera_ * border));
    light_.push_back(1 / flat_.transmission(theta));
  }

  const Lens& lens_;
  const FlatField& flat_;
  const PolarGrid& grid_;
  Eigen::Matrix3d world_from_camera_;
  Vec2d part_ = Vec2d(0.5, 0.5);
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

// Whether a bin lies in the field and the picture with all of its outline.
class Inside {
 public:
  Inside(const Lens& lens, const PolarGrid& grid)
      : lens_(lens), grid_(grid), camera_from_world_(world_from_camera_rotation(lens.zenith).transpose()) {}

  [[nodiscard]] bool operator()(int ring, int sector) const {
    const Vec3d centre = camera_from_world_ * grid_.bin_direction(ring, sector);
    double radius = 0;
    for (const double r : {0.0, 0.5, 1.0})
      for (const double s : {0.0, 0.5, 1.0}) {
        const Vec3d d =
            camera_from_world_ * direction_from_spherical({grid_.theta_max_rad * (ring + r) / grid_.rings,
                                                           2 * kPi * (sector + s) / grid_.sectors});
        radius = std::max(radius, std::atan2(centre.cross(d).norm(), centre.dot(d)));
        if (off_axis(d) > lens_.max_theta_rad || !in_picture(lens_.project(d))) return false;
      }
    return off_axis(centre) + radius <= lens_.max_theta_rad;
  }

 private:
  static double off_axis(const Vec3d& d) { return std::atan2(d.head<2>().norm(), d.z()); }
  [[nodiscard]] bool in_picture(const Vec2d& p) const {
    return p.x() >= -0.5 && p.y() >= -0.5 && p.x() <= lens_.image_size[0] - 0.5 &&
           p.y() <= lens_.image_size[1] - 0.5;
  }
  const Lens& lens_;
  const PolarGrid& grid_;
  Eigen::Matrix3d camera_from_world_;
};

PolarMap map_of(const Sums& sums, const Lens& lens, const PolarGrid& grid) {
  PolarMap map = PolarMap::make(grid, 3);
  const Inside inside(lens, grid);
  double measured_sr = 0;
  std::size_t bin = 0;
  for (int ring = 0; ring < grid.rings; ++ring)
    for (int sector = 0; sector < grid.sectors; ++sector, ++bin) {
      const double received_sr = sums.solid_angle_sr[bin];
      measured_sr += received_sr;
      // A bin that was all seen keeps its own solid angle: what the division of pixels errs by is no light.
      if (!(received_sr > 0 && inside(ring, sector)))
        map.solid_angle_sr[bin] = static_cast<float>(received_sr);
      for (int c = 0; c < 3; ++c)
        map.plane(c)[bin] =
            received_sr > 0 ? static_cast<float>(sums.flux[bin][static_cast<std::size_t>(c)] / received_sr)
                            : 0.0F;
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
  PolarMap map = map_of(sums, lens, grid);
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t bin = 0; bin < grid.size(); ++bin)
      map.peak[c * grid.size() + bin] = std::max(peak[c][bin], map.radiance[c * grid.size() + bin]);
  for (std::size_t bin = 0; bin < grid.size(); ++bin)
    map.clipped[bin] = static_cast<std::uint16_t>(std::min<std::uint32_t>(65535, clipped[bin]));
  map.clipped_pixels = clipped_pixels;
  return map;
}

}  // namespace lightwell
