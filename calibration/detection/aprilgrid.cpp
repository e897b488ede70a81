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
#include "calibration/detection/corner_refinement.h"

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

// How many of a tag's neighbours have it where it is, and how many are seen.
struct Witnesses {
  int agree = 0, seen = 0;
};

Witnesses witnesses_of(const AprilTag& tag, const TagsById& tags, const Grid& grid) {
  Witnesses out;
  for (const auto& [id, other] : tags) {
    if (!grid.are_neighbours(tag.id, id)) continue;
    ++out.seen;
    out.agree += grid.agree(tag, other);
  }
  return out;
}

// Where the edges meet at a tag's corner, in windows that end before the next corner: the widest is still less than the
// two bits of a border.
// gap: between tags, sides
std::optional<cv::Point2f> corner_of_tag(const cv::Mat& grey, const std::array<cv::Point2f, 4>& tag,
                                         std::size_t corner, double gap) {
  const double side =
      std::min(cv::norm(tag[(corner + 1) % 4] - tag[corner]), cv::norm(tag[(corner + 3) % 4] - tag[corner]));
  return meeting_point(grey, tag[corner], gap * side);
}

struct TagCorners {
  std::vector<MarkerCorner> corners;
  bool contradictory =
      false;  // most neighbours are not where they have each other, as on a board of other columns
};

// Corners of the tags that are in place, none where most contradict each other.
TagCorners corners_in_place(const cv::Mat& grey, const TagsById& tags, const Grid& grid, double gap) {
  Witnesses all;
  std::vector<const AprilTag*> in_place;
  for (const auto& [id, tag] : tags) {
    const Witnesses own = witnesses_of(tag, tags, grid);
    all.agree += own.agree;
    all.seen += own.seen;
    // One without neighbours may be anything.
    if (own.agree > 0 && 2 * own.agree >= own.seen) in_place.push_back(&tag);
  }
  TagCorners out;
  constexpr int kTelling = 12;  // each pair counts twice: six of them
  out.contradictory = all.seen >= kTelling && 2 * all.agree < all.seen;
  if (2 * all.agree < all.seen) return out;
  for (const AprilTag* tag : in_place) {
    const auto places = grid.corners(tag->id);
    const auto guesses = grid.seen(*tag);
    for (std::size_t c = 0; c < 4; ++c)
      if (const auto pixel = corner_of_tag(grey, guesses, c, gap))
        out.corners.push_back({{places[c].x, places[c].y, 0}, *pixel});
  }
  return out;
}

}  // namespace

MarkerSearch find_aprilgrid(const cv::Mat& grey, const Board& board) {
  const AprilTags found = find_april_tags(grey, board.columns * board.rows);
  TagsById tags;
  for (const AprilTag& tag : found.tags) tags.emplace(tag.id, tag);
  const auto layout = layout_of(tags, board.columns);
  TagCorners in_place;
  if (layout)
    in_place = corners_in_place(grey, tags, Grid(board, *layout), board.pitch_mm / board.marker_mm - 1);
  MarkerSearch out;
  out.corners = std::move(in_place.corners);
  if (!out.corners.empty()) return out;
  out.of_another_board = true;
  const auto other = other_markers(grey, board.kind);
  if (other.count > tags.size() + found.twice.size() + found.beyond.size())
    out.reason = "shows " + other.name + ", a " + name(board) + " has AprilTags 36h11";
  else if (found.beyond.size() >= kTellingMarkers)
    out.reason = "shows AprilTags " + ids_in_words(found.beyond) + ", a " + name(board) + " has 0 to " +
                 std::to_string(board.columns * board.rows - 1);
  else if (found.twice.size() >= kTellingMarkers)
    out.reason = "shows AprilTags " + ids_in_words(found.twice) + " twice";
  else if (in_place.contradictory)
    out.reason =
        "shows AprilTags that are not where a " + name(board) + " has them: are its columns and rows right?";
  else {
    out.of_another_board = false;
    out.reason = "shows no marker of a " + name(board);
    if (!found.at_twice_its_size)
      out.reason += "; pictures above 8 megapixels are not searched for tags smaller than some 25 px";
  }
  return out;
}

}  // namespace lightwell::calibration
