// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <map>
#include <random>
#include <string>
#include <tuple>

#include "interface/rig_file.h"
#include "lighting/calibration.h"
#include "lighting/lat_long_image.h"
#include "tests/support/analytic_lamps.h"

// A rig that measures an analytic lamp: slides of the dual, a screen, and a camera that looks at it askew.
namespace lightwell::test {

// ∫ Φ'±(x) f(u + x h, s) dx of one axis, of the filter's positive part, of its negative part, or of all of it, over s.
class FilteredAxis {
 public:
  enum class Sign { positive, negative, all };
  FilteredAxis(const AnalyticLamp& lamp, const LampAxis& axis, BellDual filter, double spacing_m, double u_m,
               Sign sign, double low_m, double high_m, int samples)
      : low_m_(low_m), step_m_((high_m - low_m) / (samples - 1)) {
    constexpr int kNodes = 256;
    const double reach = std::min(bell_dual_reach(filter), 6.0);
    for (int i = 0; i < samples; ++i) {
      double sum = 0;
      for (int k = 0; k < kNodes; ++k) {
        const double x = -reach + (k + 0.5) * 2 * reach / kNodes;
        const double value = bell_dual(filter, x);
        const double part = sign == Sign::all        ? value
                            : sign == Sign::positive ? std::max(value, 0.0)
                                                     : std::max(-value, 0.0);
        if (part != 0) sum += part * lamp.profile(axis, u_m + x * spacing_m, low_m + i * step_m_);
      }
      values_.push_back(sum * 2 * reach / kNodes);
    }
  }
  [[nodiscard]] double at(double s_m) const {
    const double place = (s_m - low_m_) / step_m_;
    const auto last = static_cast<double>(values_.size()) - 3;
    if (!(place >= 1 && place <= last)) return 0;
    const auto i = static_cast<std::size_t>(place);
    const auto w = cubic_weights(place - static_cast<double>(i));
    return w[0] * values_[i - 1] + w[1] * values_[i] + w[2] * values_[i + 1] + w[3] * values_[i + 2];
  }

 private:
  double low_m_, step_m_;
  std::vector<double> values_;
};

struct SimulatedRig {
  AnalyticLamp lamp = reflector_lamp();
  Rig rig;             // pictures listed by list_pictures
  int positions = 11;  // a side
  bool slides = true;  // two a position, else the whole filter at once, as no slide lets through
  std::array<int, 2> picture_size = {150, 150};
  std::optional<Calibration> camera;          // absent: pictures are the screen's own pixels, rig.edges
  Vec3d camera_m = Vec3d(0.25, -0.15, 0.35);  // above the screen, which it looks at
  double ambient_lux = 0;                     // in every picture and the dark frame
  double noise = 0;                           // standard deviation, part of the value, of light or codes
  double dust = 0;  // in every picture, added to its values: what a sensor has at zero

  void list_pictures() {
    rig.pictures.clear();
    for (int v = 0; v < positions; ++v)
      for (int u = 0; u < positions; ++u) {
        const std::string at = std::to_string(u) + "_" + std::to_string(v);
        const Vec2d place = rig.spacing_m * (Vec2d(u, v).array() - (positions - 1) / 2.0);
        if (slides) {
          rig.pictures.push_back({at + "p.exr", "line", place, Rig::Part::positive, rig_exposure_us});
          rig.pictures.push_back({at + "n.exr", "line", place, Rig::Part::negative, rig_exposure_us});
        } else {
          rig.pictures.push_back({at + ".exr", "line", place, Rig::Part::whole, rig_exposure_us});
        }
      }
    if (!camera) return;
    rig.edges.reset();
    rig.marks.clear();
    for (const Vec2d& corner : {rig.low_m, rig.high_m, Vec2d(rig.low_m.x(), rig.high_m.y()),
                                Vec2d(rig.high_m.x(), rig.low_m.y()), Vec2d(0.01, -0.02), Vec2d(-0.03, 0.02)})
      rig.marks.push_back({camera->lens.project(camera_ray(corner)), corner});
  }
  double rig_exposure_us = 0;

