// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/detection/guided_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>

#include "calibration/detection/board_corners.h"
#include "calibration/detection/corner_refinement.h"
#include "calibration/lens/lens_adjustment.h"
#include "calibration/lens/lens_start.h"
#include "calibration/lens/target_pose.h"
#include "lighting/lens.h"

namespace lightwell::calibration {
namespace {

// A corner in a picture: its place and where the board's axes go there.
struct SeenCorner {
  cv::Point2f pixel, x, y;  // x, y: along the smallest quadrant's sides, px
  // How far the nearest other thing on the board is.
  [[nodiscard]] double room_px() const {
    return std::min({cv::norm(x), cv::norm(y), cv::norm(x + y), cv::norm(x - y)});
  }
};

// How much lighter the first colour is than the second: the least of it around the corner. Negative where the second
// is lighter; about 0 where the quadrants do not alternate.
float contrast_of(const cv::Mat& grey, const SeenCorner& corner, bool first_colour) {
  // Between the edges' blur and the far side of the narrowest quadrant: a border of one bit is 0.4 of it.
  constexpr float kOff = 0.3f;
  const auto code = [&](float a, float b) {
    return code_at(grey, corner.pixel + kOff * (a * corner.x + b * corner.y));
  };
  const auto [low, high] = std::minmax({code(1, 1), code(-1, -1)});
  const auto [other_low, other_high] = std::minmax({code(1, -1), code(-1, 1)});
  const float lighter = low - other_high, darker = other_low - high;
  const float most = lighter > 0 ? lighter : darker > 0 ? -darker : 0;
  return first_colour ? most : -most;
}

class Expectation {
 public:
  Expectation(const cv::Mat& grey, const Board& board, const Lens& lens, const TargetPose& pose,
              const std::vector<Correspondence>& found)
      : grey_(grey),
        lens_(lens),
        rotation_(pose.camera_from_target()),
        translation_(pose.translation_mm),
        quadrant_mm_(quadrant_mm(board)),
        found_(found) {
    errors_.reserve(found.size());
    for (const Correspondence& p : found) errors_.push_back(p.pixel - projected(p.target_mm));
  }

  // Of a place on the board, its own small error aside; nothing beyond the field or the picture.
  [[nodiscard]] std::optional<SeenCorner> seen(const Vec3d& target_mm, const Vec2d& pixel) const {
    const Vec3d eye = rotation_ * target_mm + translation_;
    if (std::atan2(eye.head<2>().norm(), eye.z()) > lens_.max_theta_rad) return {};
    const Vec2d x = (projected(target_mm + Vec3d(quadrant_mm_, 0, 0)) -
                     projected(target_mm - Vec3d(quadrant_mm_, 0, 0))) /
                    2,
                y = (projected(target_mm + Vec3d(0, quadrant_mm_, 0)) -
                     projected(target_mm - Vec3d(0, quadrant_mm_, 0))) /
                    2;
    const double margin = 3 + 0.5 * (x.norm() + y.norm());
    if (!(pixel.minCoeff() > margin && pixel.x() < grey_.cols - 1 - margin &&
          pixel.y() < grey_.rows - 1 - margin))
      return {};
    const auto point = [](const Vec2d& v) {
      return cv::Point2f(static_cast<float>(v.x()), static_cast<float>(v.y()));
    };
    return SeenCorner{point(pixel), point(x), point(y)};
  }

  // Where the lens puts it, and as far off as it is off for the corners nearby.
  [[nodiscard]] Vec2d expected(const Vec3d& target_mm) const {
    Vec2d sum(0, 0);
    double weights = 0;
    for (std::size_t i = 0; i < found_.size(); ++i) {
      const double way = (found_[i].target_mm - target_mm).norm() / quadrant_mm_;
      const double weight = 1 / (1 + way * way * way * way);
      sum += weight * errors_[i];
      weights += weight;
    }
    return projected(target_mm) + sum / weights;
  }

 private:
  [[nodiscard]] Vec2d projected(const Vec3d& target_mm) const {
    return lens_.project(rotation_ * target_mm + translation_);
  }

