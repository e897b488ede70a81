// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/lamp_sources.h"

#include <algorithm>
#include <cmath>

namespace lightwell::render {
namespace {

constexpr double kStep_deg = 0.5;       // of a far field whose nodes lie on no circle of even steps
constexpr double kLeastStep_deg = 0.1;  // finer tables are drawn at half a degree too
constexpr int kMostNodes = 4096;        // a side, that a table may be refined to

// The even step that has all these angles among its multiples, and divides `whole`; 0: there is none.
double even_step(const std::vector<double>& deg, double whole) {
  if (deg.size() < 2) return whole;
  double step = whole;
  for (std::size_t i = 1; i < deg.size(); ++i) step = std::min(step, deg[i] - deg[i - 1]);
  const auto divides = [&](double angle) {
    const double times = angle / step;
    return std::abs(times - std::round(times)) < 1e-6 * std::max(1.0, std::abs(times));
  };
  if (step < kLeastStep_deg || !divides(whole) || !std::all_of(deg.begin(), deg.end(), divides)) return 0;
  return step;
}

// In how many parts a step is taken that is so much coarser than the other axis's.
int parts_of(double step, double other, double whole) {
  const int most = std::max(1, static_cast<int>(kMostNodes * step / whole));
  return std::clamp(static_cast<int>(std::lround(step / other)), 1, most);
}

// Adds an image moved by so many pixels, which need not be whole: shared out to four, no light is lost.
void add_moved(const Rgb* from, int width, int height, const Vec2d& by, Rgb* to, int to_width) {
  const Vec2d corner = by.array().floor();
  const Vec2d part = by - corner;
  const auto x0 = static_cast<int>(corner.x()), y0 = static_cast<int>(corner.y());
  const float weights[4] = {
      static_cast<float>((1 - part.x()) * (1 - part.y())), static_cast<float>(part.x() * (1 - part.y())),
      static_cast<float>((1 - part.x()) * part.y()), static_cast<float>(part.x() * part.y())};
  for (int corner_of = 0; corner_of < 4; ++corner_of) {
    const float weight = weights[corner_of];
    if (weight == 0) continue;
    for (int y = 0; y < height; ++y) {
      const Rgb* source = from + static_cast<std::ptrdiff_t>(y) * width;
      Rgb* target = to + static_cast<std::ptrdiff_t>(y + y0 + corner_of / 2) * to_width + x0 + corner_of % 2;
      for (int x = 0; x < width; ++x) target[x] += weight * source[x];
    }
  }
}

}  // namespace

bool LampSources::is_grey() const {
  return std::all_of(pixels.begin(), pixels.end(), [](const Rgb& p) { return p[0] == p[1] && p[1] == p[2]; });
}

float LampSources::brightest() const {
  float most = 0;
  for (const Rgb& p : pixels) most = std::max(most, p.abs().maxCoeff());
  return most;
}

std::vector<double> position_fluxes(const NearField& lamp) {
  const LampPlanes& planes = lamp.intensity.planes;
  std::vector<double> fluxes;
  fluxes.reserve(planes.images());
  for (int v = 0; v < planes.positions[1]; ++v)
    for (int u = 0; u < planes.positions[0]; ++u) {
      const Rgb* pixel = lamp.intensity.image(u, v);
      double flux = 0;
      for (int t = 0; t < planes.pixels[1]; ++t)
        for (int s = 0; s < planes.pixels[0]; ++s, ++pixel)
          flux += static_cast<double>(luminance(*pixel)) *
                  planes.pixel_solid_angle_sr(planes.position(u, v), s, t);
      fluxes.push_back(flux);
    }
  return fluxes;
}

LampGroups group_positions(const LampPlanes& planes, const std::vector<double>& fluxes, int group) {
  LampGroups groups;
  const int columns = (planes.positions[0] + group - 1) / group;
  const int rows = (planes.positions[1] + group - 1) / group;
  const auto count = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  groups.middles.assign(count, Vec2d::Zero());
  groups.fluxes.assign(count, 0.0);
  std::vector<Vec2d> even(count, Vec2d::Zero());
  std::vector<int> members(count, 0);
  for (int v = 0; v < planes.positions[1]; ++v)
    for (int u = 0; u < planes.positions[0]; ++u) {
      const auto g = static_cast<std::size_t>((v / group) * columns + u / group);
      const double flux = std::max(fluxes[planes.image(u, v)], 0.0);
      groups.group_of.push_back(g);
      groups.middles[g] += flux * planes.position(u, v);
      groups.fluxes[g] += flux;
      even[g] += planes.position(u, v);
      ++members[g];
    }
  for (std::size_t g = 0; g < count; ++g)
    groups.middles[g] = groups.fluxes[g] > 0 ? Vec2d(groups.middles[g] / groups.fluxes[g])
                                             : Vec2d(even[g] / static_cast<double>(members[g]));
  return groups;
}

std::size_t source_count(const NearField& lamp, int group) {
  const auto along = [&](int positions) { return static_cast<std::size_t>((positions + group - 1) / group); };
  return along(lamp.intensity.planes.positions[0]) * along(lamp.intensity.planes.positions[1]);
}

int least_group(const NearField& lamp) {
  int group = 1;
  while (group < largest_group(lamp) &&
         (source_count(lamp, group) > kMostSources ||
          source_count(lamp, group) * lamp.intensity.planes.image_size() > kMostTexels))
    ++group;
  return group;
}

int largest_group(const NearField& lamp) {
  return std::max(lamp.intensity.planes.positions[0], lamp.intensity.planes.positions[1]);
}

LampSources sources_of(const NearField& lamp, int group) {
  const LampPlanes& planes = lamp.intensity.planes;
  const LampGroups groups = group_positions(planes, position_fluxes(lamp), group);
  const bool on_plane = planes.map == LampMap::plane;
  const Vec2d pixel = planes.pixel_m();
  // The same direction from another position meets the plane as far away as the positions are: images are added up moved.
  const auto first_corner = [&](int u, int v) { return Vec2d(planes.low_m - planes.position(u, v)); };
  LampSources out;
  out.map = on_plane ? SourceMap::plane : SourceMap::hemisphere;
  out.width = planes.pixels[0];
  out.height = planes.pixels[1];
  if (on_plane && group > 1) {
    const auto wider = [&](int axis) {
      const int members = std::min(group, planes.positions[static_cast<std::size_t>(axis)]);
      return 1 + static_cast<int>(std::ceil((members - 1) * planes.spacing_m / pixel[axis]));
    };
    out.width += wider(0);
    out.height += wider(1);
  }
  out.radius_m = group * planes.spacing_m / std::sqrt(kPi);
  out.span = pixel.cwiseProduct(Vec2d(out.width, out.height)) / planes.distance_m;
  for (int v = 0; v < planes.positions[1]; v += group)
    for (int u = 0; u < planes.positions[0]; u += group) {
      const int last_u = std::min(u + group, planes.positions[0]) - 1;
      const int last_v = std::min(v + group, planes.positions[1]) - 1;
      std::vector<Rgb> image(out.image_size(), Rgb::Zero());
      const Vec2d low = first_corner(last_u, last_v);
      for (int j = v; j <= last_v; ++j)
        for (int i = u; i <= last_u; ++i) {
          const Vec2d by =
              on_plane ? Vec2d((first_corner(i, j) - low).cwiseQuotient(pixel)) : Vec2d(Vec2d::Zero());
          add_moved(lamp.intensity.image(i, j), planes.pixels[0], planes.pixels[1], by, image.data(),
                    out.width);
        }
      if (std::all_of(image.begin(), image.end(), [](const Rgb& p) { return (p == 0).all(); })) continue;
      out.sources.push_back(
          {planes.place(groups.middles[groups.group_of[planes.image(u, v)]]), low / planes.distance_m});
      out.pixels.insert(out.pixels.end(), image.begin(), image.end());
    }
  return out;
}

LampSources sources_of(const FarField& lamp, const Vec3d& centre) {
  const bool of_c = lamp.system == PhotometricSystem::c;
  double across = of_c ? even_step(lamp.horizontal_deg, 360) : 0;
  double along = of_c ? even_step(lamp.vertical_deg, 180) : 0;
  if (across == 0) across = kStep_deg;
  if (along == 0) along = kStep_deg;
  // A table that ends bright ends sharply: in a step of the picture's, not of the table's.
  const auto bright_end = [&](std::size_t v) {
    for (std::size_t h = 0; h < lamp.horizontal_deg.size(); ++h)
      if (lamp.at(h, v) > 0) return true;
    return false;
  };
  const bool cut = (lamp.vertical_deg.front() > 0 && bright_end(0)) ||
                   (lamp.vertical_deg.back() < 180 && bright_end(lamp.vertical_deg.size() - 1));
  if (cut && along > kStep_deg) along /= std::ceil(along / kStep_deg);
  // Levels of an image are halved along both axes: steps as wide as they are high, or the coarser axis would be blurred
  // for the finer one's sake. The table's nodes stay among them. A lamp that is the same all around needs one column.
  const double table_across = across;
  if (across < 360) across /= parts_of(across, along, 360);
  if (across < 360) along /= parts_of(along, table_across, 180);
  LampSources out;
  out.map = SourceMap::sphere;
  out.width = static_cast<int>(std::lround(360 / across));
  out.height = static_cast<int>(std::lround(180 / along)) + 1;
  for (int row = 0; row < out.height; ++row)
    for (int column = 0; column < out.width; ++column) {
      const PhotometricAngles angles{column * across, row * along};
      const double candela = of_c ? intensity(lamp, angles)
                                  : intensity(lamp, photometric_direction(PhotometricSystem::c, angles));
      out.pixels.emplace_back(Rgb::Constant(static_cast<float>(candela)));
    }
  if (out.brightest() > 0)
    out.sources.push_back({centre, Vec2d::Zero()});
  else
    out.pixels.clear();
  return out;
}

}  // namespace lightwell::render
