// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <opencv2/calib3d.hpp>

#include "bench/lens_peers.h"

namespace lightwell::bench {

SolvedLens solve_opencv(const calibration::TargetViews& views, bool recompute_extrinsics) {
  std::vector<std::vector<cv::Point3d>> targets;
  std::vector<std::vector<cv::Point2d>> pixels;
  for (const calibration::TargetView& view : views.views) {
    targets.emplace_back();
    pixels.emplace_back();
    for (const calibration::Correspondence& p : view.points) {
      targets.back().emplace_back(p.target_mm.x(), p.target_mm.y(), p.target_mm.z());
      pixels.back().emplace_back(p.pixel.x(), p.pixel.y());
    }
  }
  cv::Mat matrix, coefficients;
  std::vector<cv::Mat> rotations, translations;
  const int flags =
      cv::fisheye::CALIB_FIX_SKEW | (recompute_extrinsics ? cv::fisheye::CALIB_RECOMPUTE_EXTRINSIC : 0);
  SolvedLens out;
  try {
    cv::fisheye::calibrate(targets, pixels, {views.image_size[0], views.image_size[1]}, matrix, coefficients,
                           rotations, translations, flags,
                           {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 100, 1e-10});
  } catch (const cv::Exception& refusal) {
    out.refused = refusal.err;
    return out;
  }
  Lens lens;
  lens.image_size = views.image_size;
  lens.focal = {matrix.at<double>(0, 0), matrix.at<double>(1, 1)};
  lens.center = {matrix.at<double>(0, 2), matrix.at<double>(1, 2)};
  for (int i = 0; i < 4; ++i) lens.k[static_cast<std::size_t>(i)] = coefficients.at<double>(i);
  out.project = [lens](const Vec3d& direction) { return lens.project(direction); };
  const auto vector3 = [](const cv::Mat& m) {
    return Vec3d(m.at<double>(0), m.at<double>(1), m.at<double>(2));
  };
  for (std::size_t v = 0; v < rotations.size(); ++v)
    out.poses.push_back({vector3(rotations[v]), vector3(translations[v])});
  return out;
}

}  // namespace lightwell::bench
