// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "bench/pictures/flip.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

namespace lightwell::pictures {
namespace {

// CIE XYZ of linear Rec. 709, and its inverse; white is (1, 1, 1).
const Eigen::Matrix3f kXyzFromRgb = (Eigen::Matrix3f() << 0.41238656f, 0.35759149f, 0.18045049f,  //
                                     0.21263682f, 0.71518298f, 0.07218020f,                       //
                                     0.01933062f, 0.11919716f, 0.95037259f)
                                        .finished();
const Eigen::Matrix3f kRgbFromXyz = kXyzFromRgb.inverse();
const Rgb kWhite = (kXyzFromRgb * Vec3f::Ones()).array();

// YCxCz (section 4.1.1): CIE Lab without its curve, so that filters act on light.
Rgb opponent_from_rgb(const Rgb& rgb) {
  const Rgb p = (kXyzFromRgb * rgb.matrix()).array() / kWhite;
  return {116 * p[1] - 16, 500 * (p[0] - p[1]), 200 * (p[1] - p[2])};
}
Rgb rgb_from_opponent(const Rgb& c) {
  const float y = (c[0] + 16) / 116;
  const Rgb p(y + c[1] / 500, y, y - c[2] / 200);
  return (kRgbFromXyz * (p * kWhite).matrix()).array();
}

// L*a*b* with chroma scaled by lightness (Hunt effect, section 4.1.3).
Rgb hunt_from_rgb(const Rgb& rgb) {
  constexpr float delta = 6.0f / 29;
  const auto curve = [](float t) {
    return t > delta * delta * delta ? std::cbrt(t) : t / (3 * delta * delta) + 4.0f / 29;
  };
  const Rgb p = ((kXyzFromRgb * rgb.matrix()).array() / kWhite).unaryExpr(curve);
  const float lightness = 116 * p[1] - 16;
  return {lightness, 0.01f * lightness * 500 * (p[0] - p[1]), 0.01f * lightness * 200 * (p[1] - p[2])};
}

float hyab(const Rgb& a, const Rgb& b) {
  return std::abs(a[0] - b[0]) + std::hypot(a[1] - b[1], a[2] - b[2]);
}

// A sum of products of kernels along x and y; edges are repeated.
using Kernel = std::vector<float>;
Kernel kernel(int radius, const std::function<double(double)>& value) {
  Kernel k;
  for (int i = -radius; i <= radius; ++i) k.push_back(static_cast<float>(value(i)));
  return k;
}

std::vector<float> filtered(const std::vector<float>& plane, int width, int height, const Kernel& along_x,
                            const Kernel& along_y) {
  const int radius = static_cast<int>(along_x.size() / 2);
  const auto at = [&](int x, int y) {
    return static_cast<std::size_t>(std::clamp(y, 0, height - 1)) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(std::clamp(x, 0, width - 1));
  };
  std::vector<float> rows(plane.size());
  std::vector<float> out(plane.size());
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      float sum = 0;
      for (int i = -radius; i <= radius; ++i)
        sum += along_x[static_cast<std::size_t>(i + radius)] * plane[at(x + i, y)];
      rows[at(x, y)] = sum;
    }
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      float sum = 0;
      for (int i = -radius; i <= radius; ++i)
        sum += along_y[static_cast<std::size_t>(i + radius)] * rows[at(x, y + i)];
      out[at(x, y)] = sum;
    }
  return out;
}

using Planes = std::array<std::vector<float>, 3>;

Planes planes_of(const LinearPicture& picture) {
  Planes planes;
  for (const Rgb& pixel : picture.pixels) {
    const Rgb c = opponent_from_rgb(pixel);
    for (std::size_t i = 0; i < 3; ++i) planes[i].push_back(c[static_cast<int>(i)]);
  }
  return planes;
}

// Contrast sensitivity as sums of two Gaussians a √(π/b) exp(−π² r² / b), r in degrees (table 1).
struct Gaussian {
  double a, b;
};
constexpr Gaussian kSensitivity[3][2] = {
    {{1, 0.0047}, {0, 1e-5}}, {{1, 0.0053}, {0, 1e-5}}, {{34.1, 0.04}, {13.5, 0.025}}};

