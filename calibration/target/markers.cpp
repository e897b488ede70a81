// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/target/markers.h"

#include <algorithm>
#include <array>
#include <map>
#include <opencv2/aruco/charuco.hpp>

namespace lightwell::calibration {
namespace {

struct Markers {
  std::vector<std::vector<cv::Point2f>> corners;  // four each, clockwise from the marker's first
  std::vector<int> ids;
};

// Markers with ids below `count`, the first of each id.
Markers find_markers(const cv::Mat& grey, int dictionary, int border_bits, int count) {
  auto parameters = cv::aruco::DetectorParameters::create();
  parameters->markerBorderBits = border_bits;
  parameters->adaptiveThreshWinSizeMax = 53;       // large markers too
  parameters->polygonalApproxAccuracyRate = 0.06;  // a fisheye bends their sides
  Markers all, out;
  cv::aruco::detectMarkers(grey, cv::aruco::getPredefinedDictionary(dictionary), all.corners, all.ids,
                           parameters);
  std::map<int, bool> seen;
  for (std::size_t i = 0; i < all.ids.size(); ++i) {
    if (all.ids[i] >= count || seen[all.ids[i]]) continue;
    seen[all.ids[i]] = true;
    out.ids.push_back(all.ids[i]);
    out.corners.push_back(all.corners[i]);
  }
  return out;
}

cv::Point2f centre(const std::vector<cv::Point2f>& corners) {
  return (corners[0] + corners[1] + corners[2] + corners[3]) / 4;
}

// How the tags lie on the grid: which corner is the first along a row, and whether rows follow each other the way
// the corners go on, or against it. Votes of neighbours.
struct GridLayout {
  std::size_t first_corner = 0;
  double row_direction = 1;
};
GridLayout layout_of(const Markers& tags, int columns) {
  std::map<int, std::size_t> index;
  for (std::size_t i = 0; i < tags.ids.size(); ++i) index[tags.ids[i]] = i;
  std::array<int, 4> first{};
  for (const auto& [id, i] : index) {
    const auto next = index.find(id + 1);
    if (next == index.end() || (id + 1) % columns == 0) continue;
    const cv::Point2f along = centre(tags.corners[next->second]) - centre(tags.corners[i]);
    std::size_t best = 0;
    float most = -1;
    for (std::size_t c = 0; c < 4; ++c) {
      const cv::Point2f side = tags.corners[i][(c + 1) % 4] - tags.corners[i][c];
      if (side.dot(along) > most) {
        most = side.dot(along);
        best = c;
      }
    }
    ++first[best];
  }
  GridLayout out;
  out.first_corner = static_cast<std::size_t>(std::max_element(first.begin(), first.end()) - first.begin());
  int direction = 0;
  for (const auto& [id, i] : index) {
    const auto next = index.find(id + columns);
    if (next == index.end()) continue;
    const cv::Point2f down =
        tags.corners[i][(out.first_corner + 2) % 4] - tags.corners[i][(out.first_corner + 1) % 4];
    direction += down.dot(centre(tags.corners[next->second]) - centre(tags.corners[i])) > 0 ? 1 : -1;
  }
  out.row_direction = direction >= 0 ? 1 : -1;
  return out;
}

}  // namespace

std::vector<MarkerCorner> find_charuco(const cv::Mat& grey, const Board& board) {
  constexpr int kDictionaries[] = {cv::aruco::DICT_4X4_250,  cv::aruco::DICT_5X5_250,
                                   cv::aruco::DICT_6X6_250,  cv::aruco::DICT_7X7_250,
                                   cv::aruco::DICT_4X4_1000, cv::aruco::DICT_5X5_1000,
                                   cv::aruco::DICT_6X6_1000, cv::aruco::DICT_ARUCO_ORIGINAL};
  const int count = board.columns * board.rows / 2;
  Markers best;
  int dictionary = kDictionaries[0];
  for (const int d : kDictionaries)
    if (Markers m = find_markers(grey, d, 1, count); m.ids.size() > best.ids.size()) {
      best = std::move(m);
      dictionary = d;
    }
  if (best.ids.size() < 2) return {};
  const auto layout = cv::aruco::CharucoBoard::create(
      board.columns, board.rows, static_cast<float>(board.pitch_mm), static_cast<float>(board.marker_mm),
      cv::aruco::getPredefinedDictionary(dictionary));
  std::vector<cv::Point2f> corners;
  std::vector<int> ids;
  cv::aruco::interpolateCornersCharuco(best.corners, best.ids, grey, layout, corners, ids);
  std::vector<MarkerCorner> out;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const int column = ids[i] % (board.columns - 1), row = ids[i] / (board.columns - 1);
    out.push_back({{board.pitch_mm * column, board.pitch_mm * row, 0}, corners[i]});
  }
  return out;
}

std::vector<MarkerCorner> find_aprilgrid(const cv::Mat& grey, const Board& board) {
  const int count = board.columns * board.rows;
  Markers tags = find_markers(grey, cv::aruco::DICT_APRILTAG_36h11, 2, count);
  if (Markers thin = find_markers(grey, cv::aruco::DICT_APRILTAG_36h11, 1, count);
      thin.ids.size() > tags.ids.size())
    tags = std::move(thin);
  if (tags.ids.size() < 2) return {};
  const GridLayout layout = layout_of(tags, board.columns);
  std::vector<MarkerCorner> out;
  for (std::size_t i = 0; i < tags.ids.size(); ++i) {
    const Vec3d origin(board.pitch_mm * (tags.ids[i] % board.columns),
                       layout.row_direction * board.pitch_mm * (tags.ids[i] / board.columns), 0);
    const Vec3d places[4] = {
        {0, 0, 0}, {board.marker_mm, 0, 0}, {board.marker_mm, board.marker_mm, 0}, {0, board.marker_mm, 0}};
    for (std::size_t c = 0; c < 4; ++c)
      out.push_back({origin + places[c], tags.corners[i][(layout.first_corner + c) % 4]});
  }
  return out;
}

}  // namespace lightwell::calibration
