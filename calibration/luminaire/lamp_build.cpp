// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/luminaire/lamp_build.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "calibration/luminaire/rig_camera.h"
#include "calibration/luminaire/rig_positions.h"
#include "calibration/luminaire/screen_view.h"
#include "interface/atomic_file.h"
#include "interface/exr_file.h"
#include "lighting/luminaire/area_resampling.h"

namespace lightwell::calibration {
namespace {

constexpr std::int64_t kMostPicturePixels = std::int64_t{1} << 26;
constexpr std::int64_t kMostPixels = std::int64_t{1} << 28;  // of all images together

Error bad(const std::string& message) {
  return {ErrorKind::bad_input, message};
}

// What all pictures of a rig have in common.
struct Bench {
  const Rig& rig;
  const std::filesystem::path& folder;
  const RigPictures& pictures;
  RigCamera camera;
  std::optional<ScreenView> view;
  std::vector<Rgbd> dark;  // lux, of every pixel; empty: none
  std::array<int, 2> size = {0, 0};
};

Result<LatLongImage> read_picture(Bench& bench, const std::string& file) {
  auto picture = bench.pictures(file);
  if (!picture) return picture;
  if (const Status same = bench.camera.expect_size(*picture, (bench.folder / file).string()); !same)
    return same.error();
  return picture;
}

Status check_saturation(const Rig& rig, double saturated, const std::string& file) {
  if (saturated <= rig.most_saturated) return {};
  char what[160];
  std::snprintf(what, sizeof what, ": %.3g of its pixels are saturated, allowed: most_saturated, %g",
                saturated, rig.most_saturated);
  return bad(file + what);
}

Status read_dark(Bench& bench) {
  if (bench.rig.dark.empty()) return {};
  const std::string file = (bench.folder / bench.rig.dark).string();
  const auto picture = read_picture(bench, bench.rig.dark);
  if (!picture) return picture.error();
  std::size_t saturated = 0;
  for (int y = 0; y < picture->height; ++y)
    for (int x = 0; x < picture->width; ++x) {
      const auto [lux, clipped] = bench.camera.develop(*picture, x, y, bench.rig.dark_exposure_us);
      if (!lux.isFinite().all())
        return bad(file + ": pixel " + std::to_string(x) + "," + std::to_string(y) +
                   " is no number, allowed: finite values");
      bench.dark.push_back(lux);
      if (clipped) ++saturated;
    }
  return check_saturation(bench.rig, static_cast<double>(saturated) / static_cast<double>(bench.dark.size()),
                          file);
}

struct Resampled {
  double saturated = 0;               // part of the pixels
  double positive = 0, negative = 0;  // light
  Vec2d blur = Vec2d::Constant(1.0 / 12);
};

Status check_seen(const Bench& bench, const AreaResampling& grid, const std::string& file) {
  constexpr double kWhole = 1e-6;  // rounding of areas
  double seen = 0;
  bool all = true;
  for (int t = 0; t < bench.rig.pixels[1]; ++t)
    for (int s = 0; s < bench.rig.pixels[0]; ++s) {
      const double covered = grid.covered(s, t);
      seen += covered;
      all = all && covered > 1 - kWhole;
    }
  if (all) return {};
  const double pixels = static_cast<double>(bench.rig.pixels[0]) * bench.rig.pixels[1];
  char what[160];
  std::snprintf(what, sizeof what,
                ": shows %.4g %% of the measurement plane, allowed: 100 %%; low_m, high_m nearer "
                "to each other, or a wider view",
                100 * std::min(seen / pixels, 1 - 1e-6));
  return bad(file + what);
}

// Adds a picture's light to its position's image, E_mn; sign and slides' scale are in `scale`.
Result<Resampled> add_picture(Bench& bench, const Rig::Picture& listed, double scale, Rgb* image) {
  const Rig& rig = bench.rig;
  const std::string file = (bench.folder / listed.file).string();
  const auto picture = read_picture(bench, listed.file);
  if (!picture) return picture.error();
  // The screen stays where it is: in the frame of a lamp that moves, it is where the filter is.
  const Vec2d shift = rig.moves == Rig::Moves::lamp ? listed.position_m : Vec2d(Vec2d::Zero());
  AreaResampling grid(rig.pixels, rig.low_m, rig.high_m);
  std::size_t seen = 0, saturated = 0, not_finite = 0;
  std::array<int, 2> first_bad = {0, 0};
  for (int y = 0; y < picture->height; ++y)
    for (int x = 0; x < picture->width; ++x) {
      auto corners = bench.view->corners_m(x, y);
      for (Vec2d& corner : corners) corner += shift;
      const auto [lux, clipped] = bench.camera.develop(*picture, x, y, listed.exposure_us);
      if (!lux.isFinite().all()) {
        if (grid.shared_area(corners) > 0 && not_finite++ == 0) first_bad = {x, y};
        continue;
      }
      const std::size_t at = static_cast<std::size_t>(y) * static_cast<std::size_t>(picture->width) +
                             static_cast<std::size_t>(x);
      const double shared = grid.add(corners, bench.dark.empty() ? lux : Rgbd(lux - bench.dark[at]));
      if (!(shared > 0)) continue;
      ++seen;
      if (clipped) ++saturated;
    }
  if (not_finite > 0)
    return bad(file + ": " + std::to_string(not_finite) + " pixels are no numbers, the first " +
               std::to_string(first_bad[0]) + "," + std::to_string(first_bad[1]) +
               ", allowed: finite values");
  if (const Status all = check_seen(bench, grid, file); !all) return all.error();
  Resampled out;
  out.blur = grid.blur_variance();
  out.saturated = static_cast<double>(saturated) / static_cast<double>(seen);
  for (int t = 0; t < rig.pixels[1]; ++t)
    for (int s = 0; s < rig.pixels[0]; ++s) {
      const Rgbd mean = grid.mean(s, t);
      out.positive += mean.max(0.0).sum();
      out.negative -= mean.min(0.0).sum();
      *image++ += (scale * mean).cast<float>();
    }
  return out;
}

// Against the light of the brightest picture: in a dark one all is noise. Of the whole filter at once light is negative.
class NegativeLight {
 public:
  void add(const Rig::Picture& picture, const Resampled& resampled) {
    brightest_ = std::max(brightest_, resampled.positive);
    if (picture.part == Rig::Part::whole || !(resampled.negative > most_)) return;
    most_ = resampled.negative;
    file_ = picture.file;
  }
  [[nodiscard]] double part() const { return most_ > 0 ? most_ / brightest_ : 0; }
  [[nodiscard]] Status check(const Bench& bench) const {
    if (part() <= bench.rig.most_negative) return {};
    char what[200];
    std::snprintf(
        what, sizeof what,
        ": has %.3g of the brightest picture's light as negative light, allowed: most_negative, %g; "
        "is the dark frame of the same exposure?",
        part(), bench.rig.most_negative);
    return bad((bench.folder / file_).string() + what);
  }

