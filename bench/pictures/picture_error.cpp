// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "bench/pictures/picture_error.h"

#include <algorithm>
#include <cmath>

namespace lightwell::pictures {

std::vector<Rgb> colours_of(const render::RadiancePicture& picture) {
  std::vector<Rgb> colours;
  colours.reserve(picture.rgba.size() / 4);
  for (std::size_t i = 0; i < picture.rgba.size(); i += 4)
    colours.emplace_back(picture.rgba[i], picture.rgba[i + 1], picture.rgba[i + 2]);
  return colours;
}

Reference reference_of(const render::RadiancePicture& picture) {
  Reference reference{picture.width, picture.height, colours_of(picture), {}};
  const auto covered = [&](int x, int y) {
    return x >= 0 && y >= 0 && x < picture.width && y < picture.height &&
           picture.rgba[4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width) +
                             static_cast<std::size_t>(x)) +
                        3] == 1;
  };
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      bool all = true;
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) all = all && covered(x + dx, y + dy);
      reference.mask.push_back(all ? 1 : 0);
    }
  return reference;
}

LinearPicture displayed(const std::vector<Rgb>& radiance, const Reference& as) {
  constexpr double kKey = 0.18;
  double logs = 0;
  double count = 0;
  double largest = 0;
  for (std::size_t i = 0; i < as.radiance.size(); ++i) {
    const double value = static_cast<double>(luminance(as.radiance[i]));
    if (as.mask[i] == 0 || !(value > 0)) continue;
    logs += std::log(value);
    largest = std::max(largest, value);
    ++count;
  }
  const double exposure = count > 0 ? kKey / std::exp(logs / count) : 1;
  const double white = std::max(largest * exposure, 1e-6);
  LinearPicture shown{as.width, as.height, {}};
  shown.pixels.reserve(radiance.size());
  for (const Rgb& colour : radiance) {
    const double scaled = exposure * std::max(static_cast<double>(luminance(colour)), 0.0);
    const double factor = exposure * (1 + scaled / (white * white)) / (1 + scaled);
    shown.pixels.push_back((colour * static_cast<float>(factor)).cwiseMax(0.0f).cwiseMin(1.0f));
  }
  return shown;
}

PictureError picture_error(const std::vector<Rgb>& colours, const Reference& reference) {
  const std::vector<float> visible =
      flip(displayed(reference.radiance, reference), displayed(colours, reference));
  double squares = 0, reference_squares = 0, sum = 0, reference_sum = 0, flips = 0, count = 0;
  for (std::size_t i = 0; i < colours.size(); ++i) {
    if (reference.mask[i] == 0) continue;
    const Rgbd expected = reference.radiance[i].cast<double>();
    const Rgbd difference = colours[i].cast<double>() - expected;
    squares += difference.square().sum();
    reference_squares += expected.square().sum();
    sum += difference.sum();
    reference_sum += expected.sum();
    flips += static_cast<double>(visible[i]);
    ++count;
  }
  return {std::sqrt(squares / reference_squares), sum / reference_sum, flips / count};
}

}  // namespace lightwell::pictures
