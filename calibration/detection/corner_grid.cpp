// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/detection/corner_grid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>

namespace lightwell::calibration {
namespace {

constexpr std::size_t kNone = static_cast<std::size_t>(-1);

// The end of one of a saddle's four edges.
struct End {
  std::size_t saddle = kNone;
  std::size_t edge = 0;
};
using Links = std::vector<std::array<End, 4>>;

float at(const cv::Mat& grey, cv::Point2f p) {
  const int x = std::clamp(cvRound(p.x), 0, grey.cols - 1), y = std::clamp(cvRound(p.y), 0, grey.rows - 1);
  return grey.at<std::uint8_t>(y, x);
}

// Whether light lies along one side of the way and dark along the other, as much as at the saddles.
bool is_edge(const cv::Mat& grey, cv::Point2f from, cv::Point2f to, bool light_after, float contrast) {
  const cv::Point2f way = to - from;
  // Toward growing angles, a sixth of a check off the edge: beyond its blur and what a lens bends it by.
  const cv::Point2f aside = cv::Point2f(-way.y, way.x) * std::max(1.0 / 6, 2 / cv::norm(way));
  const auto light = [&](float t) {
    const float difference = at(grey, from + t * way + aside) - at(grey, from + t * way - aside);
    return (light_after ? difference : -difference) > 0.4f * contrast;
  };
  return light(0.25f) && light(0.5f) && light(0.75f);
}

float between(const cv::Mat& grey, cv::Point2f p) {
  const auto x = std::floor(p.x), y = std::floor(p.y);
  const float a = p.x - x, b = p.y - y;
  return (1 - b) * ((1 - a) * at(grey, {x, y}) + a * at(grey, {x + 1, y})) +
         b * ((1 - a) * at(grey, {x, y + 1}) + a * at(grey, {x + 1, y + 1}));
}

// Whether light and dark alternate as near a saddle as `radius`, too.
bool stands_near(const cv::Mat& grey, const Saddle& saddle, float radius) {
  float least_light = 255, most_dark = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    const cv::Point2f middle = saddle.edge[k] + saddle.edge[(k + 1) % 4];
    const float code = between(grey, saddle.pixel + middle * (radius / std::max(0.1, cv::norm(middle))));
    if (saddle.light_after(k))
      least_light = std::min(least_light, code);
    else
      most_dark = std::max(most_dark, code);
  }
  return least_light - most_dark > 0.35f * saddle.contrast;
}

// Nearest saddles first, at most 24: the next corner is among the nearest 8 where nothing else is about.
std::vector<std::size_t> nearest(const std::vector<Saddle>& saddles, std::size_t of) {
  std::vector<std::pair<double, std::size_t>> all;
  for (std::size_t i = 0; i < saddles.size(); ++i)
    if (i != of) all.emplace_back(cv::norm(saddles[i].pixel - saddles[of].pixel), i);
  const std::size_t count = std::min<std::size_t>(24, all.size());
  std::partial_sort(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(count), all.end());
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < count; ++i) out.push_back(all[i].second);
  return out;
}

// The edge of a saddle that points along a unit direction, to 25 degrees.
std::optional<std::size_t> edge_along(const Saddle& saddle, cv::Point2f direction) {
  for (std::size_t k = 0; k < 4; ++k)
    if (saddle.edge[k].dot(direction) > 0.9f) return k;
  return {};
}

// The nearest saddle to which each edge leads.
std::array<End, 4> ends_of(const cv::Mat& grey, const std::vector<Saddle>& saddles, std::size_t i) {
  std::array<End, 4> out;
  const Saddle& from = saddles[i];
  for (const std::size_t j : nearest(saddles, i)) {
    const Saddle& to = saddles[j];
    const cv::Point2f way = to.pixel - from.pixel;
    const cv::Point2f direction = way / cv::norm(way);
    const auto edge = edge_along(from, direction), back = edge_along(to, -direction);
    if (!edge || !back || out[*edge].saddle != kNone) continue;
    // Seen from the other end, what comes after the edge is before it.
    if (from.light_after(*edge) == to.light_after(*back)) continue;
    if (is_edge(grey, from.pixel, to.pixel, from.light_after(*edge), std::min(from.contrast, to.contrast)))
      out[*edge] = {j, *back};
  }
  return out;
}

