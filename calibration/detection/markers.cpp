// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/detection/markers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <opencv2/aruco.hpp>
#include <opencv2/imgproc.hpp>

#include "calibration/detection/april_tags.h"
#include "calibration/detection/corner_refinement.h"
#include "lighting/median.h"

namespace lightwell::calibration {
namespace {

struct Markers {
  std::vector<std::vector<cv::Point2f>> corners;  // four each, clockwise from the marker's first
  std::vector<int> ids;
  double by_chance = 0;  // how many of the picture's frames would be read as one if they held random bits
};

cv::Point2f centre(const std::vector<cv::Point2f>& corners) {
  return (corners[0] + corners[1] + corners[2] + corners[3]) / 4;
}

// Whether a quad is a dark frame with something lighter drawn in it.
bool is_frame(const cv::Mat& grey, const std::vector<cv::Point2f>& quad) {
  constexpr int kSide = 24,
                kBorder = 4;  // px; the border of the finest markers is a ninth, of the coarsest a sixth
  constexpr auto kFar = static_cast<float>(kSide);
  const std::vector<cv::Point2f> square = {{0, 0}, {kFar, 0}, {kFar, kFar}, {0, kFar}};
  cv::Mat seen;
  cv::warpPerspective(grey, seen, cv::getPerspectiveTransform(quad, square), {kSide, kSide});
  const cv::Range inside(kBorder, kSide - kBorder);
  double darkest = 0, brightest = 0;
  cv::minMaxLoc(seen(inside, inside), &darkest, &brightest);
  constexpr double kLeastContrast = 40;  // codes
  if (brightest - darkest < kLeastContrast) return false;
  // A pixel off the edge, along which the quad's own error is.
  const double middle = (darkest + brightest) / 2;
  int dark = 0, all = 0;
  for (int i = 1; i + 1 < kSide; ++i)
    for (const cv::Point p : {cv::Point(i, 1), {i, kSide - 2}, {1, i}, {kSide - 2, i}}) {
      dark += seen.at<std::uint8_t>(p) < middle;
      ++all;
    }
  return 10 * dark > 8 * all;
}

bool is_within(cv::Point2f place, const std::vector<std::vector<cv::Point2f>>& quads) {
  return std::any_of(quads.begin(), quads.end(),
                     [&](const auto& quad) { return cv::pointPolygonTest(quad, place, false) >= 0; });
}

// Part of all bits that are read as a marker of a dictionary, turned in any way, wrong bits corrected.
double chance_of(const cv::aruco::Dictionary& dictionary, double correction_rate) {
  const int bits = dictionary.markerSize * dictionary.markerSize,
            corrected = static_cast<int>(dictionary.maxCorrectionBits * correction_rate);
  double neighbours = 0, of_so_many = 1;
  for (int wrong = 0; wrong <= corrected; ++wrong) {
    neighbours += of_so_many;
    of_so_many *= static_cast<double>(bits - wrong) / (wrong + 1);
  }
  return std::min(1.0, 4 * dictionary.bytesList.rows * neighbours * std::pow(0.5, bits));
}

Markers all_markers(const cv::Mat& grey, int dictionary) {
  auto parameters = cv::aruco::DetectorParameters::create();
  parameters->adaptiveThreshWinSizeMax = 53;       // large markers too
  parameters->polygonalApproxAccuracyRate = 0.06;  // a fisheye bends their sides
  const auto markers = cv::aruco::getPredefinedDictionary(dictionary);
  Markers out;
  std::vector<std::vector<cv::Point2f>> others;
  cv::aruco::detectMarkers(grey, markers, out.corners, out.ids, parameters, others);
  // Bits of a marker are quads too.
  const auto frames = std::count_if(others.begin(), others.end(), [&](const auto& quad) {
    return is_frame(grey, quad) && !is_within(centre(quad), out.corners);
  });
  out.by_chance =
      chance_of(*markers, parameters->errorCorrectionRate) * static_cast<double>(out.ids.size() + frames);
  return out;
}

// Whether so many markers say what board a picture shows. Three of random bits at least, and far more than by chance: of
// 4x4 bits and a thousand ids every sixteenth frame is one, so that half of all have to be.
bool is_telling(std::size_t count, double by_chance) {
  return count >= kTellingMarkers && static_cast<double>(count) > 8 * by_chance;
}

// Markers of one dictionary, as a board has them and otherwise.
struct BoardMarkers {
  Markers markers;                 // each once
  std::vector<int> twice, beyond;  // ids seen in two places, left out; ids that the board has not
};

BoardMarkers find_markers(const cv::Mat& grey, int dictionary, int count) {
  const Markers all = all_markers(grey, dictionary);
  std::map<int, std::vector<std::size_t>> seen;
  for (std::size_t i = 0; i < all.ids.size(); ++i) {
    std::vector<std::size_t>& places = seen[all.ids[i]];
    const auto same = [&](std::size_t other) {
      return cv::norm(centre(all.corners[i]) - centre(all.corners[other])) <
             cv::norm(all.corners[i][2] - all.corners[i][0]) / 2;
    };
    if (std::none_of(places.begin(), places.end(), same)) places.push_back(i);
  }
  BoardMarkers out;
  out.markers.by_chance = all.by_chance;
  for (const auto& [id, places] : seen)
    if (id >= count)
      out.beyond.push_back(id);
    else if (places.size() > 1)
      out.twice.push_back(id);
    else {
      out.markers.ids.push_back(id);
      out.markers.corners.push_back(all.corners[places.front()]);
    }
  return out;
}

// Where the markers of a ChArUco board stand: row by row in every other square, from the second of the first row on;
// as OpenCV printed boards of even rows before version 4.6, from the first on.
struct CharucoLayout {
  Board board;
  bool legacy = false;