// What of the planes an eye resolves, in the space that colours are compared in.
std::vector<Rgb> seen(const Planes& planes, int width, int height, double pixels_per_degree) {
  constexpr double kWidest = 0.04;
  const int radius =
      static_cast<int>(std::ceil(3 * std::sqrt(kWidest / (2 * kPi * kPi)) * pixels_per_degree));
  Planes out;
  for (std::size_t c = 0; c < 3; ++c) {
    out[c].assign(planes[c].size(), 0.0f);
    double total = 0;
    for (const Gaussian& g : kSensitivity[c]) {
      if (g.a == 0) continue;
      const Kernel k =
          kernel(radius, [&](double i) { return std::exp(-std::pow(kPi * i / pixels_per_degree, 2) / g.b); });
      double sum = 0;
      for (const float v : k) sum += static_cast<double>(v);
      const double weight = g.a * std::sqrt(kPi / g.b);
      total += weight * sum * sum;
      const std::vector<float> part = filtered(planes[c], width, height, k, k);
      for (std::size_t i = 0; i < part.size(); ++i) out[c][i] += static_cast<float>(weight) * part[i];
    }
    for (float& v : out[c]) v /= static_cast<float>(total);
  }
  std::vector<Rgb> colours;
  for (std::size_t i = 0; i < out[0].size(); ++i)
    colours.push_back(
        hunt_from_rgb(rgb_from_opponent({out[0][i], out[1][i], out[2][i]}).cwiseMax(0.0f).cwiseMin(1.0f)));
  return colours;
}

// Strength of edges and of points in the lightness (section 4.2): first and second derivatives of a Gaussian, each
// scaled so that its positive and its negative weights sum to 1 and −1.
struct Features {
  std::vector<float> edges, points;
};
Features features(const Planes& planes, int width, int height, double pixels_per_degree) {
  constexpr double kFeatureWidth_deg = 0.082;
  const double deviation = 0.5 * kFeatureWidth_deg * pixels_per_degree;
  const int radius = static_cast<int>(std::ceil(3 * deviation));
  const auto bell = [&](double i) { return std::exp(-i * i / (2 * deviation * deviation)); };
  const Kernel across = kernel(radius, bell);
  const auto derivative = [&](const std::function<double(double)>& factor) {
    Kernel k = kernel(radius, [&](double i) { return factor(i) * bell(i); });
    float other = 0, positive = 0, negative = 0;
    for (const float v : across) other += v;
    for (const float v : k) (v > 0 ? positive : negative) += std::abs(v);
    for (float& v : k) v /= other * (v > 0 ? positive : negative);
    return k;
  };
  std::vector<float> lightness;
  for (const float y : planes[0]) lightness.push_back((y + 16) / 116);
  const auto strength = [&](const Kernel& k) {
    std::vector<float> x = filtered(lightness, width, height, k, across);
    const std::vector<float> y = filtered(lightness, width, height, across, k);
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = std::hypot(x[i], y[i]);
    return x;
  };
  return {strength(derivative([](double i) { return -i; })),
          strength(derivative([&](double i) { return i * i / (deviation * deviation) - 1; }))};
}

// Colour errors to [0, 1]: most of the range for those below pc of the largest (section 4.1.4).
float redistributed(float error, float largest) {
  constexpr float kKnee = 0.4f, kAtKnee = 0.95f;
  const float knee = kKnee * largest;
  return error < knee ? error * kAtKnee / knee : kAtKnee + (error - knee) / (largest - knee) * (1 - kAtKnee);
}

}  // namespace

std::vector<float> flip(const LinearPicture& reference, const LinearPicture& picture,
                        double pixels_per_degree) {
  constexpr float kColourExponent = 0.7f;
  const int width = reference.width;
  const int height = reference.height;
  const Planes a = planes_of(reference);
  const Planes b = planes_of(picture);
  const std::vector<Rgb> seen_a = seen(a, width, height, pixels_per_degree);
  const std::vector<Rgb> seen_b = seen(b, width, height, pixels_per_degree);
  const Features features_a = features(a, width, height, pixels_per_degree);
  const Features features_b = features(b, width, height, pixels_per_degree);
  const float largest = std::pow(hyab(hunt_from_rgb({0, 1, 0}), hunt_from_rgb({0, 0, 1})), kColourExponent);
  std::vector<float> error;
  for (std::size_t i = 0; i < seen_a.size(); ++i) {
    const float colour = redistributed(std::pow(hyab(seen_a[i], seen_b[i]), kColourExponent), largest);
    const float feature = std::max(std::abs(features_a.edges[i] - features_b.edges[i]),
                                   std::abs(features_a.points[i] - features_b.points[i]));
    error.push_back(std::pow(colour, 1 - std::sqrt(std::min(feature / std::sqrt(2.0f), 1.0f))));
  }
  return error;
}

}  // namespace lightwell::pictures
