// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/simulator/projector.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "lighting/direction.h"

namespace lightwell::simulator {
namespace {

// In half widths of the tent. n rays to one leave a pattern on an even sky of at most 2/(π n)² an axis; with
// the margin in scatter n is about 4.5, the pattern 1 %: two codes, and nothing in sum.
constexpr double kRaySpacing = 1.0 / 4;
// Of a disc that moves, every frame: the sunflower's rays are spread more evenly than a grid meets pixels.
constexpr double kDiscSpacing = 1.0 / 2;

// RGGB: 0 red, 1 green, 2 blue.
int bayer_channel(int x, int y) {
  return (x & 1) + (y & 1);
}

// Part of a pixel inside the field, from 8 × 8 points.
float part_inside(const Lens& lens, int x, int y) {
  int inside = 0;
  for (int j = 0; j < 8; ++j)
    for (int i = 0; i < 8; ++i)
      inside += lens.theta_rad({x - 0.5 + (i + 0.5) / 8, y - 0.5 + (j + 0.5) / 8}) <= lens.max_theta_rad;
  return static_cast<float>(std::max(inside, 1)) / 64;
}

}  // namespace

Projector::Projector(const Lens& lens, bool bayer)
    : lens_(lens),
      camera_from_world_(world_from_camera_rotation(lens.zenith).transpose()),
      level_(lens.zenith == Vec3d::UnitZ()),
      bayer_(bayer) {
  const int width = lens.image_size[0], height = lens.image_size[1];
  solid_angle_sr_.reserve(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  inside_.reserve(solid_angle_sr_.capacity());
  double sum = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const double omega = lens.pixel_solid_angle_sr({x, y});
      sum += omega;
      solid_angle_sr_.push_back(static_cast<float>(omega));
      if (omega <= 0) {
        inside_.push_back(0);
        continue;
      }
      bool whole = true;
      for (const double dx : {-0.5, 0.5})
        for (const double dy : {-0.5, 0.5})
          whole = whole && lens.theta_rad({x + dx, y + dy}) <= lens.max_theta_rad;
      inside_.push_back(whole ? 1.0f : part_inside(lens, x, y));
    }
  const double cap = 2 * kPi * (1 - std::cos(lens.max_theta_rad));
  whole_field_ = std::abs(sum / cap - 1) < 1e-3;
}

double Projector::channel(const Rgbd& colour, int x, int y) const {
  return bayer_ ? colour[bayer_channel(x, y)] : luminance(colour);
}

void Projector::add_at(const Vec2d& p, const Rgbd& illuminance, std::span<float> plane) const {
  const int width = lens_.image_size[0], height = lens_.image_size[1];
  const double px = std::floor(p.x() + 0.5), py = std::floor(p.y() + 0.5);
  if (!(px >= 0 && px < width && py >= 0 && py < height)) return;  // the sensor does not reach there
  const int step = bayer_ ? 2 : 1;
  for (int oy = 0; oy < step; ++oy)
    for (int ox = 0; ox < step; ++ox) {
      const double u = (p.x() - ox) / step, v = (p.y() - oy) / step;
      const int i0 = static_cast<int>(std::floor(u)), j0 = static_cast<int>(std::floor(v));
      const double fu = u - i0, fv = v - j0;
      struct {
        std::size_t index;
        double weight;
        int x, y;
      } tap[4];
      int taps = 0;
      double sum = 0;
      for (int k = 0; k < 4; ++k) {
        const int x = ox + step * (i0 + (k & 1)), y = oy + step * (j0 + (k >> 1));
        if (x < 0 || x >= width || y < 0 || y >= height) continue;
        const std::size_t index =
            static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
        const double weight = ((k & 1) != 0 ? fu : 1 - fu) * ((k >> 1) != 0 ? fv : 1 - fv) *
                              static_cast<double>(inside_[index]);
        if (weight <= 0) continue;
        tap[taps++] = {index, weight, x, y};
        sum += weight;
      }
      for (int k = 0; k < taps; ++k) {
        const double energy = channel(illuminance, tap[k].x, tap[k].y) * tap[k].weight / sum;
        plane[tap[k].index] +=
            static_cast<float>(energy / (step * step * static_cast<double>(solid_angle_sr_[tap[k].index])));
      }
    }
}

void Projector::add_ray(const Vec3d& direction, const Rgbd& illuminance, std::span<float> plane) const {
  const Vec3d d = camera_from_world_ * direction;
  if (std::atan2(std::hypot(d.x(), d.y()), d.z()) > lens_.max_theta_rad) return;
  add_at(lens_.project(d), illuminance, plane);
}

void Projector::add_disc(const DiscLight& light, std::span<float> plane) const {
  const double radius_px = light.angular_radius_rad * lens_.focal.maxCoeff();
  const double spacing = kDiscSpacing * (bayer_ ? 2 : 1);
  // At least 64 rays: a small disc at the horizon is cut by them.
  const int count =
      static_cast<int>(std::clamp(kPi * radius_px * radius_px / (spacing * spacing), 64.0, 1e5));
  for (const Vec3d& d : disc_samples(light, count)) add_ray(d, light.illuminance / count, plane);
}

std::vector<float> Projector::project(const Layer& layer) const {
  return layer.smooth ? interpolate(layer.image) : scatter(layer.image);
}

const std::vector<Projector::Taps>& Projector::taps(int width, int height) const {
  if (taps_width_ == width && taps_height_ == height) return taps_;
  taps_.assign(pixels(), {});
  // Rows below the border of a level camera's field are not looked at: a scene may end there.
  const double lowest = level_ ? lens_.max_theta_rad : kPi;
  const int last_row =
      std::clamp(static_cast<int>(std::ceil(lowest / kPi * height - 1e-9)) - 1, 0, height - 1);
  std::size_t i = 0;
  for (int y = 0; y < lens_.image_size[1]; ++y)
    for (int x = 0; x < lens_.image_size[0]; ++x, ++i) {
      if (solid_angle_sr_[i] <= 0) continue;
      const Vec2d uv = lat_long_from_direction(camera_from_world_.transpose() * lens_.unproject({x, y}));
      const double column = uv.x() * width - 0.5 + width,
                   row = std::clamp(uv.y() * height - 0.5, 0.0, static_cast<double>(last_row));
      const int x0 = static_cast<int>(column), y0 = static_cast<int>(row);
      Taps& t = taps_[i];
      const auto base = static_cast<std::uint32_t>(y0 * width);
      t.cell[0] = base + static_cast<std::uint32_t>(x0 % width);
      t.cell[1] = base + static_cast<std::uint32_t>((x0 + 1) % width);
      t.down = y0 < last_row ? static_cast<std::uint32_t>(width) : 0;
      t.u = static_cast<float>(column - x0);
      t.v = static_cast<float>(row - y0);
    }
  taps_width_ = width;
  taps_height_ = height;
  return taps_;
}

std::vector<float> Projector::interpolate(const LatLongImage& image) const {
  const std::vector<Taps>& table = taps(image.width, image.height);
  // One plane of the image a channel: a quarter of the memory traffic of reading colours.
  const int channels = bayer_ ? 3 : 1;
  std::array<std::vector<float>, 3> source;
  for (int c = 0; c < channels; ++c) {
    auto& s = source[static_cast<std::size_t>(c)];
    s.reserve(image.pixels.size());
    for (const Rgb& p : image.pixels) s.push_back(bayer_ ? p[c] : luminance(p));
  }
  std::vector<float> plane(pixels(), 0.0f);
  std::array<double, 3> sum{};
  std::size_t i = 0;
  for (int y = 0; y < lens_.image_size[1]; ++y)
    for (int x = 0; x < lens_.image_size[0]; ++x, ++i) {
      if (solid_angle_sr_[i] <= 0) continue;
      const auto c = static_cast<std::size_t>(bayer_ ? bayer_channel(x, y) : 0);
      const float* s = source[c].data();
      const Taps& t = table[i];
      const float top = s[t.cell[0]] + t.u * (s[t.cell[1]] - s[t.cell[0]]);
      const float bottom = s[t.cell[0] + t.down] + t.u * (s[t.cell[1] + t.down] - s[t.cell[0] + t.down]);
      plane[i] = top + t.v * (bottom - top);
      sum[c] += static_cast<double>(plane[i] * solid_angle_sr_[i]);
    }
  if (!whole_field_ || !level_) return plane;
  const Rgbd exact = cap_illuminance(image, lens_.max_theta_rad);
  std::array<float, 3> scale = {1, 1, 1};
  for (int c = 0; c < channels; ++c) {
    const auto k = static_cast<std::size_t>(c);
    const double sites =
        bayer_ ? (c == 1 ? 2 : 4) : 1;  // each green site stands for half a quad, the others for one
    const double wanted = bayer_ ? exact[c] : luminance(exact);
    if (sum[k] > 0) scale[k] = static_cast<float>(wanted / (sites * sum[k]));
  }
  i = 0;
  for (int y = 0; y < lens_.image_size[1]; ++y)
    for (int x = 0; x < lens_.image_size[0]; ++x, ++i)
      plane[i] *= scale[static_cast<std::size_t>(bayer_ ? bayer_channel(x, y) : 0)];
  return plane;
}

std::vector<float> Projector::scatter(const LatLongImage& image) const {
  std::vector<float> plane(pixels(), 0.0f);
  const double spacing = kRaySpacing * (bayer_ ? 2 : 1);
  const double focal = 1.2 * lens_.focal.maxCoeff();  // the distortion stretches by less than that
  const double lowest = level_ ? lens_.max_theta_rad : kPi;
  for (int y = 0; y < image.height && kPi * y / image.height < lowest; ++y) {
    const double top = kPi * y / image.height;
    const double height = std::min(kPi * (y + 1) / image.height, lowest) - top;
    const int down = std::max(1, static_cast<int>(std::ceil(height * focal / spacing)));
    const double column = 2 * kPi / image.width;
    const int across = std::max(1, static_cast<int>(std::ceil(column * focal * (top + height) / spacing)));
    // Sine and cosine of every ray's azimuth in this row: λ = π − column · (x + part).
    std::vector<Vec2d> azimuth(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(across));
    for (std::size_t i = 0; i < azimuth.size(); ++i) {
      const double lambda = kPi - column * (static_cast<double>(i) + 0.5) / across;
      azimuth[i] = {std::sin(lambda), std::cos(lambda)};
    }
    for (int j = 0; j < down; ++j) {
      const double a = top + height * j / down, b = top + height * (j + 1) / down;
      const double omega = 2 * std::sin((a + b) / 2) * std::sin((b - a) / 2) * column / across;
      const double theta = (a + b) / 2;
      // The lens is symmetric about its axis: for a level camera one projection a ring, turned to every azimuth.
      const double distance =
          (lens_.project({std::sin(theta), 0, std::cos(theta)}) - lens_.center).x() / lens_.focal.x();
      for (std::size_t i = 0; i < azimuth.size(); ++i) {
        const Rgb& radiance = image.at(static_cast<int>(i / static_cast<std::size_t>(across)), y);
        if ((radiance <= 0).all()) continue;
        if (!level_) {
          add_ray({std::sin(theta) * azimuth[i].x(), std::cos(theta), std::sin(theta) * azimuth[i].y()},
                  omega * radiance.cast<double>(), plane);
          continue;
        }
        // Camera frame: x is world x = sin λ, y is −world z = −cos λ.
        const Vec2d p =
            lens_.center + distance * lens_.focal.cwiseProduct(Vec2d(azimuth[i].x(), -azimuth[i].y()));
        add_at(p, omega * radiance.cast<double>(), plane);
      }
    }
  }
  return plane;
}

}  // namespace lightwell::simulator