  [[nodiscard]] bool has_marker(int column, int row) const {
    return (column + row) % 2 == (legacy && board.rows % 2 == 0 ? 0 : 1);
  }
  // Column and row of each marker's square, by id.
  [[nodiscard]] std::vector<cv::Point> squares() const {
    std::vector<cv::Point> out;
    for (int r = 0; r < board.rows; ++r)
      for (int c = 0; c < board.columns; ++c)
        if (has_marker(c, r)) out.emplace_back(c, r);
    return out;
  }
  // From the board, in pitches from its first corner, to the picture, near a marker.
  [[nodiscard]] cv::Matx33d picture_from_board(cv::Point square,
                                               const std::vector<cv::Point2f>& corners) const {
    const auto margin = static_cast<float>((1 - board.marker_mm / board.pitch_mm) / 2);
    const cv::Point2f near = cv::Point2f(square) + cv::Point2f(margin, margin),
                      far = cv::Point2f(square) + cv::Point2f(1 - margin, 1 - margin);
    const std::vector<cv::Point2f> places = {near, {far.x, near.y}, far, {near.x, far.y}};
    return cv::getPerspectiveTransform(places, corners);
  }
};

cv::Point2d mapped(const cv::Matx33d& h, double x, double y) {
  const cv::Vec3d p = h * cv::Vec3d(x, y, 1);
  return {p[0] / p[2], p[1] / p[2]};
}

// How far each marker's neighbours are from where it would have them in a layout, pitches; median.
double disorder(const Markers& markers, const CharucoLayout& layout) {
  const std::vector<cv::Point> squares = layout.squares();
  std::vector<double> off;
  for (std::size_t i = 0; i < markers.ids.size(); ++i) {
    const cv::Point here = squares[static_cast<std::size_t>(markers.ids[i])];
    const cv::Matx33d picture_from_board = layout.picture_from_board(here, markers.corners[i]);
    const double pitch_px = cv::norm(mapped(picture_from_board, here.x + 1, here.y + 1) -
                                     mapped(picture_from_board, here.x, here.y)) /
                            std::sqrt(2.0);
    for (std::size_t j = 0; j < markers.ids.size(); ++j) {
      const cv::Point there = squares[static_cast<std::size_t>(markers.ids[j])];
      if (i == j || cv::norm(there - here) > 2) continue;
      const cv::Point2d expected = mapped(picture_from_board, there.x + 0.5, there.y + 0.5);
      off.push_back(cv::norm(expected - cv::Point2d(centre(markers.corners[j]))) / pitch_px);
    }
  }
  return median(std::move(off), std::numeric_limits<double>::max());
}

// How far the markers' corners are from the check's that they surround, along the less way; h: near one of them.
double room_px(const cv::Matx33d& h, int column, int row, double margin) {
  const cv::Point2d x = (mapped(h, column + margin, row) - mapped(h, column - margin, row)) / 2,
                    y = (mapped(h, column, row + margin) - mapped(h, column, row - margin)) / 2;
  return std::min({cv::norm(x), cv::norm(y), cv::norm(x + y), cv::norm(x - y)});
}

// Inner corners whose two markers are both seen and agree on the place.
struct CornersBetween {
  std::vector<MarkerCorner> corners;  // near which the picture's edges meet
  bool blurred = false;               // there are others, near which they do not
};

CornersBetween corners_between(const cv::Mat& grey, const Markers& markers, const CharucoLayout& layout) {
  const std::vector<cv::Point> squares = layout.squares();
  std::map<std::pair<int, int>, cv::Matx33d> seen;  // by row and column of the square
  for (std::size_t i = 0; i < markers.ids.size(); ++i) {
    const cv::Point square = squares[static_cast<std::size_t>(markers.ids[i])];
    seen[{square.y, square.x}] = layout.picture_from_board(square, markers.corners[i]);
  }
  CornersBetween out;
  for (int r = 1; r < layout.board.rows; ++r)
    for (int c = 1; c < layout.board.columns; ++c) {
      const bool falling = layout.has_marker(c - 1, r - 1);  // markers before and behind, or beside
      const auto first = seen.find({r - 1, falling ? c - 1 : c}),
                 second = seen.find({r, falling ? c : c - 1});
      if (first == seen.end() || second == seen.end()) continue;
      const cv::Point2d a = mapped(first->second, c, r), b = mapped(second->second, c, r);
      const double pitch_px = cv::norm(mapped(first->second, c, r - 1) - a);
      constexpr double kMostApart =
          0.2;  // pitches: a lens bends less over one, a wrong marker is a pitch off
      if (!(cv::norm(a - b) < kMostApart * pitch_px)) continue;
      const double pitch_mm = layout.board.pitch_mm, margin = (1 - layout.board.marker_mm / pitch_mm) / 2;
      const double room =
          std::min(room_px(first->second, c, r, margin), room_px(second->second, c, r, margin));
      if (const auto pixel = meeting_point(grey, cv::Point2f((a + b) / 2), room))
        out.corners.push_back({{pitch_mm * (c - 1), pitch_mm * (r - 1), 0}, *pixel});
      else
        out.blurred = true;
    }
  return out;
}

}  // namespace

MarkerSearch find_charuco(const cv::Mat& grey, const Board& board) {
  constexpr int kDictionaries[] = {cv::aruco::DICT_4X4_250,  cv::aruco::DICT_5X5_250,
                                   cv::aruco::DICT_6X6_250,  cv::aruco::DICT_7X7_250,
                                   cv::aruco::DICT_4X4_1000, cv::aruco::DICT_5X5_1000,
                                   cv::aruco::DICT_6X6_1000, cv::aruco::DICT_ARUCO_ORIGINAL};
  const int count = board.columns * board.rows / 2;
  BoardMarkers best;
  const auto size = [](const BoardMarkers& m) {
    return m.markers.ids.size() + m.twice.size() + m.beyond.size();
  };
  for (const int d : kDictionaries)
    if (BoardMarkers m = find_markers(grey, d, count); size(m) > size(best)) best = std::move(m);
  MarkerSearch out;
  const CharucoLayout today{board, false}, legacy{board, true};
  const bool is_legacy =
      board.rows % 2 == 0 && disorder(best.markers, legacy) < disorder(best.markers, today);
  CornersBetween found = corners_between(grey, best.markers, is_legacy ? legacy : today);
  out.corners = std::move(found.corners);
  if (!out.corners.empty()) return out;
  if (found.blurred) {
    out.reason = "shows markers of a " + name(board) + ", but no corner between them sharp and large enough";
    return out;
  }
  out.of_another_board = true;
  const auto other = other_markers(grey, board.kind);
  if (other.count > size(best))
    out.reason = "shows " + other.name + ", a " + name(board) + " has ArUco markers";
  else if (is_telling(best.beyond.size(), best.markers.by_chance))
    out.reason = "shows markers " + ids_in_words(best.beyond) + ", a " + name(board) + " has 0 to " +
                 std::to_string(count - 1);
  else if (is_telling(best.twice.size(), best.markers.by_chance))
    out.reason = "shows markers " + ids_in_words(best.twice) + " twice";
  else if (best.markers.ids.size() > kTellingMarkers &&
           is_telling(best.markers.ids.size(), best.markers.by_chance))
    out.reason =
        "shows markers that are not where a " + name(board) + " has them: are its columns and rows right?";
  else {
    out.of_another_board = false;
    out.reason = "shows no marker of a " + name(board);
  }
  return out;
}

OtherMarkers other_markers(const cv::Mat& grey, BoardKind kind) {
  struct Kind {
    int dictionary;
    const char* name;
    bool is_aruco;
  };
  constexpr Kind kKinds[] = {{cv::aruco::DICT_4X4_1000, "ArUco markers of 4x4 bits", true},
                             {cv::aruco::DICT_5X5_1000, "ArUco markers of 5x5 bits", true},
                             {cv::aruco::DICT_6X6_1000, "ArUco markers of 6x6 bits", true},
                             {cv::aruco::DICT_7X7_1000, "ArUco markers of 7x7 bits", true},
                             {cv::aruco::DICT_APRILTAG_25h9, "AprilTags 25h9", false},
                             {cv::aruco::DICT_APRILTAG_36h10, "AprilTags 36h10", false}};
  OtherMarkers out;
  const auto add = [&](std::size_t count, double by_chance, const char* name) {
    if (is_telling(count, by_chance) && count > out.count) out = {count, name};
  };
  if (kind == BoardKind::charuco)
    add(find_april_tags(grey, std::numeric_limits<int>::max()).tags.size(), 0, "AprilTags 36h11");
  for (const Kind& k : kKinds) {
    if (kind != BoardKind::aprilgrid && k.is_aruco) continue;
    const Markers seen = all_markers(grey, k.dictionary);
    add(seen.ids.size(), seen.by_chance, k.name);
  }
  return out;
}

std::string ids_in_words(const std::vector<int>& ids) {
  constexpr std::size_t kMost = 4;
  std::string out;
  for (std::size_t i = 0; i < std::min(ids.size(), kMost); ++i)
    out += (i > 0 ? ", " : "") + std::to_string(ids[i]);
  return ids.size() <= kMost ? out : out + " and " + std::to_string(ids.size() - kMost) + " more";
}

}  // namespace lightwell::calibration
