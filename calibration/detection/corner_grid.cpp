// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/detection/corner_grid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "calibration/detection/corner_refinement.h"

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

// Whether light and dark alternate as near a saddle as `radius`, too.
bool stands_near(const cv::Mat& grey, const Saddle& saddle, float radius) {
  float least_light = 255, most_dark = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    const cv::Point2f middle = saddle.edge[k] + saddle.edge[(k + 1) % 4];
    const float code = code_at(grey, saddle.pixel + middle * (radius / std::max(0.1, cv::norm(middle))));
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

// Puts a corner that is missing where its neighbours have it: those on both sides, or the two beyond it on one side, the
// mean of them. Colours alternate. False where neighbours are missing, too.
bool fill(CornerGrid& grid, const Extent& extent) {
  const auto at = [&](int c, int r) -> const Saddle* {
    const auto found = grid.corners.find({c, r});
    return found == grid.corners.end() ? nullptr : &found->second;
  };
  const auto guess = [&](int c, int r) -> std::optional<Saddle> {
    cv::Point2f sum(0, 0);
    float count = 0;
    const Saddle* neighbour = nullptr;
    const auto vote = [&](const Saddle* near, const Saddle* far, bool between) {
      if (!near || !far) return;
      const float weight = between ? 4 : 1;
      sum += weight * (between ? (near->pixel + far->pixel) / 2 : 2 * near->pixel - far->pixel);
      count += weight;
      neighbour = near;
    };
    vote(at(c - 1, r), at(c + 1, r), true);
    vote(at(c, r - 1), at(c, r + 1), true);
    for (const int way : {-1, 1}) {
      vote(at(c + way, r), at(c + 2 * way, r), false);
      vote(at(c, r + way), at(c, r + 2 * way), false);
    }
    if (count == 0) return {};
    Saddle out = *neighbour;
    out.pixel = sum / count;
    out.light_after_first = !out.light_after_first;
    out.contrast = 0;
    return out;
  };
  const auto all = static_cast<std::size_t>(extent.columns() * extent.rows());
  while (grid.corners.size() < all) {
    std::map<std::pair<int, int>, Saddle> more;
    for (int r = extent.top; r <= extent.bottom; ++r)
      for (int c = extent.left; c <= extent.right; ++c)
        if (!at(c, r))
          if (const auto corner = guess(c, r)) more.emplace(std::pair(c, r), *corner);
    if (more.empty()) return false;
    grid.corners.merge(more);
  }
  return true;
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

bool is_nearly(CornerGrid grid, int columns, int rows) {
  trim(grid);
  const Extent e = extent_of(grid);
  const auto found = std::minmax({e.columns(), e.rows()}), asked = std::minmax({columns, rows});
  return found.first >= asked.first - 1 && found.second >= asked.second - 1;
}

BoardGrid board_of_grid(CornerGrid grid, int columns, int rows) {
  const Extent found = trim(grid);
  const bool upright = found.columns() == columns && found.rows() == rows;
  if (columns < 2 || rows < 2 || (!upright && (found.columns() != rows || found.rows() != columns)))
    return {};
  if (4 * grid.corners.size() < 3 * static_cast<std::size_t>(columns * rows)) return {};
  if (!fill(grid, found)) return {};
  BoardGrid best;
  float best_turn = -2;
  for (int turn = 0; turn < 4; ++turn, grid = quarter_turned(grid)) {
    const Extent e = extent_of(grid);
    if (e.columns() != columns || e.rows() != rows) continue;
    BoardGrid board;
    for (int r = e.top; r <= e.bottom; ++r)
      for (int c = e.left; c <= e.right; ++c) {
        const Saddle& corner = grid.corners.at({c, r});
        board.corners.push_back(corner.pixel);
        board.seen.push_back(corner.contrast > 0);
      }
    const Saddle& first = grid.corners.at({e.left, e.top});
    const bool told_apart = (columns + rows) % 2 == 1;
    if (told_apart && !first.light_after_first) continue;
    const cv::Point2f along = board.corners[static_cast<std::size_t>(columns) - 1] - board.corners[0];
    const cv::Point2f down = board.corners[static_cast<std::size_t>(columns * (rows - 1))] - board.corners[0];
    const auto turned = static_cast<float>(along.x / cv::norm(along) + down.y / cv::norm(down));
    if (best.corners.empty() || turned > best_turn) {
      best = std::move(board);
      best_turn = turned;
    }
  }
  return best;
}

}  // namespace lightwell::calibration
