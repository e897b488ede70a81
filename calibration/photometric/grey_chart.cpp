// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/photometric/grey_chart.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <opencv2/aruco.hpp>
#include <opencv2/imgproc.hpp>
#include <set>

#include "interface/csv_table.h"

namespace lightwell::calibration {
namespace {

constexpr int kDictionary = cv::aruco::DICT_4X4_50;
constexpr int kMarkerCells = 6;        // four of code and the border
constexpr double kMarkerWidth = 0.75;  // of a cell
constexpr double kMiddle = 0.5;        // part of a patch's side that is measured
constexpr double kMostMiss = 0.12;     // of a cell: half of what is left beside the middle

// Top left corner of a marker, cells.
Vec2d marker_corner(const GreyChart& chart, int id) {
  const double inset = (1 - kMarkerWidth) / 2;
  return {inset + (id == 1 || id == 2 ? chart.columns - 1 : 0), inset + (id >= 2 ? chart.rows + 1 : 0)};
}

using Matches = std::vector<std::pair<Vec2d, Vec2d>>;  // chart, pixel

// Codes as 8 bits, from black to what all but a hundredth of the pixels stay below; `power` < 1 opens the shadows.
cv::Mat as_picture(const MeanFrame& frame, double power) {
  std::vector<double> sorted = frame.code;
  const auto at = [&](double part) {
    const auto n =
        sorted.begin() + static_cast<std::ptrdiff_t>(part * static_cast<double>(sorted.size() - 1));
    std::nth_element(sorted.begin(), n, sorted.end());
    return *n;
  };
  const double low = at(0.01), high = std::max(at(0.99), low + 1);
  cv::Mat picture(frame.format.height, frame.format.width, CV_8UC1);
  for (int y = 0; y < picture.rows; ++y)
    for (int x = 0; x < picture.cols; ++x) {
      const double code = frame.code[static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.cols) +
                                     static_cast<std::size_t>(x)];
      const double part = std::clamp((code - low) / (high - low), 0.0, 1.0);
      picture.at<unsigned char>(y, x) = static_cast<unsigned char>(std::lround(255 * std::pow(part, power)));
    }
  return picture;
}

// scale: how many times larger the picture is than the frame; small markers need it
Matches find_markers(const cv::Mat& picture, int scale, const GreyChart& chart, std::set<int>& found) {
  auto parameters = cv::aruco::DetectorParameters::create();
  parameters->adaptiveThreshWinSizeMax = 53;       // large markers too
  parameters->polygonalApproxAccuracyRate = 0.06;  // a fisheye bends their sides
  parameters->cornerRefinementMethod = cv::aruco::CORNER_REFINE_SUBPIX;
  std::vector<std::vector<cv::Point2f>> corners;
  std::vector<int> ids;
  cv::aruco::detectMarkers(picture, cv::aruco::getPredefinedDictionary(kDictionary), corners, ids,
                           parameters);
  Matches out;
  found.clear();
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (ids[i] > 3 || !found.insert(ids[i]).second) continue;
    const Vec2d origin = marker_corner(chart, ids[i]);
    const Vec2d places[4] = {{0, 0}, {kMarkerWidth, 0}, {kMarkerWidth, kMarkerWidth}, {0, kMarkerWidth}};
    for (std::size_t c = 0; c < 4; ++c)
      out.emplace_back(origin + places[c], Vec2d((static_cast<double>(corners[i][c].x) + 0.5) / scale - 0.5,
                                                 (static_cast<double>(corners[i][c].y) + 0.5) / scale - 0.5));
  }
  return out;
}

// From the chart's plane to pixels: a plane seen from a point, through the lens where there is one.
class PlaneView {
 public:
  // Directions d and points p of a plane have d × H p = 0 (Hartley and Zisserman 2004, section 4.1), beyond 90° too.
  PlaneView(const Matches& matches, const std::optional<Lens>& lens) : lens_(lens) {
    middle_ = Vec2d::Zero();
    for (const auto& match : matches) middle_ += match.second / static_cast<double>(matches.size());
    for (const auto& match : matches) spread_ = std::max(spread_, (match.second - middle_).norm());
    Eigen::MatrixXd rows(static_cast<Eigen::Index>(3 * matches.size()), 9);
    for (std::size_t i = 0; i < matches.size(); ++i) {
      const Vec3d p(matches[i].first.x(), matches[i].first.y(), 1), d = direction(matches[i].second);
      for (Eigen::Index k = 0; k < 3; ++k) {  // rows of [d]× ⊗ pᵀ
        const Eigen::Index a = (k + 1) % 3, b = (k + 2) % 3, row = static_cast<Eigen::Index>(3 * i) + k;
        rows.row(row).setZero();
        rows.block<1, 3>(row, 3 * b) = d[a] * p.transpose();
        rows.block<1, 3>(row, 3 * a) = -d[b] * p.transpose();
      }
    }
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(rows, Eigen::ComputeFullV);
    const Eigen::VectorXd h = svd.matrixV().col(8);
    for (Eigen::Index k = 0; k < 3; ++k) plane_.row(k) = h.segment<3>(3 * k).transpose();
    const Vec3d p(matches[0].first.x(), matches[0].first.y(), 1);
    if (direction(matches[0].second).dot(plane_ * p) < 0) plane_ = -plane_;
  }
  [[nodiscard]] Vec2d pixel(const Vec2d& chart) const {
    const Vec3d d = plane_ * Vec3d(chart.x(), chart.y(), 1);
    if (lens_) return lens_->project(d);
    return middle_ + spread_ * d.head<2>() / d.z();
  }