  const cv::Mat& grey_;
  const Lens& lens_;
  Eigen::Matrix3d rotation_;
  Vec3d translation_;
  double quadrant_mm_;
  const std::vector<Correspondence>& found_;
  std::vector<Vec2d> errors_;
};

const Correspondence& nearest(const std::vector<Correspondence>& found, const Vec3d& target_mm) {
  return *std::min_element(found.begin(), found.end(), [&](const auto& a, const auto& b) {
    return (a.target_mm - target_mm).squaredNorm() < (b.target_mm - target_mm).squaredNorm();
  });
}

// The place that edges and quadrants bear out, near where the corner is expected.
// contrast: of the first colour to the second, at a corner nearby
std::optional<Vec2d> borne_out(const cv::Mat& grey, SeenCorner corner, bool first_colour, float contrast) {
  constexpr double kLeastRoom =
      3.5;  // px: at 0.3 of it, a pixel's blur still lets the quadrants be told apart
  if (corner.room_px() < kLeastRoom) return {};
  const auto place = meeting_point(grey, corner.pixel, corner.room_px());
  // The next saddle is a quadrant's diagonal away.
  if (!place || cv::norm(*place - corner.pixel) > std::max(1.0, 0.4 * corner.room_px())) return {};
  corner.pixel = *place;
  constexpr float kLeast = 0.35f;  // a fisheye's border is dim and blurred
  if (!(contrast_of(grey, corner, first_colour) * (contrast > 0 ? 1.f : -1.f) > kLeast * std::abs(contrast)))
    return {};
  return Vec2d(place->x, place->y);
}

bool rows_fall(const Board& board, const std::vector<Correspondence>& found) {
  return std::any_of(found.begin(), found.end(),
                     [&](const Correspondence& p) { return p.target_mm.y() < -board.pitch_mm / 4; });
}

// Corners that the picture shows where the lens puts them, no further than reach_mm from one that was found.
// found: at least one; pose: of the board, from them
std::vector<Correspondence> corners_where_expected(const cv::Mat& grey, const Board& board, const Lens& lens,
                                                   const TargetPose& pose,
                                                   const std::vector<Correspondence>& found,
                                                   double reach_mm) {
  const Expectation expectation(grey, board, lens, pose, found);
  std::vector<BoardCorner> corners = corners_of(board, rows_fall(board, found));
  const double same_place_mm = quadrant_mm(board) / 4;
  // Contrast of the corners that were found, by place.
  std::vector<float> contrasts;
  for (const Correspondence& p : found) {
    const auto corner = std::find_if(corners.begin(), corners.end(), [&](const BoardCorner& c) {
      return (c.target_mm - p.target_mm).norm() < same_place_mm;
    });
    const auto seen = corner == corners.end() ? std::nullopt : expectation.seen(p.target_mm, p.pixel);
    contrasts.push_back(seen ? contrast_of(grey, *seen, corner->first_colour) : 0);
  }
  const float sum = std::accumulate(contrasts.begin(), contrasts.end(), 0.f);
  std::vector<Correspondence> out;
  for (const BoardCorner& corner : corners) {
    const Correspondence& neighbour = nearest(found, corner.target_mm);
    const double way = (neighbour.target_mm - corner.target_mm).norm();
    if (way < same_place_mm || way > reach_mm) continue;
    const auto seen = expectation.seen(corner.target_mm, expectation.expected(corner.target_mm));
    if (!seen) continue;
    const float contrast = contrasts[static_cast<std::size_t>(&neighbour - found.data())];
    if (!(contrast * sum > 0)) continue;  // a neighbour that is none
    if (const auto pixel = borne_out(grey, *seen, corner.first_colour, contrast))
      out.push_back({corner.target_mm, *pixel});
  }
  return out;
}

}  // namespace

std::vector<Correspondence> with_neighbours(const cv::Mat& grey, const Board& board,
                                            std::vector<Correspondence> found) {
  constexpr std::size_t kFewest = 4, kForDistortion = 24, kForCenter = 60;  // points
  if (found.size() < kFewest) return found;
  const std::vector<Lens> starts = lens_starts({{grey.cols, grey.rows}, {{"", found}}}, 1);
  if (starts.empty()) return found;
  Lens lens = starts.front();
  const auto pose = robust_pose(lens, found);
  if (!pose) return found;
  std::vector<PosedView> view = {{*pose, {}}};
  // Across a gap or a check, and aslant.
  const double reach_mm = 1.5 * (board.kind == BoardKind::aprilgrid ? board.marker_mm : board.pitch_mm);
  const int most_rounds = board.columns + board.rows;
  for (int round = 0; round < most_rounds; ++round) {
    view[0].points = found;
    const int coefficients = found.size() < kForDistortion ? 0 : found.size() < kForCenter ? 1 : 2;
    // A pixel: what a guess of a lens is off, and a wrong corner is more.
    if (!(adjust(lens, view, {{coefficients, false, found.size() >= kForCenter}, 1, 20, 1e-6}) >= 0)) break;
    const auto more = corners_where_expected(grey, board, lens, view[0].pose, found, reach_mm);
    if (more.empty()) break;
    found.insert(found.end(), more.begin(), more.end());
  }
  return found;
}

}  // namespace lightwell::calibration
