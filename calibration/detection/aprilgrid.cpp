// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/detection/aprilgrid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "calibration/detection/april_tags.h"
#include "calibration/detection/chessboard.h"

namespace lightwell::calibration {
namespace {

using TagsById = std::map<int, AprilTag>;

// How the tags lie on the grid: which corner is the first along a row, and whether rows follow each other the way
// the corners go on, or against it. Votes of neighbours.
struct GridLayout {
  std::size_t first_corner = 0;
  int row_direction = 1;
};

// The corner from which a tag's sides go along a row, by its neighbour there.
std::size_t first_corner(const AprilTag& tag, const AprilTag& next) {
  const cv::Point2f along = centre(next) - centre(tag);
  std::size_t best = 0;
  float most = -1;
  for (std::size_t c = 0; c < 4; ++c) {
    const cv::Point2f side = tag.corners[(c + 1) % 4] - tag.corners[c];
    if (side.dot(along) > most) {
      most = side.dot(along);
      best = c;
    }
  }
  return best;
}

std::optional<GridLayout> layout_of(const TagsById& tags, int columns) {
  std::array<int, 4> first{};
  for (const auto& [id, tag] : tags)
    if (const auto next = tags.find(id + 1); next != tags.end() && next->first % columns != 0)
      ++first[first_corner(tag, next->second)];
  const auto most = std::max_element(first.begin(), first.end());
  if (*most == 0) return {};
  GridLayout out;
  out.first_corner = static_cast<std::size_t>(most - first.begin());
  int direction = 0;
  for (const auto& [id, tag] : tags) {
    const auto next = tags.find(id + columns);
    if (next == tags.end()) continue;
    const cv::Point2f down =
        tag.corners[(out.first_corner + 2) % 4] - tag.corners[(out.first_corner + 1) % 4];
    direction += down.dot(centre(next->second) - centre(tag)) > 0 ? 1 : -1;
  }
  if (direction == 0) return {};
  out.row_direction = direction > 0 ? 1 : -1;
  return out;
}

// Places on the board by tag, in its layout.
class Grid {
 public:
  Grid(const Board& board, GridLayout layout) : board_(board), layout_(layout) {}

  // mm, of corners clockwise from the layout's first
  [[nodiscard]] std::array<cv::Point2d, 4> corners(int id) const {
    const double x = board_.pitch_mm * (id % board_.columns),
                 y = layout_.row_direction * board_.pitch_mm * (id / board_.columns), side = board_.marker_mm;
    return {cv::Point2d(x, y), {x + side, y}, {x + side, y + side}, {x, y + side}};
  }
  // In the picture, in the same order.
  [[nodiscard]] std::array<cv::Point2f, 4> seen(const AprilTag& tag) const {
    std::array<cv::Point2f, 4> out;
    for (std::size_t c = 0; c < 4; ++c) out[c] = tag.corners[(layout_.first_corner + c) % 4];
    return out;
  }
  // From the board to the picture, near a tag.
  [[nodiscard]] cv::Matx33d picture_from_board(const AprilTag& tag) const {
    const auto from = corners(tag.id);
    const auto to = seen(tag);
    std::array<cv::Point2f, 4> places;
    std::copy(from.begin(), from.end(), places.begin());
    return cv::getPerspectiveTransform(places.data(), to.data());
  }
  // Whether two neighbours have each other where they are.
  [[nodiscard]] bool agree(const AprilTag& a, const AprilTag& b) const {
    constexpr double kMostOff = 0.3;  // pitches a step: what a lens bends; a wrong tag is a pitch off
    return off(a, b) < kMostOff && off(b, a) < kMostOff;
  }
  [[nodiscard]] bool are_neighbours(int a, int b) const {
    const int columns = board_.columns;
    return a != b && std::abs(a % columns - b % columns) <= 1 && std::abs(a / columns - b / columns) <= 1;
  }

 private:
  // Of the second's centre from where the first has it, pitches.
  [[nodiscard]] double off(const AprilTag& a, const AprilTag& b) const {
    const auto to = corners(b.id);
    const cv::Point2d place = (to[0] + to[2]) / 2;
    const cv::Vec3d p = picture_from_board(a) * cv::Vec3d(place.x, place.y, 1);
    if (!(p[2] > 0)) return std::numeric_limits<double>::max();
    const double pitch_px = side_px(a) * board_.pitch_mm / board_.marker_mm;
    return cv::norm(cv::Point2d(p[0] / p[2], p[1] / p[2]) - cv::Point2d(centre(b))) / pitch_px;
  }

  Board board_;
  GridLayout layout_;
};

// Whether a tag's neighbours bear it out; one with none of them may be anything.
bool is_in_place(const AprilTag& tag, const TagsById& tags, const Grid& grid) {
  int agree = 0, seen = 0;
  for (const auto& [id, other] : tags) {
    if (!grid.are_neighbours(tag.id, id)) continue;
    ++seen;
    agree += grid.agree(tag, other);
  }
  return agree > 0 && 2 * agree >= seen;
}

// Where the edges meet at a tag's corner, in windows that end before the next corner.
// gap: between tags, sides
std::optional<cv::Point2f> meeting_point(const cv::Mat& grey, const std::array<cv::Point2f, 4>& tag,
                                         std::size_t corner, double gap) {
  const double side =
      std::min(cv::norm(tag[(corner + 1) % 4] - tag[corner]), cv::norm(tag[(corner + 3) % 4] - tag[corner]));
  std::vector<cv::Point2f> narrow = {tag[corner]}, wide = {tag[corner]};
  refine_corners(grey, {gap * side}, narrow);
  refine_corners(grey, {1.6 * gap * side}, wide);  // still less than the two bits of a border
  // Where something else than two straight edges is in the windows, they find different places.
  constexpr double kMostApart = 0.25;  // px
  if (cv::norm(narrow[0] - wide[0]) > kMostApart) return {};
  return narrow[0];
}

}  // namespace

std::vector<MarkerCorner> find_aprilgrid(const cv::Mat& grey, const Board& board) {
  TagsById tags;
  for (AprilTag& tag : find_april_tags(grey, board.columns * board.rows)) tags.emplace(tag.id, tag);
  const auto layout = layout_of(tags, board.columns);
  if (!layout) return {};
  const Grid grid(board, *layout);
  const double gap = board.pitch_mm / board.marker_mm - 1;
  std::vector<MarkerCorner> out;
  for (const auto& [id, tag] : tags) {
    if (!is_in_place(tag, tags, grid)) continue;
    const auto places = grid.corners(id);
    const auto guesses = grid.seen(tag);
    for (std::size_t c = 0; c < 4; ++c)
      if (const auto pixel = meeting_point(grey, guesses, c, gap))
        out.push_back({{places[c].x, places[c].y, 0}, *pixel});
  }
  return out;
}

}  // namespace lightwell::calibration