// Both saddles agree on the edge between them.
Links links_of(const cv::Mat& grey, const std::vector<Saddle>& saddles) {
  Links links;
  for (std::size_t i = 0; i < saddles.size(); ++i) links.push_back(ends_of(grey, saddles, i));
  Links out(saddles.size());
  for (std::size_t i = 0; i < saddles.size(); ++i)
    for (std::size_t k = 0; k < 4; ++k) {
      const End end = links[i][k];
      if (end.saddle == kNone) continue;
      const End back = links[end.saddle][end.edge];
      if (back.saddle == i && back.edge == k) out[i][k] = end;
    }
  return out;
}

// Checks whose four edges lead around to the start, each counted from one of its corners.
int count_cells(const Links& links, const std::vector<std::size_t>& members) {
  int from_each_corner = 0;
  for (const std::size_t start : members)
    for (std::size_t k = 0; k < 4; ++k) {
      End at{start, k};
      for (int side = 0; side < 4 && at.saddle != kNone; ++side) {
        const End end = links[at.saddle][at.edge];
        at = {end.saddle, (end.edge + 3) % 4};  // the edge before the one back: a turn toward growing angles
      }
      from_each_corner += at.saddle == start && at.edge == k;
    }
  return from_each_corner / 4;
}

// Walks along the links from a saddle. turn: what to add to the number of an edge for its direction in the grid,
// 0 toward growing columns, 1 toward growing rows
CornerGrid grid_from(const std::vector<Saddle>& saddles, const Links& links, std::size_t start,
                     std::vector<bool>& done) {
  struct Place {
    std::size_t saddle, turn;
    int column, row;
  };
  CornerGrid out;
  std::vector<std::size_t> members;
  std::vector<Place> open = {{start, 0, 0, 0}};
  done[start] = true;
  for (std::size_t next = 0; next < open.size(); ++next) {
    const Place here = open[next];
    Saddle saddle = saddles[here.saddle];
    std::rotate(saddle.edge.begin(), saddle.edge.begin() + static_cast<std::ptrdiff_t>((4 - here.turn) % 4),
                saddle.edge.end());
    if (here.turn % 2 == 1) saddle.light_after_first = !saddle.light_after_first;
    out.corners.emplace(std::pair(here.column, here.row), saddle);
    members.push_back(here.saddle);
    for (std::size_t k = 0; k < 4; ++k) {
      const End end = links[here.saddle][k];
      if (end.saddle == kNone || done[end.saddle]) continue;
      done[end.saddle] = true;
      const std::size_t direction = (k + here.turn) % 4;
      constexpr std::array<int, 4> kColumn = {1, 0, -1, 0}, kRow = {0, 1, 0, -1};
      open.push_back({end.saddle, (direction + 2 + 4 - end.edge) % 4, here.column + kColumn[direction],
                      here.row + kRow[direction]});
    }
  }
  out.cells = count_cells(links, members);
  return out;
}

struct Extent {
  int left = 0, right = -1, top = 0, bottom = -1;
  [[nodiscard]] int columns() const { return right - left + 1; }
  [[nodiscard]] int rows() const { return bottom - top + 1; }
};

Extent extent_of(const CornerGrid& grid) {
  Extent out;
  bool first = true;
  for (const auto& [place, corner] : grid.corners) {
    const auto [c, r] = place;
    out = first ? Extent{c, c, r, r}
                : Extent{std::min(out.left, c), std::max(out.right, c), std::min(out.top, r),
                         std::max(out.bottom, r)};
    first = false;
  }
  return out;
}