  // By its name in the list, or "dark.exr".
  [[nodiscard]] LatLongImage picture(const std::string& file) {
    LatLongImage image{picture_size[0], picture_size[1], {}};
    const Rig::Picture* listed = nullptr;
    for (const Rig::Picture& picture : rig.pictures)
      if (picture.file == file) listed = &picture;
    std::mt19937 random(static_cast<unsigned>(std::hash<std::string>()(file)));
    std::normal_distribution<double> normal(0, 1);
    const Sums sums = listed != nullptr ? sums_of(*listed) : Sums();
    const std::vector<Rgbd> light =
        listed == nullptr
            ? std::vector<Rgbd>(static_cast<std::size_t>(image.width * image.height), Rgbd::Zero())
        : camera ? seen_by_camera(sums, *listed)
                 : of_screen_pixels(sums, *listed);
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x) {
        const Rgbd lux = ambient_lux + light[static_cast<std::size_t>(y * image.width + x)];
        image.pixels.push_back(recorded(lux, x, y, [&] { return normal(random); }).cast<float>());
      }
    return image;
  }

 private:
  struct Sum {  // a term, and the axes' parts whose products the slide lets through
    Rgbd amplitude;
    const FilteredAxis &x, &y;
  };
  using Sums = std::vector<Sum>;

  const FilteredAxis& axis_of(std::size_t term, std::size_t axis, double at_m, FilteredAxis::Sign sign) {
    const auto key = std::tuple(term, axis, at_m, sign);
    const auto known = axes_.find(key);
    if (known != axes_.end()) return known->second;
    constexpr int kSamples = 700;
    const double reach = 4.5 * lamp.distance_m;
    return axes_
        .emplace(key, FilteredAxis(lamp, lamp.terms[term].axes[axis], rig.filter, rig.spacing_m, at_m, sign,
                                   -reach, reach, kSamples))
        .first->second;
  }
  std::map<std::tuple<std::size_t, std::size_t, double, FilteredAxis::Sign>, FilteredAxis> axes_;

  [[nodiscard]] Sums sums_of(const Rig::Picture& picture) {
    using Sign = FilteredAxis::Sign;
    const bool negative = picture.part == Rig::Part::negative;
    const std::vector<std::pair<Sign, Sign>> products =
        picture.part == Rig::Part::whole ? std::vector{std::pair(Sign::all, Sign::all)}
        : negative                       ? std::vector{std::pair(Sign::positive, Sign::negative),
                                 std::pair(Sign::negative, Sign::positive)}
                                         : std::vector{std::pair(Sign::positive, Sign::positive),
                                 std::pair(Sign::negative, Sign::negative)};
    Sums sums;
    for (std::size_t term = 0; term < lamp.terms.size(); ++term)
      for (const auto& [x, y] : products)
        sums.push_back({lamp.terms[term].amplitude, axis_of(term, 0, picture.position_m.x(), x),
                        axis_of(term, 1, picture.position_m.y(), y)});
    return sums;
  }

  static constexpr double kOffset = 0.28867513459481287;  // two Gauss–Legendre points a pixel's side

  [[nodiscard]] double slide_scale() const {
    const double peak = bell_dual(rig.filter, 0);
    return rig.peak_transmission * rig.spacing_m * rig.spacing_m / (peak * peak);
  }
  [[nodiscard]] Vec2d shift_of(const Rig::Picture& picture) const {
    return rig.moves == Rig::Moves::lamp ? picture.position_m : Vec2d(Vec2d::Zero());
  }

  [[nodiscard]] std::vector<Rgbd> seen_by_camera(const Sums& sums, const Rig::Picture& picture) const {
    std::vector<Rgbd> lux;
    for (int y = 0; y < picture_size[1]; ++y)
      for (int x = 0; x < picture_size[0]; ++x) {
        Rgbd sum = Rgbd::Zero();
        for (const double dy : {-kOffset, kOffset})
          for (const double dx : {-kOffset, kOffset}) {
            const Vec2d at = seen_point(Vec2d(x + dx, y + dy)) + shift_of(picture);
            for (const Sum& s : sums) sum += s.amplitude * s.x.at(at.x()) * s.y.at(at.y());
          }
        lux.emplace_back(sum * slide_scale() / 4);
      }
    return lux;
  }

