// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/report/residual_plots.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "calibration/report/json_access.h"
#include "calibration/report/svg_plot.h"
#include "lighting/median.h"

namespace lightwell::calibration {
namespace {

using nlohmann::json;

struct Arrow {
  double x = 0, y = 0, dx = 0, dy = 0;  // pixels
  bool counts = true;
};

struct ViewArrows {
  std::string name;
  double rms_px = 0;
  bool used = true;
  std::vector<Arrow> arrows;
  [[nodiscard]] std::size_t rejected() const {
    return static_cast<std::size_t>(
        std::count_if(arrows.begin(), arrows.end(), [](const Arrow& a) { return !a.counts; }));
  }
};

ViewArrows arrows_of(const json& view) {
  ViewArrows out;
  out.name = file_name(view.value("name", std::string()));
  out.used = view.value("used", true);
  out.rms_px = has_number(view, "rms_px") ? view.at("rms_px").get<double>() : 0;
  for (const json& r : list_or_none(view, "residuals_px"))
    out.arrows.push_back({r.at(0).get<double>(), r.at(1).get<double>(), r.at(2).get<double>(),
                          r.at(3).get<double>(), out.used});
  for (const json& index : list_or_none(view, "rejected"))
    if (const double i = index.get<double>(); i >= 0 && i < static_cast<double>(out.arrows.size()))
      out.arrows[static_cast<std::size_t>(i)].counts = false;
  return out;
}

// As many times longer than the error that the median of the points that count is seen; 0 where none counts.
double arrow_gain(const Lens& lens, const std::vector<ViewArrows>& views) {
  std::vector<double> lengths;
  for (const ViewArrows& view : views)
    for (const Arrow& a : view.arrows)
      if (a.counts) lengths.push_back(std::hypot(a.dx, a.dy));
  if (lengths.empty()) return 0;
  return 0.02 * std::max(lens.image_size[0], lens.image_size[1]) / std::max(median(std::move(lengths)), 1e-6);
}

std::string place(double v) {
  return formatted("%.1f", std::clamp(v, -1e5, 1e5));
}

// A shaft, and a head of two strokes that is no longer than a third of it.
std::string arrow_path(const Arrow& a, double gain, double longest_head) {
  const double dx = std::clamp(gain * a.dx, -1e5, 1e5), dy = std::clamp(gain * a.dy, -1e5, 1e5);
  const double length = std::hypot(dx, dy);
  std::string out = "M" + place(a.x) + " " + place(a.y) + "l" + place(dx) + " " + place(dy);
  if (!(length > 0)) return out;
  const double head = std::min(longest_head, length / 3) / length;
  const double bx = -head * dx, by = -head * dy;  // back along the shaft
  constexpr double kCos = 0.866, kSin = 0.5;      // 30 degrees to either side
  out += "l" + place(kCos * bx - kSin * by) + " " + place(kSin * bx + kCos * by);
  out += "M" + place(a.x + dx) + " " + place(a.y + dy) + "l" + place(kCos * bx + kSin * by) + " " +
         place(-kSin * bx + kCos * by);
  return out;
}

// 1, 2 or 5 times a power of ten, near a tenth of the picture's width once enlarged.
double bar_px(const Lens& lens, double gain) {
  const double wanted = 0.1 * lens.image_size[0] / gain;
  const double power = std::pow(10, std::floor(std::log10(wanted)));
  return power * (wanted / power < 2 ? 1 : wanted / power < 5 ? 2 : 5);
}

class Picture {
 public:
  Picture(const Lens& lens, double gain, int shown_width) : lens_(lens), gain_(gain) {
    unit_ = static_cast<double>(lens.image_size[0]) / shown_width;
    const std::string size = std::to_string(lens.image_size[0]) + " " + std::to_string(lens.image_size[1]);
    svg_ = "<svg viewBox=\"0 0 " + size + "\" width=\"" + std::to_string(shown_width) + "\" class=\"image\">";
  }
  void add(const ViewArrows& view, const std::string& colour) {
    std::string counting, rejected;
    for (const Arrow& a : view.arrows) (a.counts ? counting : rejected) += arrow_path(a, gain_, 5 * unit_);
    svg_ += "<g fill=\"none\" stroke-width=\"" + formatted("%.2f", unit_) + "\"><title>" +
            escaped(view.name) + "</title>";
    if (!counting.empty()) svg_ += "<path stroke=\"" + colour + "\" d=\"" + counting + "\"/>";
    if (!rejected.empty()) svg_ += "<path stroke=\"#a3281c\" stroke-opacity=\".45\" d=\"" + rejected + "\"/>";
    svg_ += "</g>";
  }
  void add_bar() {
    const double px = bar_px(lens_, gain_), x = 12 * unit_, y = lens_.image_size[1] - 14 * unit_;
    svg_ += "<path stroke=\"#1c2733\" stroke-width=\"" + formatted("%.2f", 3 * unit_) + "\" d=\"M" +
            place(x) + " " + place(y) + "h" + place(gain_ * px) + "\"/><text x=\"" + place(x) + "\" y=\"" +
            place(y - 6 * unit_) + "\" class=\"halo\" style=\"font-size:" + place(13 * unit_) +
            "px;stroke-width:" + place(3 * unit_) + "\">" + plain_number(px) + " px</text>";
  }
  [[nodiscard]] std::string svg() const { return svg_ + "</svg>"; }

