// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/dome.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace lightwell::render {
namespace {

// Nothing behind the eye has a place.
std::optional<Vec2f> project(const View& view, const Vec3f& point, int width, int height) {
  const Eigen::Vector4f clip = view.clip_from_world * point.homogeneous();
  if (!(clip.w() > 0)) return std::nullopt;
  const Vec2f ndc = clip.head<2>() / clip.w();
  if (!(ndc.cwiseAbs().maxCoeff() < 100)) return std::nullopt;  // far outside of the picture
  return Vec2f((ndc.x() + 1) / 2 * static_cast<float>(width), (1 - ndc.y()) / 2 * static_cast<float>(height));
}

float luminance(const Rgb& c) {
  return 0.2126f * c[0] + 0.7152f * c[1] + 0.0722f * c[2];
}

}  // namespace

std::vector<DomeMarker> dome_markers(std::span<const DirectionalLight> lights, const Sphere& dome,
                                     const View& view, int width, int height) {
  float total = 0;
  for (const DirectionalLight& light : lights) total += luminance(light.illuminance);
  std::vector<DomeMarker> markers;
  if (!(total > 0)) return markers;
  const float distance = (dome.centre - view.eye).norm();
  for (const DirectionalLight& light : lights) {
    const float share = luminance(light.illuminance) / total;
    if (!(share > 0)) continue;
    const Vec3f point = dome.centre + dome.radius * light.direction;
    const auto place = project(view, point, width, height);
    if (!place) continue;
    // All of the power in one light is a disc of a tenth of the picture's height.
    const float radius = static_cast<float>(height) / 20 * std::sqrt(share);
    markers.push_back({*place, radius, light.illuminance / light.illuminance.maxCoeff(),
                       (point - view.eye).norm() < distance});
  }
  std::stable_sort(markers.begin(), markers.end(),
                   [](const DomeMarker& a, const DomeMarker& b) { return a.radius_px < b.radius_px; });
  return markers;
}

std::vector<std::vector<Vec2f>> dome_lines(const Sphere& dome, const View& view, int width, int height) {
  std::vector<std::vector<Vec2f>> lines;
  constexpr int kSteps = 96;  // a turn; chords are within 0.05 % of the radius
  const auto draw = [&](int steps, auto direction) {
    std::vector<Vec2f> line;
    for (int i = 0; i <= steps; ++i) {
      const auto angle = static_cast<float>(2 * kPi * i / kSteps);
      const auto place = project(view, dome.centre + dome.radius * direction(angle), width, height);
      if (place) line.push_back(*place);
      if ((!place || i == steps) && line.size() > 1) lines.push_back(line);
      if (!place) line.clear();
    }
  };
  draw(kSteps, [](float a) { return Vec3f(std::sin(a), 0, std::cos(a)); });
  for (int k = 0; k < 4; ++k) {
    const auto azimuth = static_cast<float>(kPi * k / 4);
    draw(kSteps / 2, [=](float a) {
      return Vec3f(std::cos(a) * std::sin(azimuth), std::sin(a), std::cos(a) * std::cos(azimuth));
    });
  }
  return lines;
}

}  // namespace lightwell::render