 private:
  [[nodiscard]] Vec3d direction(const Vec2d& pixel) const {
    if (lens_) return lens_->unproject(pixel);
    const Vec2d p = (pixel - middle_) / spread_;
    return Vec3d(p.x(), p.y(), 1).normalized();
  }
  std::optional<Lens> lens_;
  Vec2d middle_;
  double spread_ = 0;
  Eigen::Matrix3d plane_;
};

// Largest distance of a marker's corner from where the view has it, in cells.
double worst_miss(const PlaneView& view, const Matches& matches) {
  double worst = 0;
  for (const auto& [chart, pixel] : matches) {
    const double cell =
        (view.pixel(chart + Vec2d(0.5, 0.5)) - view.pixel(chart - Vec2d(0.5, 0.5))).norm() / std::sqrt(2.0);
    const double miss = (view.pixel(chart) - pixel).norm() / std::max(cell, 1e-9);
    worst = std::isfinite(miss) ? std::max(worst, miss) : 1e9;
  }
  return worst;
}

// Equal steps of lightness, as a printer knows them: L* from 96 to 8.
int printed_grey(int patch, int patches) {
  const double lightness = 96 - 88.0 * patch / std::max(patches - 1, 1);
  const double y = lightness > 8 ? std::pow((lightness + 16) / 116, 3) : lightness / 903.3;
  return static_cast<int>(std::lround(255 * (1.055 * std::pow(y, 1 / 2.4) - 0.055)));
}

}  // namespace

Result<GreyChart> chart_from_text(const std::string& text) {
  GreyChart chart;
  int used = 0;
  if (std::sscanf(text.c_str(), "%2dx%2d%n", &chart.columns, &chart.rows, &used) != 2 ||
      static_cast<std::size_t>(used) != text.size() || chart.columns < 2 || chart.columns > 20 ||
      chart.rows < 1 || chart.rows > 20)
    return Error{ErrorKind::usage, "chart = " + text.substr(0, 40) + ": allowed COLSxROWS, 2x1 to 20x20"};
  return chart;
}

std::vector<ChartSquare> black_squares(const GreyChart& chart) {
  std::vector<ChartSquare> out;
  const auto dictionary = cv::aruco::getPredefinedDictionary(kDictionary);
  constexpr double kSide = kMarkerWidth / kMarkerCells;
  for (int id = 0; id < 4; ++id) {
    cv::Mat bits;
    cv::aruco::drawMarker(dictionary, id, kMarkerCells, bits, 1);
    for (int y = 0; y < kMarkerCells; ++y)
      for (int x = 0; x < kMarkerCells; ++x)
        if (bits.at<unsigned char>(y, x) == 0) {
          const Vec2d at = marker_corner(chart, id) + kSide * Vec2d(x, y);
          out.push_back({at.x(), at.y(), kSide});
        }
  }
  return out;
}

std::string chart_svg(const GreyChart& chart, double cell_mm) {
  char text[300];
  const double width = chart.columns * cell_mm, height = (chart.rows + 2) * cell_mm;
  std::snprintf(
      text, sizeof text,
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%gmm\" height=\"%gmm\" viewBox=\"0 0 %d %d\">\n"
      "<rect width=\"%d\" height=\"%d\" fill=\"#fff\"/>\n",
      width, height, chart.columns, chart.rows + 2, chart.columns, chart.rows + 2);
  std::string out = text;
  for (const ChartSquare& s : black_squares(chart)) {
    // A hair wider, so that neighbours leave no seam.
    std::snprintf(text, sizeof text, "<rect x=\"%g\" y=\"%g\" width=\"%g\" height=\"%g\"/>\n", s.x, s.y,
                  s.size + 1e-3, s.size + 1e-3);
    out += text;
  }
  for (int i = 0; i < chart.patches(); ++i) {
    const int x = i % chart.columns, y = 1 + i / chart.columns, grey = printed_grey(i, chart.patches());
    std::snprintf(text, sizeof text,
                  "<rect x=\"%g\" y=\"%g\" width=\"0.86\" height=\"0.86\" fill=\"rgb(%d,%d,%d)\"/>"
                  "<text x=\"%g\" y=\"%g\" font-size=\"0.06\" font-family=\"sans-serif\">%d</text>\n",
                  x + 0.07, y + 0.07, grey, grey, grey, x + 0.07, y + 0.065, i + 1);
    out += text;
  }
  return out + "</svg>\n";
}