 private:
  double most_ = 0, brightest_ = 0;
  std::string file_;
};

// A slide lets through peak_transmission of the light where the filter is greatest, spacing² Φ'² / Φ'max² of it elsewhere.
double lux_to_measured(const Rig& rig) {
  const double peak = bell_dual(rig.filter, 0);
  return peak * peak / (rig.peak_transmission * rig.spacing_m * rig.spacing_m);
}

LampPlanes planes_of(const Rig& rig, const PositionGrid& grid) {
  LampPlanes planes;
  planes.positions = grid.positions;
  planes.spacing_m = rig.spacing_m;
  planes.first_m = grid.first_m;
  planes.z_m = rig.z_m;
  planes.distance_m = rig.distance_m;
  planes.pixels = rig.pixels;
  planes.low_m = rig.low_m;
  planes.high_m = rig.high_m;
  return planes;
}

void remark_on_positions(const RigPositions& positions, BuiltLamp& built) {
  std::vector<bool> measured = positions.measured;
  complete_positions(built.measured.irradiance, measured);
  const auto& [columns, rows] = positions.grid.positions;
  for (int v = 0; v < rows; ++v)
    for (int u = 0; u < columns; ++u) {
      const std::size_t at = built.measured.irradiance.planes.image(u, v);
      if (positions.measured[at]) continue;
      const Vec2d place = built.measured.irradiance.planes.position(u, v);
      char what[160];
      std::snprintf(what, sizeof what, "no picture of the position %g,%g m of the lamp: %s", place.x(),
                    place.y(),
                    measured[at] ? "completed from its neighbours" : "dark, as it has no neighbours in line");
      built.remarks.emplace_back(what);
      ++built.completed;
    }
}

// Light that ends where measuring ended was cut off.
void remark_on_borders(BuiltLamp& built) {
  const LampImages& images = built.measured.irradiance;
  const LampPlanes& p = images.planes;
  double all = 0, edge = 0, brightest = 0, outer = 0;
  for (int v = 0; v < p.positions[1]; ++v)
    for (int u = 0; u < p.positions[0]; ++u) {
      double sum = 0;
      for (int t = 0; t < p.pixels[1]; ++t)
        for (int s = 0; s < p.pixels[0]; ++s) {
          const double value = std::abs(static_cast<double>(images.image(u, v)[t * p.pixels[0] + s].sum()));
          sum += value;
          all = std::max(all, value);
          if (s == 0 || t == 0 || s == p.pixels[0] - 1 || t == p.pixels[1] - 1) edge = std::max(edge, value);
        }
      brightest = std::max(brightest, sum);
      if (u == 0 || v == 0 || u == p.positions[0] - 1 || v == p.positions[1] - 1)
        outer = std::max(outer, sum);
    }
  constexpr double kNoted = 0.02;
  char what[160];
  if (edge > kNoted * all) {
    std::snprintf(
        what, sizeof what,
        "the measurement plane's edge has %.2g of its brightest light: what shines beyond it is lost",
        edge / all);
    built.remarks.emplace_back(what);
  }
  if (outer > kNoted * brightest) {
    std::snprintf(
        what, sizeof what,
        "an outer position has %.2g of the brightest one's light: the lamp is wider than the positions",
        outer / brightest);
    built.remarks.emplace_back(what);
  }
}

Status scale_to_reference(const Rig& rig, const std::string& file, BuiltLamp& built) {
  if (!rig.reference) return {};
  const double lux = luminance(illuminance(built.lamp, rig.reference->at_m, rig.reference->toward));
  if (!(lux > 0))
    return bad(file + ": reference.at_m gets no light from the lamp, allowed: a place that it lights");
  built.scale = rig.reference->lux / lux;
  const auto factor = static_cast<float>(built.scale);
  for (Rgb& value : built.measured.irradiance.values) value *= factor;
  for (Rgb& value : built.lamp.near->intensity.values) value *= factor;
  return {};
}

// A lamp takes no light away.
Status check_light(const std::string& file, BuiltLamp& built) {
  const double flux_lm = luminance(luminous_flux(built.lamp));
  if (flux_lm < 0) {
    char text[160];
    std::snprintf(
        text, sizeof text,
        ": the pictures sum up to %.3g lm, allowed: 0 or more; are the slides positive and negative "
        "swapped, or is the dark frame of another exposure?",
        flux_lm);
    return Error{ErrorKind::bad_input, file + text};
  }
  if (flux_lm == 0) built.remarks.emplace_back("no picture has any light: a dark lamp");
  return {};
}

}  // namespace

Result<BuiltLamp> build_lamp(const Rig& rig, const std::filesystem::path& folder, const RigPictures& pictures,
                             const std::function<void(std::size_t, std::size_t)>& progress) {
  const std::string file = (folder / "rig.toml").string();
  const auto positions = rig_positions(rig, folder);
  if (!positions) return positions.error();
  const auto camera = RigCamera::create(rig, folder);
  if (!camera) return camera.error();
  BuiltLamp built;
  built.largest_deviation = positions->largest_deviation;
  built.measured.filter = rig.filter;
  LampImages& images = built.measured.irradiance;
  images.planes = planes_of(rig, positions->grid);
  if (images.planes.images() * images.planes.image_size() > static_cast<std::size_t>(kMostPixels))
    return bad(file + ": measurement.pixels of all positions together are " +
               std::to_string(images.planes.images() * images.planes.image_size()) + ", allowed: up to " +
               std::to_string(kMostPixels));
  images.values.assign(images.planes.images() * images.planes.image_size(), Rgb::Zero());

  Bench bench{rig, folder, pictures, *camera, std::nullopt, {}, {0, 0}};
  const auto first = read_picture(bench, rig.pictures[0].file);
  if (!first) return first.error();
  built.picture_size = {first->width, first->height};
  auto view = ScreenView::create(rig, camera->lens(), built.picture_size, file);
  if (!view) return view.error();
  built.mark_rms_px = view->mark_rms_px();
  bench.view = *std::move(view);
  if (const Status dark = read_dark(bench); !dark) return dark.error();

  Vec2d blur = Vec2d::Zero();
  NegativeLight negative;
  for (std::size_t i = 0; i < rig.pictures.size(); ++i) {
    const Rig::Picture& picture = rig.pictures[i];
    const double sign = picture.part == Rig::Part::negative ? -1 : 1;
    const auto [u, v] = positions->grid.at[i];
    const auto added = add_picture(bench, picture, sign * lux_to_measured(rig), images.image(u, v));
    if (!added) return added.error();
    if (const Status good = check_saturation(rig, added->saturated, (folder / picture.file).string()); !good)
      return good.error();
    built.most_saturated = std::max(built.most_saturated, added->saturated);
    negative.add(picture, *added);
    blur += added->blur / static_cast<double>(rig.pictures.size());
    if (progress) progress(i + 1, rig.pictures.size());
  }
  if (const Status good = negative.check(bench); !good) return good.error();
  built.most_negative = negative.part();
  // Beyond a quarter, as of pixels of the camera larger than the map's, noise would grow for little.
  restore_centres(images, blur.cwiseMin(0.25));
  remark_on_positions(*positions, built);
  built.lamp = {rig.name, point_sources(built.measured), std::nullopt};
  if (const Status light = check_light(file, built); !light) return light.error();
  if (const Status scaled = scale_to_reference(rig, file, built); !scaled) return scaled.error();
  remark_on_borders(built);
  return built;
}

RigPictures exr_pictures(const std::filesystem::path& folder) {
  return [folder](const std::string& file) -> Result<LatLongImage> {
    const auto bytes = read_text_file(folder / file);
    if (!bytes) return bytes.error();
    return read_exr(*bytes, (folder / file).string(), kMostPicturePixels);
  };
}

}  // namespace lightwell::calibration
