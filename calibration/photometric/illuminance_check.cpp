// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/photometric/illuminance_check.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "calibration/photometric/take_frames.h"
#include "lighting/direction.h"
#include "lighting/radiometer.h"

namespace lightwell::calibration {
namespace {

double weight_of(const Meter& meter, const Vec3d& direction) {
  const double cosine = meter.toward.dot(direction);
  return cosine <= 0 ? 0 : meter.cosine ? cosine : 1;
}

// Light that the sensor tells from darkness by one code; a response without a toe has no code for darkness.
double darkness_cd_m2(const Response& response) {
  const double dark = response.code(0);
  return std::max(0.0, response.luminance_cd_m2((std::isfinite(dark) ? dark : response.black_code) + 1));
}

double luminance(double r, double g, double b) {
  return 0.2126 * r + 0.7152 * g + 0.0722 * b;
}

// Σ over the pixels of a map: solid angle × the meter's weight × what `value` makes of the pixel
template <class Value>
double integral(const LatLongImage& image, const Meter& meter, Value value) {
  double sum = 0;
  for (int y = 0; y < image.height; ++y) {
    const double top = kPi * y / image.height, bottom = kPi * (y + 1) / image.height;
    const double sr = 2 * kPi / image.width * (std::cos(top) - std::cos(bottom));
    for (int x = 0; x < image.width; ++x) {
      const Rgb& p = image.pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                                  static_cast<std::size_t>(x)];
      const Vec3d d = direction_from_lat_long((x + 0.5) / image.width, (y + 0.5) / image.height);
      sum += sr * weight_of(meter, d) * value(p);
    }
  }
  return sum;
}

}  // namespace

double illuminance_lux(const LatLongImage& image, const Meter& meter) {
  return integral(image, meter, [](const Rgb& p) {
    return luminance(static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2]));
  });
}

double lit_part(const LatLongImage& image, const Meter& meter) {
  const double whole = integral(image, meter, [](const Rgb&) { return 1.0; });
  return whole > 0 ? integral(image, meter, [](const Rgb& p) { return p.maxCoeff() > 0 ? 1.0 : 0.0; }) / whole
                   : 0;
}

Result<RecordedIlluminance> recorded_illuminance(const std::filesystem::path& recording,
                                                 const Calibration& calibration, const Meter& meter) {
  const auto in_file = [&](const Error& e) { return Error{e.kind, recording.string() + ": " + e.message}; };
  auto take = TakeFrames::open(recording);
  if (!take) return take.error();
  auto radiometer = Radiometer::create(calibration, take->format(), {});
  if (!radiometer) return in_file(radiometer.error());
  PolarMap map = radiometer->make_map();
  std::vector<double> weight;  // of each bin: solid angle × cosine
  double whole = 0;
  for (int ring = 0; ring < map.grid.rings; ++ring)
    for (int sector = 0; sector < map.grid.sectors; ++sector) {
      const double theta = (map.grid.ring_edge_rad(ring) + map.grid.ring_edge_rad(ring + 1)) / 2;
      const double lambda = 2 * kPi * (sector + 0.5) / map.grid.sectors;
      const double w = weight_of(meter, direction_from_spherical({theta, lambda}));
      weight.push_back(w * static_cast<double>(map.solid_angle_sr[weight.size()]));
      whole += weight.back();
    }
  RecordedIlluminance out;
  out.measured_part = std::min(1.0, whole / (meter.cosine ? kPi : 2 * kPi));
  double square = 0;
  const auto measure = [&](const RecordedFrame& frame, std::span<const std::byte> codes) -> Status {
    if (!(frame.exposure_us > 0)) return Error{ErrorKind::bad_input, "a frame has no exposure"};
    radiometer->develop(codes, frame.exposure_us, map);
    double lux = 0;
    for (std::size_t b = 0; b < weight.size(); ++b) {
      const auto at = [&](int channel) { return static_cast<double>(map.plane(channel)[b]); };
      lux += weight[b] * (map.channels == 3 ? luminance(at(0), at(1), at(2)) : at(0));
    }
    ++out.frames;
    out.darkness_lux =
        std::max(out.darkness_lux, whole * darkness_cd_m2(calibration.response) *
                                       calibration.response.reference_exposure_us / frame.exposure_us);
    const double step = lux - out.lux;
    out.lux += step / static_cast<double>(out.frames);
    square += step * (lux - out.lux);
    out.clipped = std::max(out.clipped, static_cast<std::uint64_t>(map.clipped_pixels));
    return {};
  };
  if (const Status status = take->for_each(measure); !status) return status.error();
  if (out.frames > 1) out.sigma_lux = std::sqrt(square / static_cast<double>(out.frames - 1));
  return out;
}

}  // namespace lightwell::calibration
