// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "calibration/photometric/flat_fit.h"
#include "daemon/simulator/probe_setup.h"
#include "lighting/flat_field.h"
#include "lighting/lens.h"
#include "lighting/response.h"

namespace lightwell::test {

// A sensor of its own, as MeanFrames: a take's mean is made without rendering its frames.
struct SyntheticSensor {
  Response response{LinearResponse{100, 2}, 12, 90, 4095, 10000};
  Lens lens;
  FlatField truth;
  double noise_codes = 1;
  std::uint64_t frames = 64;
  std::mt19937 random{3};

  explicit SyntheticSensor(int width, int height) {
    lens = simulator::default_lens(width, height);
    truth.image_size = lens.image_size;
    truth.vignetting = {-0.12, -0.01, 0};
  }
  // luminance of each pixel's direction
  calibration::MeanFrame mean(const std::function<double(const Vec3d&)>& luminance) {
    std::normal_distribution<double> normal;
    calibration::MeanFrame out;
    out.format = {lens.image_size[0], lens.image_size[1], PixelFormat::mono12};
    out.frames = frames;
    out.exposure_us = response.reference_exposure_us;
    for (int y = 0; y < out.format.height; ++y)
      for (int x = 0; x < out.format.width; ++x) {
        const std::size_t i = out.code.size();
        const double theta = std::min(lens.theta_rad(Vec2d(x, y)), lens.max_theta_rad);
        const double gain = truth.gain.empty() ? 1 : static_cast<double>(truth.gain[i]);
        const double offset = truth.offset_codes.empty() ? 0 : static_cast<double>(truth.offset_codes[i]);
        const double seen = gain * truth.transmission(theta) * luminance(lens.unproject(Vec2d(x, y)));
        out.code.push_back(response.code(seen) + offset +
                           noise_codes / std::sqrt(static_cast<double>(frames)) * normal(random));
        out.sigma.push_back(noise_codes);
      }
    return out;
  }
  calibration::MeanFrame even(double level) {
    return mean([=](const Vec3d&) { return level; });
  }
  void give_pattern(double columns, double offsets, double gains) {
    std::normal_distribution<double> normal;
    std::vector<double> column;
    for (int x = 0; x < lens.image_size[0]; ++x) column.push_back(columns * normal(random));
    truth.offset_codes.clear();
    truth.gain.clear();
    for (int i = 0; i < lens.image_size[0] * lens.image_size[1]; ++i) {
      truth.offset_codes.push_back(static_cast<float>(
          column[static_cast<std::size_t>(i % lens.image_size[0])] + offsets * normal(random)));
      if (gains > 0) truth.gain.push_back(static_cast<float>(std::exp(gains * normal(random))));
    }
  }
  // Root mean square of found / true gain − 1 within 80°.
  double gain_error(const FlatField& found) const {
    double square = 0, n = 0;
    for (std::size_t i = 0; i < truth.gain.size(); ++i) {
      const auto width = static_cast<std::size_t>(lens.image_size[0]);
      if (lens.theta_rad(Vec2d(static_cast<double>(i % width), static_cast<double>(i / width))) >
          80 * kPi / 180)
        continue;
      square += std::pow(static_cast<double>(found.gain[i] / truth.gain[i]) - 1, 2);
      ++n;
    }
    return std::sqrt(square / n);
  }
};

// A room with structure on every scale: nothing even in it.
inline double room(const Vec3d& d) {
  return 400 * (1 + 0.5 * std::sin(3 * d.x() + 1) + 0.3 * std::sin(5 * d.y()) * std::cos(4 * d.z()) +
                (d.x() > 0.3 && d.y() < 0.2 ? 0.6 : 0));
}

inline std::vector<calibration::FlatTake> turned_takes(SyntheticSensor& sensor,
                                                       const std::vector<double>& angles, const Vec3d& axis) {
  std::vector<calibration::FlatTake> takes;
  for (const double angle : angles) {
    const Eigen::Matrix3d scene_from_camera = Eigen::AngleAxisd(angle * kPi / 180, axis).toRotationMatrix();
    takes.push_back({"turned " + std::to_string(angle),
                     sensor.mean([&](const Vec3d& d) { return room(scene_from_camera * d); })});
  }
  return takes;
}

}  // namespace lightwell::test
