// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/detection/saddles.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "lighting/direction.h"

namespace lightwell::calibration {
namespace {

constexpr float kSigma = 1.5f;  // of the blur, px: below a third of the smallest check
constexpr float kRadius = 4;    // of the ring on which quadrants are told, px
constexpr float kLeastContrast =
    12;                              // codes: boards in a fisheye's dim border, above the noise of eight bits
constexpr std::size_t kMost = 4000;  // bounds the time spent on foliage and noise

struct Derivatives {
  cv::Mat x, y, xx, yy, xy;
};

Derivatives derivatives(const cv::Mat& smooth) {
  Derivatives d;
  cv::Sobel(smooth, d.x, CV_32F, 1, 0, 3, 0.125);
  cv::Sobel(smooth, d.y, CV_32F, 0, 1, 3, 0.125);
  cv::Sobel(smooth, d.xx, CV_32F, 2, 0, 3, 0.25);
  cv::Sobel(smooth, d.yy, CV_32F, 0, 2, 3, 0.25);
  cv::Sobel(smooth, d.xy, CV_32F, 1, 1, 3, 0.25);
  return d;
}

// Where the slope is zero near a pixel, at most one away.
cv::Point2f level_place(const Derivatives& d, cv::Point pixel) {
  const float xx = d.xx.at<float>(pixel), yy = d.yy.at<float>(pixel), xy = d.xy.at<float>(pixel);
  const float x = d.x.at<float>(pixel), y = d.y.at<float>(pixel);
  const float determinant = xx * yy - xy * xy;
  const cv::Point2f step((xy * y - yy * x) / determinant, (xy * x - xx * y) / determinant);
  return cv::Point2f(pixel) + cv::Point2f(std::clamp(step.x, -1.f, 1.f), std::clamp(step.y, -1.f, 1.f));
}

float between(const cv::Mat& smooth, cv::Point2f p) {
  const int x = static_cast<int>(p.x), y = static_cast<int>(p.y);
  const float a = p.x - static_cast<float>(x), b = p.y - static_cast<float>(y);
  const auto* upper = smooth.ptr<float>(y) + x;
  const auto* lower = smooth.ptr<float>(y + 1) + x;
  return (1 - b) * ((1 - a) * upper[0] + a * upper[1]) + b * ((1 - a) * lower[0] + a * lower[1]);
}

// Where light and dark meet around a place, four times.
struct Ring {
  std::array<float, 4> angle{};  // growing, rad
  bool light_after_first = false;
  float contrast = 0;
};

std::optional<Ring> ring_around(const cv::Mat& smooth, cv::Point2f p, float radius) {
  constexpr std::size_t kSamples = 24;
  std::array<float, kSamples> light{};
  float least = 255, most = 0;
  for (std::size_t i = 0; i < kSamples; ++i) {
    const auto angle = static_cast<float>(2 * kPi * static_cast<double>(i) / kSamples);
    light[i] = between(smooth, p + radius * cv::Point2f(std::cos(angle), std::sin(angle)));
    least = std::min(least, light[i]);
    most = std::max(most, light[i]);
  }
  Ring out;
  out.contrast = most - least;
  const float middle = (least + most) / 2;
  std::size_t changes = 0;
  for (std::size_t i = 0; i < kSamples; ++i) {
    const float here = light[i] - middle, next = light[(i + 1) % kSamples] - middle;
    if ((here > 0) == (next > 0)) continue;
    if (changes == 4) return {};
    if (changes == 0) out.light_after_first = next > 0;
    out.angle[changes++] =
        static_cast<float>(2 * kPi / kSamples) * (static_cast<float>(i) + here / (here - next));
  }
  if (changes != 4) return {};
  return out;
}

// Whether one of the ring's edges goes along an angle, with light on the same side.
bool has_edge(const Ring& ring, float angle, bool light_after, float most_off) {
  for (std::size_t k = 0; k < 4; ++k) {
    const auto off = static_cast<float>(std::remainder(ring.angle[k] - angle, 2 * kPi));
    if (std::abs(off) < most_off && (ring.light_after_first == (k % 2 == 0)) == light_after) return true;
  }
  return false;
}

// A saddle's edges start at it and go straight: opposite ones are opposite, and near the place they have the
// directions they have farther off. The sides of a stripe have not.
std::optional<Saddle> saddle_at(const cv::Mat& smooth, cv::Point2f p) {
  const auto ring = ring_around(smooth, p, kRadius);
  if (!ring || ring->contrast < kLeastContrast) return {};
  // A lens bends and perspective turns edges, both little over a check: 0.6 rad, 34 degrees.
  constexpr float kMostBend = 0.6f;
  for (std::size_t k = 0; k < 2; ++k)
    if (std::abs(ring->angle[k + 2] - ring->angle[k] - static_cast<float>(kPi)) > kMostBend) return {};
  // Half a radius off, half a pixel of the place's own error turns an edge by 0.25 rad.
  constexpr float kMostTurn = 0.4f;
  const auto near = ring_around(smooth, p, kRadius / 2);
  if (!near) return {};
  Saddle out;
  for (std::size_t k = 0; k < 4; ++k) {
    if (!has_edge(*near, ring->angle[k], ring->light_after_first == (k % 2 == 0), kMostTurn)) return {};
    out.edge[k] = {std::cos(ring->angle[k]), std::sin(ring->angle[k])};
  }
  out.pixel = p;
  out.contrast = ring->contrast;
  out.light_after_first = ring->light_after_first;
  return out;
}

}  // namespace

std::vector<Saddle> find_saddles(const cv::Mat& grey) {
  cv::Mat smooth;
  grey.convertTo(smooth, CV_32F);
  cv::GaussianBlur(smooth, smooth, {}, kSigma);
  const Derivatives d = derivatives(smooth);
  const cv::Mat saddle = d.xy.mul(d.xy) - d.xx.mul(d.yy);  // C / (π σ²) squared at a corner of four checks
  cv::Mat largest;
  cv::dilate(saddle, largest, cv::Mat::ones(5, 5, CV_8U));
  // A quarter of the strength an ideal corner of the least contrast has: one of unequal or slanted quadrants has less.
  const auto ideal = static_cast<float>(kLeastContrast / (kPi * kSigma * kSigma));
  const float least = ideal * ideal / 4;
  std::vector<std::pair<float, cv::Point>> places;
  constexpr int kBorder = static_cast<int>(kRadius) + 2;
  for (int y = kBorder; y < grey.rows - kBorder; ++y)
    for (int x = kBorder; x < grey.cols - kBorder; ++x)
      if (const float s = saddle.at<float>(y, x); s > least && s == largest.at<float>(y, x))
        places.emplace_back(s, cv::Point(x, y));
  std::sort(places.begin(), places.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<Saddle> out;
  for (const auto& [s, place] : places) {
    if (const auto found = saddle_at(smooth, level_place(d, place))) out.push_back(*found);
    if (out.size() == kMost) break;
  }
  return out;
}

}  // namespace lightwell::calibration