  // A product of columns' and rows' means.
  [[nodiscard]] std::vector<Rgbd> of_screen_pixels(const Sums& sums, const Rig::Picture& picture) const {
    std::vector<Rgbd> lux(static_cast<std::size_t>(picture_size[0] * picture_size[1]), Rgbd::Zero());
    const Vec2d pixel =
        (rig.edges->last_m - rig.edges->first_m).cwiseQuotient(Vec2d(picture_size[0], picture_size[1]));
    const Vec2d first = rig.edges->first_m + shift_of(picture);
    const auto mean = [&](const FilteredAxis& f, int axis, int i) {
      const double middle = first[axis] + (i + 0.5) * pixel[axis];
      return (f.at(middle - kOffset * pixel[axis]) + f.at(middle + kOffset * pixel[axis])) / 2;
    };
    for (const Sum& s : sums) {
      std::vector<double> along;
      for (int x = 0; x < picture_size[0]; ++x) along.push_back(mean(s.x, 0, x));
      std::size_t i = 0;
      for (int y = 0; y < picture_size[1]; ++y) {
        const Rgbd row = s.amplitude * mean(s.y, 1, y) * slide_scale();
        for (const double column : along) lux[i++] += row * column;
      }
    }
    return lux;
  }

  // Of the camera: it looks at the screen's middle, its picture's right side along x as far as that goes.
  [[nodiscard]] Eigen::Matrix3d screen_from_camera() const {
    const Vec3d z = (-camera_m).normalized();
    const Vec3d y = z.cross(Vec3d::UnitX()).normalized();
    Eigen::Matrix3d out;
    out << y.cross(z), y, z;
    return out;
  }
  [[nodiscard]] Vec3d camera_ray(const Vec2d& screen) const {
    return screen_from_camera().transpose() * (Vec3d(screen.x(), screen.y(), 0) - camera_m);
  }
  [[nodiscard]] Vec2d seen_point(const Vec2d& pixel) const {
    const Vec3d ray = screen_from_camera() * camera->lens.unproject(pixel);
    return (camera_m + ray * (-camera_m.z() / ray.z())).head<2>();
  }

  template <class Normal>
  [[nodiscard]] Rgbd recorded(const Rgbd& lux, int x, int y, const Normal& normal) const {
    const auto noisy = [&](double value) { return value * (1 + noise * normal()) + dust; };
    Rgbd out;
    for (int c = 0; c < 3; ++c) {
      if (rig.unit == Rig::Unit::lux || rig.unit == Rig::Unit::relative) {
        out[c] = noisy(lux[c]);
        continue;
      }
      double luminance = lux[c] * rig.screen_reflectance / kPi;
      if (rig.unit == Rig::Unit::codes) {
        const Response& response = camera->response;
        luminance *= camera->flat.transmission(camera->lens.theta_rad(Vec2d(x, y))) * rig_exposure_us /
                     response.reference_exposure_us;
        const double most = std::exp2(response.bits) - 1;
        out[c] = std::clamp(std::round(noisy(response.code(luminance))), 0.0, most);
      } else {
        out[c] = noisy(luminance);
      }
    }
    return out;
  }
};

// A tenth of the planes' distance apart, all around the lamp.
inline SimulatedRig simulated_rig(AnalyticLamp lamp, int positions, int pixels) {
  SimulatedRig out;
  out.lamp = std::move(lamp);
  out.positions = positions;
  const double d = out.lamp.distance_m;
  out.rig.name = "Simulated";
  out.rig.spacing_m = 0.1 * d;
  out.rig.distance_m = d;
  out.rig.low_m = Vec2d::Constant(-2.5 * d);
  out.rig.high_m = -out.rig.low_m;
  out.rig.pixels = {pixels, pixels};
  out.rig.moves = Rig::Moves::filter;
  out.rig.edges = Rig::Edges{out.rig.low_m, out.rig.high_m};
  out.picture_size = out.rig.pixels;
  return out;
}

}  // namespace lightwell::test
