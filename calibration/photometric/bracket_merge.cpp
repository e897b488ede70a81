// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/photometric/bracket_merge.h"

#include <algorithm>
#include <array>

namespace lightwell::calibration {
namespace {

// As it was when it was read: the same bytes.
JpegPicture full_size(const Photograph& photograph) {
  auto picture = decode_jpeg(*photograph.jpeg, photograph.file);
  verify_bug(picture.ok(), "a photograph that was read cannot be read again");
  return *std::move(picture);
}

// Radiance of the channels of all pixels, at full size.
class Merge {
 public:
  Merge(const std::vector<Photograph>& photographs, const Response& response)
      : luminance_(luminance_table(response)), reference_s_(response.reference_exposure_us * 1e-6) {
    const auto by_time = [](const Photograph& a, const Photograph& b) { return a.exposure_s < b.exposure_s; };
    const auto [shortest, longest] = std::minmax_element(photographs.begin(), photographs.end(), by_time);
    shortest_s_ = shortest->exposure_s;
    longest_s_ = longest->exposure_s;
    for (const Photograph& photograph : photographs) {
      const JpegPicture picture = full_size(photograph);
      channels_.resize(picture.rgb.size());
      for (std::size_t i = 0; i < channels_.size(); ++i)
        channels_[i].add(picture.rgb[i], luminance_, photograph.exposure_s);
    }
    in_shortest_ = full_size(*shortest).rgb;
    in_longest_ = full_size(*longest).rgb;
  }

  [[nodiscard]] bool clipped(std::size_t i) const {
    return !(channels_[i].seconds > 0) && in_shortest_[i] >= kClippedCode;
  }
  // Nowhere between the ends: clipped even in the shortest, dark even in the longest, or neither of both.
  [[nodiscard]] double luminance_cd_m2(std::size_t i) const {
    if (channels_[i].seconds > 0) return channels_[i].luminance_cd_m2(reference_s_);
    if (clipped(i)) return luminance_[kClippedCode] * reference_s_ / shortest_s_;
    return in_longest_[i] > 0 ? luminance_[in_longest_[i]] * reference_s_ / longest_s_ : 0;
  }

 private:
  std::vector<double> luminance_;  // of every code at the reference exposure
  double reference_s_;
  double shortest_s_ = 0, longest_s_ = 0;
  std::vector<MergedChannel> channels_;
  std::vector<std::uint8_t> in_shortest_, in_longest_;
};

}  // namespace

std::vector<double> luminance_table(const Response& response) {
  std::vector<double> table;
  for (int z = 0; z < 256; ++z) table.push_back(std::max(0.0, response.luminance_cd_m2(z)));
  return table;
}

RadiancePicture merge_brackets(const std::vector<Photograph>& photographs, const Response& response,
                               int shrink) {
  const Merge merge(photographs, response);
  const int width = photographs[0].full_width, height = photographs[0].full_height;
  RadiancePicture out{(width + shrink - 1) / shrink, (height + shrink - 1) / shrink, {}, {}};
  for (int top = 0; top < height; top += shrink)
    for (int left = 0; left < width; left += shrink) {
      const int right = std::min(left + shrink, width), bottom = std::min(top + shrink, height);
      std::array<double, 3> sum{};
      bool clipped = false;
      for (int y = top; y < bottom; ++y)
        for (int x = left; x < right; ++x)
          for (std::size_t c = 0; c < 3; ++c) {
            const std::size_t i = 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                                       static_cast<std::size_t>(x)) +
                                  c;
            sum[c] += merge.luminance_cd_m2(i);
            clipped = clipped || merge.clipped(i);
          }
      for (const double s : sum) out.rgb.push_back(static_cast<float>(s / ((right - left) * (bottom - top))));
      out.clipped.push_back(clipped ? 1 : 0);
    }
  return out;
}

}  // namespace lightwell::calibration
