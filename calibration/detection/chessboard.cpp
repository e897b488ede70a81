// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/detection/chessboard.h"

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "calibration/detection/corner_grid.h"
#include "lighting/median.h"

namespace lightwell::calibration {
namespace {

cv::Mat scaled(const cv::Mat& grey, double scale) {
  if (scale == 1) return grey;
  cv::Mat out;
  cv::resize(grey, out, {}, scale, scale, scale < 1 ? cv::INTER_AREA : cv::INTER_CUBIC);
  return out;
}

// At a width of about 700 px, where a check is some 10 px wide.
cv::Mat overview(const cv::Mat& grey) {
  return scaled(grey, std::min(1.0, 700.0 / std::max(grey.cols, grey.rows)));
}

float at(const cv::Mat& grey, cv::Point2f p) {
  const int x = std::clamp(cvRound(p.x), 0, grey.cols - 1), y = std::clamp(cvRound(p.y), 0, grey.rows - 1);
  return grey.at<std::uint8_t>(y, x);
}

// How much the four quadrants between two axes look like checks: 2 × contrast for a corner of four, 0 for an edge,
// for the corner of one dark square on white, and for nothing.
float checks(const cv::Mat& grey, cv::Point2f p, cv::Point2f a, cv::Point2f b) {
  const float q0 = at(grey, p + a + b), q1 = at(grey, p - a + b), q2 = at(grey, p - a - b),
              q3 = at(grey, p + a - b);
  return std::abs(q0 + q2 - q1 - q3) - std::abs(q0 - q2) - std::abs(q1 - q3);
}

bool inside(const cv::Mat& grey, cv::Point2f p) {
  return p.x >= 0 && p.y >= 0 && p.x <= static_cast<float>(grey.cols - 1) &&
         p.y <= static_cast<float>(grey.rows - 1);
}

// A row of corners at the border, the row inside of it, and whether the picture shows both of each pair.
struct Border {
  std::vector<cv::Point2f> outer, inner;
  std::vector<bool> seen;
};

bool has_row_beyond(const cv::Mat& grey, const Border& border) {
  std::size_t seen = 0, found = 0;
  for (std::size_t i = 0; i < border.outer.size(); ++i) {
    if (!border.seen[i]) continue;
    const cv::Point2f out = border.outer[i] - border.inner[i];
    const cv::Point2f along = i + 1 < border.outer.size() ? border.outer[i + 1] - border.outer[i]
                                                          : border.outer[i] - border.outer[i - 1];
    const float here = checks(grey, border.outer[i], 0.3f * out, 0.3f * along);
    if (here <= 0 || !inside(grey, border.outer[i] + 1.3f * out)) continue;
    float best = 0;
    // The next row is about a step away: fisheyes shrink it, near boards stretch it.
    for (const float step : {0.7f, 0.8f, 0.9f, 1.0f, 1.1f})
      for (const float side : {-0.1f, 0.f, 0.1f})
        best = std::max(
            best, checks(grey, border.outer[i] + step * out + side * along, 0.25f * out, 0.25f * along));
    ++seen;
    found += best > 0.5f * here;
  }
  return seen >= 2 && 5 * found >= 4 * seen;
}

// Way from a corner to the next, half of them are shorter.
double median_check_px(const CornerGrid& grid) {
  std::vector<double> ways;
  for (const auto& [place, corner] : grid.corners)
    if (const auto next = grid.corners.find({place.first + 1, place.second}); next != grid.corners.end())
      ways.push_back(cv::norm(next->second.pixel - corner.pixel));
  return median(std::move(ways));
}

// OpenCV's two searches, at several scales. They find boards of which a corner of the grid is missed, but take minutes
// on noise: only for pictures with checks.
std::vector<cv::Point2f> search_by_quads(const cv::Mat& grey, cv::Size size, double check_px) {
  std::vector<cv::Point2f> corners;
  const auto in_picture = [&](double scale) {
    const cv::Point2f half(0.5f, 0.5f);
    for (auto& p : corners) p = (p + half) / scale - half;
    return corners;
  };
  constexpr double kSmall = 12;  // px: checks that a larger picture shows better
  for (const double factor : {1.0, 0.5, 0.75, 1.5, 2.0}) {
    if (factor > 1 && check_px > kSmall) continue;
    if (cv::findChessboardCorners(scaled(grey, factor), size, corners,
                                  cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE))
      return in_picture(factor);
  }
  for (const double factor : {0.5, 0.75})
    if (cv::findChessboardCornersSB(
            scaled(grey, factor), size, corners,
            cv::CALIB_CB_EXHAUSTIVE | cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_ACCURACY))
      return in_picture(factor);
  return {};
}

// Corners of a whole rectangle are of another board where they are more than were asked for, or the checks end with
// them.
std::optional<std::pair<int, int>> other_board(const cv::Mat& grey, const CornerGrid& grid, int columns,
                                               int rows) {
  const auto size = size_of_grid(grid);
  if (!size) return {};
  const auto asked = std::minmax(columns, rows), seen = std::minmax(size->first, size->second);
  if (asked == seen) return {};
  if (seen.first >= asked.first && seen.second >= asked.second) return size;
  for (const auto& [c, r] : {*size, std::pair(size->second, size->first)})
    if (const BoardGrid board = board_of_grid(grid, c, r); !board.corners.empty())
      return goes_on(grey, board.corners, board.seen, c, r) ? std::nullopt : size;
  return {};
}

}  // namespace

ChessboardSearch find_chessboard(const cv::Mat& grey, int columns, int rows) {
  const double base = std::min(1.0, 1400.0 / std::max(grey.cols, grey.rows));
  const cv::Mat sized = scaled(grey, base);
  ChessboardSearch out;
  BoardGrid most;  // of its corners are seen
  const auto seen = [](const BoardGrid& board) {
    return std::count(board.seen.begin(), board.seen.end(), true);
  };
  int cells = 0;
  double check_px = 0;
  bool nearly_whole = false;
  // A fisheye's dim and blurred border asks for a small picture, a far board for a large one.
  for (const double factor : {0.5, 1.0, 0.25, 2.0}) {
    const CornerGrid grid = largest_corner_grid(sized, factor);
    // Boards, hidden ones too, have a cell for most corners; by chance there are chains of corners.
    if (3 * static_cast<std::size_t>(grid.cells) >= grid.corners.size() && grid.cells > cells) {
      cells = grid.cells;
      check_px = median_check_px(grid);
    }
    if (BoardGrid board = board_of_grid(grid, columns, rows); seen(board) > seen(most))
      most = std::move(board);
    if (seen(most) == columns * rows) break;
    nearly_whole = nearly_whole || is_nearly(grid, columns, rows);
    if (!out.other_size) out.other_size = other_board(sized, grid, columns, rows);
  }
  if (!most.corners.empty()) out.other_size.reset();
  out.shows_checks = cells >= std::clamp((columns - 1) * (rows - 1) / 3, 2, 20);
  out.corners = std::move(most.corners);
  out.seen = std::move(most.seen);
  if (out.corners.empty() && out.shows_checks && nearly_whole && !out.other_size) {
    out.corners = search_by_quads(sized, {columns, rows}, check_px);
    out.seen.assign(out.corners.size(), true);
  }
  // The centre of pixel (0, 0) is the origin at every scale.
  const cv::Point2f half(0.5f, 0.5f);
  for (auto& p : out.corners) p = (p + half) / base - half;
  return out;
}

bool goes_on(const cv::Mat& grey, const std::vector<cv::Point2f>& corners, const std::vector<bool>& seen,
             int columns, int rows) {
  Border borders[4];
  const auto add = [&](Border& border, int r, int c, int inner_r, int inner_c) {
    const auto outer = static_cast<std::size_t>(r * columns + c),
               inner = static_cast<std::size_t>(inner_r * columns + inner_c);
    border.outer.push_back(corners[outer]);
    border.inner.push_back(corners[inner]);
    border.seen.push_back(seen[outer] && seen[inner]);
  };
  for (int c = 0; c < columns; ++c) {
    add(borders[0], 0, c, 1, c);
    add(borders[1], rows - 1, c, rows - 2, c);
  }
  for (int r = 0; r < rows; ++r) {
    add(borders[2], r, 0, r, 1);
    add(borders[3], r, columns - 1, r, columns - 2);
  }
  return std::any_of(std::begin(borders), std::end(borders),
                     [&](const Border& b) { return has_row_beyond(grey, b); });
}

bool is_sharp_and_bright(const cv::Mat& grey) {
  const cv::Mat small = overview(grey);
  double darkest = 0, brightest = 0;
  cv::minMaxLoc(small, &darkest, &brightest);
  constexpr double kLeastContrast = 64;  // a quarter of what eight bits hold
  if (brightest - darkest < kLeastContrast) return false;
  // The rise over two pixels is 2 / (√2π σ) of an edge blurred by σ: a quarter of the contrast at 3 px, where checks
  // of 10 px begin to run together. In so many places that no reflection or speck of dust decides.
  constexpr double kLeastRise = 0.25, kLeastPart = 0.002;
  std::size_t sharp = 0;
  for (int y = 1; y + 1 < small.rows; ++y)
    for (int x = 1; x + 1 < small.cols; ++x) {
      const double across = small.at<std::uint8_t>(y, x + 1) - small.at<std::uint8_t>(y, x - 1);
      const double down = small.at<std::uint8_t>(y + 1, x) - small.at<std::uint8_t>(y - 1, x);
      sharp += std::hypot(across, down) > kLeastRise * (brightest - darkest);
    }
  return static_cast<double>(sharp) > kLeastPart * static_cast<double>(small.total());
}

}  // namespace lightwell::calibration