Result<std::vector<PatchRegion>> read_positions(const std::filesystem::path& file) {
  const auto table = CsvTable::read(file);
  if (!table) return table.error();
  if (const Status status = table->require({"patch", "x", "y", "w", "h"}); !status) return status.error();
  std::vector<PatchRegion> out;
  std::set<std::string> names;
  for (std::size_t row = 0; row < table->rows(); ++row) {
    std::array<double, 4> value{};
    constexpr std::array<const char*, 4> kColumns = {"x", "y", "w", "h"};
    for (std::size_t i = 0; i < 4; ++i) {
      const auto number = i < 2 ? table->number(row, kColumns[i], -1e5, 1e5, "a number of pixels")
                                : table->number(row, kColumns[i], 1, 1e5, "1 pixel or more");
      if (!number) return number.error();
      value[i] = *number;
    }
    const std::string name = table->text(row, "patch");
    if (name.empty() || !names.insert(name).second)
      return Error{ErrorKind::bad_input, table->place(row) +
                                             ": patch = " + (name.empty() ? "nothing" : name.substr(0, 40)) +
                                             ": allowed a name, once"};
    const auto [x, y, w, h] = value;
    // From the outer edge of the first pixel to that of the last.
    const double left = x - 0.5, top = y - 0.5;
    out.push_back(
        {name, {Vec2d(left, top), Vec2d(left + w, top), Vec2d(left + w, top + h), Vec2d(left, top + h)}});
  }
  return out;
}

Result<std::vector<PatchRegion>> find_chart(const MeanFrame& frame, const GreyChart& chart,
                                            const std::optional<Lens>& lens) {
  std::set<int> found, best;
  Matches matches;
  const bool mosaic = is_bayer(frame.format.pixel_format);
  // Small markers are found in a picture made larger; those of a mosaic with and without what 1 2 1 both ways leaves of it
  // (no mosaic, but less sharpness).
  for (const auto& [scale, blur] : std::vector<std::pair<int, bool>>{
           {1, false}, {1, true}, {2, false}, {2, true}, {3, false}, {3, true}}) {
    if (blur && !mosaic) continue;
    if (static_cast<double>(scale) * std::max(frame.format.width, frame.format.height) > 8000) break;
    for (const double power : {1.0, 0.45, 0.2}) {  // a linear sensor's shadows hide black and white
      if (best.size() == 4) break;
      cv::Mat picture = as_picture(frame, power);
      if (blur) cv::GaussianBlur(picture, picture, {3, 3}, 0);
      if (scale > 1) cv::resize(picture, picture, {}, scale, scale, cv::INTER_CUBIC);
      Matches now = find_markers(picture, scale, chart, found);
      if (now.size() > matches.size()) matches = std::move(now), best = found;
    }
  }
  if (best.size() < 4) {
    std::string missing;
    for (int id = 0; id < 4; ++id)
      if (!best.contains(id)) missing += (missing.empty() ? "" : ", ") + std::to_string(id);
    return Error{ErrorKind::bad_input,
                 "the chart was not found: of the markers 0 to 3 at its corners " + missing +
                     (best.size() == 3 ? " is" : " are") +
                     " missing: allowed a chart that is seen whole, in light and sharp"};
  }
  const PlaneView view(matches, lens);
  if (const double miss = worst_miss(view, matches); !(miss <= kMostMiss)) {
    char text[200];
    std::snprintf(
        text, sizeof text,
        "the chart's markers lie up to %.2f of a patch from where a plane chart of %dx%d patches has them: "
        "allowed %.2f; %s",
        std::min(miss, 99.0), chart.columns, chart.rows, kMostMiss,
        lens ? "is it that chart, and flat?" : "give --lens, or check --chart");
    return Error{ErrorKind::bad_input, text};
  }
  std::vector<PatchRegion> out;
  for (int i = 0; i < chart.patches(); ++i) {
    const Vec2d middle(i % chart.columns + 0.5, 1 + i / chart.columns + 0.5);
    PatchRegion region{std::to_string(i + 1), {}};
    const Vec2d offsets[4] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    for (std::size_t c = 0; c < 4; ++c) region.corners[c] = view.pixel(middle + kMiddle / 2 * offsets[c]);
    out.push_back(region);
  }
  return out;
}

}  // namespace lightwell::calibration