 private:
  const Lens& lens_;
  double gain_;
  double unit_;  // of the page, in pixels of the image
  std::string svg_;
};

std::string whole(const Lens& lens, const std::vector<ViewArrows>& views, double gain) {
  Picture picture(lens, gain, 620);
  int hue = 0;
  for (const ViewArrows& view : views) {
    picture.add(view, "hsl(" + std::to_string(hue) + " 70% 40%)");
    hue = (hue + 137) % 360;  // the golden angle: neighbours differ
  }
  picture.add_bar();
  return picture.svg();
}

std::string worst(const Lens& lens, std::vector<ViewArrows> views, double gain) {
  constexpr std::size_t kShown = 6;
  views.erase(std::remove_if(views.begin(), views.end(),
                             [](const ViewArrows& v) { return !v.used || v.arrows.empty(); }),
              views.end());
  if (views.size() < 2) return "";
  std::stable_sort(views.begin(), views.end(),
                   [](const ViewArrows& a, const ViewArrows& b) { return a.rms_px > b.rms_px; });
  if (views.size() > kShown) views.resize(kShown);
  std::string out = "<p>The views with the largest errors, alike enlarged:</p><div class=\"row views\">";
  for (const ViewArrows& view : views) {
    Picture picture(lens, gain, 196);
    picture.add(view, "#08306b");
    out += "<figure>" + picture.svg() + "<figcaption>" + escaped(view.name) +
           formatted(", %.3f px", view.rms_px) +
           (view.rejected() > 0 ? ", " + std::to_string(view.rejected()) + " left out" : "") +
           "</figcaption></figure>";
  }
  return out + "</div>";
}

}  // namespace

std::string file_name(const std::string& path) {
  const std::size_t last = path.find_last_not_of('/');
  if (last == std::string::npos) return path;
  const std::size_t slash = path.find_last_of('/', last);
  return path.substr(slash == std::string::npos ? 0 : slash + 1,
                     slash == std::string::npos ? last + 1 : last - slash);
}

std::string residual_plots(const Lens& lens, const json& views) {
  std::vector<ViewArrows> all;
  for (const json& view : views) all.push_back(arrows_of(view));
  const double gain = arrow_gain(lens, all);
  if (!(gain > 0)) return "";
  return "<p>Each arrow goes from where a picture shows a point to where the lens puts it, " +
         plain_number(gain) +
         " times as long as that is on the image: the bar tells how much. A colour each view; pale red are "
         "points that were left out.</p>" +
         whole(lens, all, gain) + worst(lens, all, gain);
}

}  // namespace lightwell::calibration
