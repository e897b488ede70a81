// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/detection/april_tags.h"

#include <apriltag/apriltag.h>
#include <apriltag/tag36h11.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <opencv2/imgproc.hpp>

namespace lightwell::calibration {
namespace {

template <auto release>
struct Release {
  template <class T>
  void operator()(T* object) const {
    release(object);
  }
};
using Family = std::unique_ptr<apriltag_family_t, Release<tag36h11_destroy>>;
using Detector = std::unique_ptr<apriltag_detector_t, Release<apriltag_detector_destroy>>;
using Detections = std::unique_ptr<zarray_t, Release<apriltag_detections_destroy>>;

// The library's tags have a border of one bit.
Family family_with_border(int border_bits) {
  Family out(tag36h11_create());
  const int more = border_bits - 1;
  out->width_at_border += 2 * more;
  out->total_width += 2 * more;
  for (std::uint32_t i = 0; i < out->nbits; ++i) {
    out->bit_x[i] += static_cast<std::uint32_t>(more);
    out->bit_y[i] += static_cast<std::uint32_t>(more);
  }
  return out;
}

// Moves the sides outward.
void widen(double px, AprilTag& tag) {
  const cv::Point2f middle = centre(tag);
  const auto factor = static_cast<float>(1 + 2 * px / side_px(tag));
  for (cv::Point2f& corner : tag.corners) corner = middle + factor * (corner - middle);
}

// Finds tags of either border.
class TagReader {
 public:
  TagReader() {
    detector_->quad_decimate = 1;
    detector_->refine_edges = true;
    for (const Family& family : families_)
      apriltag_detector_add_family_bits(detector_.get(), family.get(), kCorrected);
  }

  // By border, one bit first.
  // scale: of the picture that is read to `grey`; widened: what white is widened by there on all sides, px. A blurred
  // corner of four checks is grey and joins its black ones, so that a tag would hang together with a square.
  [[nodiscard]] std::array<std::vector<AprilTag>, 2> read(const cv::Mat& grey, double scale,
                                                          int widened) const {
    cv::Mat picture = grey.clone();
    if (scale != 1) cv::resize(grey, picture, {}, scale, scale, scale < 1 ? cv::INTER_AREA : cv::INTER_CUBIC);
    const int across = 2 * widened + 1;
    cv::dilate(picture, picture, cv::Mat::ones(across, across, CV_8U));
    image_u8_t image{picture.cols, picture.rows, picture.cols, picture.data};
    const Detections found(apriltag_detector_detect(detector_.get(), &image));
    std::array<std::vector<AprilTag>, 2> out;
    for (int i = 0; i < zarray_size(found.get()); ++i) {
      const apriltag_detection_t* tag = nullptr;
      zarray_get(found.get(), i, static_cast<void*>(&tag));
      AprilTag& to = out[tag->family == families_[1].get()].emplace_back();
      to.id = tag->id;
      // The library goes round the other way, and has the centre of the first pixel at (0.5, 0.5).
      for (std::size_t c = 0; c < 4; ++c)
        to.corners[c] = cv::Point2f(static_cast<float>(tag->p[3 - c][0] / scale - 0.5),
                                    static_cast<float>(tag->p[3 - c][1] / scale - 0.5));
      widen(widened / scale, to);
    }
    return out;
  }

 private:
  static constexpr int kCorrected = 2;  // bits, of a distance of 11 between any two tags

  Family families_[2] = {family_with_border(1), family_with_border(2)};
  Detector detector_{apriltag_detector_create()};  // goes before its families
};

using TagsById = std::map<int, std::vector<AprilTag>>;  // the places at which each is seen

// Takes what a scale shows at places where the scales before showed nothing.
void add(const std::vector<AprilTag>& tags, TagsById& out) {
  for (const AprilTag& tag : tags) {
    std::vector<AprilTag>& places = out[tag.id];
    if (std::none_of(places.begin(), places.end(), [&](const AprilTag& other) {
          return cv::norm(centre(tag) - centre(other)) < side_px(other) / 2;
        }))
      places.push_back(tag);
  }
}

// The library takes some 20 bytes a pixel.
constexpr double kMostPixels = 32e6;

}  // namespace

double side_px(const AprilTag& tag) {
  double sum = 0;
  for (std::size_t c = 0; c < 4; ++c) sum += cv::norm(tag.corners[(c + 1) % 4] - tag.corners[c]);
  return sum / 4;
}

cv::Point2f centre(const AprilTag& tag) {
  return (tag.corners[0] + tag.corners[1] + tag.corners[2] + tag.corners[3]) / 4;
}

AprilTags find_april_tags(const cv::Mat& grey, int count) {
  const TagReader reader;
  std::array<TagsById, 2> seen;
  const auto look = [&](double scale, int widened) {
    const auto tags = reader.read(grey, scale, widened);
    for (std::size_t b = 0; b < 2; ++b) add(tags[b], seen[b]);
  };
  const auto pixels = static_cast<double>(grey.total());
  look(std::min(1.0, std::sqrt(kMostPixels / pixels)), 1);
  AprilTags out;
  out.at_twice_its_size = 4 * pixels <= kMostPixels;
  if (out.at_twice_its_size) look(2, 1);  // small tags, whose bits a pixel more of white would close
  for (const auto& [id, places] : seen[seen[1].size() >= seen[0].size()])
    if (id >= count)
      out.beyond.push_back(id);
    else if (places.size() > 1)
      out.twice.push_back(id);
    else
      out.tags.push_back(places.front());
  return out;
}

}  // namespace lightwell::calibration