// Takes away borders of which less than half is there, until none is left.
Extent trim(CornerGrid& grid) {
  for (;;) {
    const Extent e = extent_of(grid);
    const auto drop_if_sparse = [&](bool column, int index, int full) {
      const auto on_border = [&](const auto& corner) {
        return (column ? corner.first.first : corner.first.second) == index;
      };
      if (2 * std::count_if(grid.corners.begin(), grid.corners.end(), on_border) >= full) return false;
      std::erase_if(grid.corners, on_border);
      return true;
    };
    if (!drop_if_sparse(true, e.left, e.rows()) && !drop_if_sparse(true, e.right, e.rows()) &&
        !drop_if_sparse(false, e.top, e.columns()) && !drop_if_sparse(false, e.bottom, e.columns()))
      return e;
  }
}

CornerGrid quarter_turned(const CornerGrid& grid) {
  CornerGrid out;
  for (auto [place, corner] : grid.corners) {
    std::rotate(corner.edge.begin(), corner.edge.begin() + 1, corner.edge.end());
    corner.light_after_first = !corner.light_after_first;
    out.corners.emplace(std::pair(place.second, -place.first), corner);
  }
  return out;
}

}  // namespace

CornerGrid largest_corner_grid(const cv::Mat& grey, double scale) {
  cv::Mat sized = grey;
  if (scale != 1) cv::resize(grey, sized, {}, scale, scale, scale < 1 ? cv::INTER_AREA : cv::INTER_CUBIC);
  std::vector<Saddle> saddles = find_saddles(sized);
  // The centre of pixel (0, 0) is the origin at every scale.
  const cv::Point2f half(0.5f, 0.5f);
  for (Saddle& saddle : saddles) saddle.pixel = (saddle.pixel + half) / scale - half;
  cv::Mat smooth;
  cv::GaussianBlur(grey, smooth, {}, 1);
  // Near the place, between dots or on a line between tiles, all is alike.
  const auto near = static_cast<float>(std::max(1.5, 1 / scale));
  std::erase_if(saddles, [&](const Saddle& s) { return !stands_near(grey, s, near); });
  const Links links = links_of(smooth, saddles);
  CornerGrid best;
  std::vector<bool> done(saddles.size());
  for (std::size_t i = 0; i < saddles.size(); ++i) {
    if (done[i]) continue;
    CornerGrid grid = grid_from(saddles, links, i, done);
    if (grid.cells > best.cells) best = std::move(grid);
  }
  return best;
}

std::optional<std::pair<int, int>> size_of_grid(CornerGrid grid) {
  if (grid.cells < 4) return {};
  trim(grid);
  const Extent e = extent_of(grid);
  const bool whole = e.columns() >= 3 && e.rows() >= 3 &&
                     grid.corners.size() == static_cast<std::size_t>(e.columns() * e.rows());
  return whole ? std::optional(std::pair(e.columns(), e.rows())) : std::nullopt;
}

std::vector<cv::Point2f> corners_of_board(CornerGrid grid, int columns, int rows) {
  if (columns < 2 || rows < 2 || grid.cells < (columns - 1) * (rows - 1)) return {};
  trim(grid);
  std::vector<cv::Point2f> best;
  float best_turn = -2;
  for (int turn = 0; turn < 4; ++turn, grid = quarter_turned(grid)) {
    const Extent e = extent_of(grid);
    if (e.columns() != columns || e.rows() != rows ||
        grid.corners.size() != static_cast<std::size_t>(columns * rows))
      continue;
    std::vector<cv::Point2f> corners;
    for (int r = e.top; r <= e.bottom; ++r)
      for (int c = e.left; c <= e.right; ++c) corners.push_back(grid.corners.at({c, r}).pixel);
    const Saddle& first = grid.corners.at({e.left, e.top});
    const bool told_apart = (columns + rows) % 2 == 1;
    if (told_apart && !first.light_after_first) continue;
    const cv::Point2f along = corners[static_cast<std::size_t>(columns) - 1] - corners[0];
    const cv::Point2f down = corners[static_cast<std::size_t>(columns * (rows - 1))] - corners[0];
    const auto upright = static_cast<float>(along.x / cv::norm(along) + down.y / cv::norm(down));
    if (best.empty() || upright > best_turn) {
      best = std::move(corners);
      best_turn = upright;
    }
  }
  return best;
}

}  // namespace lightwell::calibration
