// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/luminaire/screen_view.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <opencv2/calib3d.hpp>

namespace lightwell::calibration {
namespace {

using Eigen::Matrix3d;

// Between a picture's pixels and those of a camera without distortion, with the lens's focal length on the axis.
class Undistortion {
 public:
  explicit Undistortion(const std::optional<Lens>& lens) : lens_(lens) {}

  // No numbers where the lens does not see it, or not in front of the camera.
  [[nodiscard]] Vec2d straight(const Vec2d& pixel) const {
    if (!lens_) return pixel;
    const Vec3d ray = lens_->unproject(pixel);
    constexpr double kLeastDepth = 0.05;  // 87 degrees off the axis: a plane that far out has no use
    if (!(ray.z() > kLeastDepth) || lens_->theta_rad(pixel) > lens_->max_theta_rad)
      return Vec2d::Constant(std::nan(""));
    return lens_->focal.cwiseProduct(ray.head<2>() / ray.z());
  }
  [[nodiscard]] Vec2d bent(const Vec2d& straight) const {
    if (!lens_) return straight;
    const Vec2d m = straight.cwiseQuotient(lens_->focal);
    return lens_->project({m.x(), m.y(), 1});
  }

 private:
  const std::optional<Lens>& lens_;
};

Vec2d mapped(const Matrix3d& m, const Vec2d& p) {
  const Vec3d h = m * p.homogeneous();
  return h.head<2>() / h.z();
}

Error bad(const std::string& file, const std::string& what) {
  return {ErrorKind::bad_input, file + ": " + what};
}

struct Fitted {
  Matrix3d straight_from_screen;
  double rms_px = 0;
};

Result<Fitted> fit_marks(const Rig& rig, const Undistortion& lens, const std::string& file) {
  std::vector<cv::Point2d> screen, picture;
  for (std::size_t i = 0; i < rig.marks.size(); ++i) {
    const Vec2d at = lens.straight(rig.marks[i].pixel);
    if (!at.allFinite()) {
      char what[120];
      std::snprintf(what, sizeof what, "mark %zu: pixel = %g, %g: the lens does not see so far out", i + 1,
                    rig.marks[i].pixel.x(), rig.marks[i].pixel.y());
      return bad(file, what);
    }
    screen.emplace_back(rig.marks[i].screen_m.x(), rig.marks[i].screen_m.y());
    picture.emplace_back(at.x(), at.y());
  }
  Fitted out;
  const cv::Mat found = cv::findHomography(screen, picture, 0);
  const auto useless = [&] {
    return bad(file, "the marks do not fix how the screen is seen, allowed: four, no three on a line");
  };
  if (found.rows != 3 || found.cols != 3) return useless();
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) out.straight_from_screen(r, c) = found.at<double>(r, c);
  const Matrix3d back = out.straight_from_screen.inverse();
  if (!back.allFinite()) return useless();
  double extent = 0;  // of the marks on the screen
  for (const Rig::Mark& mark : rig.marks)
    extent = std::max(extent, (mark.screen_m - rig.marks[0].screen_m).norm());
  std::size_t worst = 0;
  double worst_px = -1, squares = 0;
  for (std::size_t i = 0; i < rig.marks.size(); ++i) {
    const Vec2d at = mapped(out.straight_from_screen, rig.marks[i].screen_m);
    constexpr double kClosure = 1e-6;  // there and back: a matrix that folds the screen does not come back
    if (!((mapped(back, at) - rig.marks[i].screen_m).norm() <= kClosure * extent)) return useless();
    const double error = (lens.bent(at) - rig.marks[i].pixel).norm();
    squares += error * error;
    if (!(error <= worst_px)) {
      worst_px = error;
      worst = i;
    }
  }
  if (!(worst_px <= rig.most_mark_error_px)) {
    char what[160];
    std::snprintf(what, sizeof what, "mark %zu: %.2f pixels from where the others put it, allowed: up to %g",
                  worst + 1, worst_px, rig.most_mark_error_px);
    return bad(file, what);
  }
  out.rms_px = std::sqrt(squares / static_cast<double>(rig.marks.size()));
  return out;
}

}  // namespace

Result<ScreenView> ScreenView::create(const Rig& rig, const std::optional<Lens>& lens,
                                      const std::array<int, 2>& size, const std::string& file) {
  ScreenView view;
  view.width_ = size[0];
  const Undistortion undistortion(lens);
  Matrix3d screen_from_straight = Matrix3d::Identity();
  double side = 1;  // of the horizon that marks lie on
  if (rig.edges) {
    const Vec2d pixel = (rig.edges->last_m - rig.edges->first_m).cwiseQuotient(Vec2d(size[0], size[1]));
    screen_from_straight.topLeftCorner<2, 2>() = pixel.asDiagonal();
    screen_from_straight.topRightCorner<2, 1>() = rig.edges->first_m + pixel / 2;
  } else {
    const auto fitted = fit_marks(rig, undistortion, file);
    if (!fitted) return fitted.error();
    view.mark_rms_px_ = fitted->rms_px;
    screen_from_straight = fitted->straight_from_screen.inverse();
    side = (screen_from_straight * undistortion.straight(rig.marks[0].pixel).homogeneous()).z();
  }
  view.corners_.reserve(static_cast<std::size_t>(size[0] + 1) * static_cast<std::size_t>(size[1] + 1));
  for (int y = 0; y <= size[1]; ++y)
    for (int x = 0; x <= size[0]; ++x) {
      const Vec2d pixel(x - 0.5, y - 0.5);
      // Pictures with edges of their own are straight already.
      const Vec2d at = rig.edges ? pixel : undistortion.straight(pixel);
      const Vec3d h = screen_from_straight * at.homogeneous();
      view.corners_.push_back(h.z() / side > 0 ? Vec2d(h.head<2>() / h.z()) : Vec2d::Constant(std::nan("")));
    }
  return view;
}

}  // namespace lightwell::calibration
