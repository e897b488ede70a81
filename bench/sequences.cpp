// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "bench/sequences.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <random>
#include <utility>

#include "bench/painting.h"
#include "interface/environment_io.h"
#include "lighting/lat_long_image.h"

namespace lightwell::bench {
namespace {

const PolarGrid kGrid{90, 360, kPi / 2};
const PolarGrid kSphere{180, 360, kPi};
constexpr int kFrames = 96;

using MapPointer = std::shared_ptr<const PolarMap>;

MapPointer painted(const std::function<Rgb(const Vec3d&)>& radiance, const PolarGrid& grid = kGrid) {
  auto map = std::make_shared<PolarMap>(PolarMap::make(grid, 3));
  paint(*map, radiance);
  return map;
}

void copy(const PolarMap& from, PolarMap& map) {
  std::copy(from.radiance.begin(), from.radiance.end(), map.radiance.begin());
}

double smooth_step(double t) {
  const double u = std::clamp(t, 0.0, 1.0);
  return u * u * (3 - 2 * u);
}

Sequence noise(const MapPointer& still) {
  return {"noise 5 %", kFrames, [=](int frame, PolarMap& map) {
            copy(*still, map);
            add_relative_noise(map, 0.05, static_cast<std::uint32_t>(frame));
          }};
}

// Half a degree of arc a frame, rising aslant; the sun is little more than a degree across.
Sequence sun(const std::string& name, const MapPointer& sky, double azimuth_deg) {
  return {name, kFrames, [=](int frame, PolarMap& map) {
            copy(*sky, map);
            const double zenith = 62 - 0.25 * frame;
            const double azimuth = azimuth_deg + 0.433 / std::sin(50 * kPi / 180) * frame;
            add_disc(map, from_degrees(zenith, azimuth), 0.6, Rgb(3600, 3300, 2800));
          }};
}

Sequence pulsing_lamp(const MapPointer& room) {
  return {"pulsing lamp", kFrames, [=](int frame, PolarMap& map) {
            copy(*room, map);
            const double power = 0.5 - 0.5 * std::cos(2 * kPi * frame / 24.0);
            add_disc(map, from_degrees(35, 140), 3, static_cast<float>(power) * Rgb(190, 170, 120));
          }};
}

Sequence turning(const std::string& name, const MapPointer& from, double deg_per_frame, double sigma) {
  return {name, kFrames, [=](int frame, PolarMap& map) {
            turn_about_zenith(*from, deg_per_frame * frame, map);
            if (sigma > 0) add_relative_noise(map, sigma, static_cast<std::uint32_t>(frame));
          }};
}

// Each lamp has its own colour and place, and stays on or off for 4 to 40 frames.
Sequence lamps_switching(const MapPointer& room) {
  struct Lamp {
    Vec3d direction;
    Rgb illuminance;
    std::vector<bool> on;
  };
  auto lamps = std::make_shared<std::vector<Lamp>>();
  std::mt19937 random(11);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random()) * 0x1p-32;
  };
  for (int i = 0; i < 40; ++i) {
    Lamp lamp;
    lamp.direction = from_degrees(std::acos(uniform(0.05, 0.98)) * 180 / kPi, uniform(0, 360));
    for (int c = 0; c < 3; ++c) lamp.illuminance[c] = static_cast<float>(uniform(8, 40));
    bool on = random() % 2 == 0;
    while (lamp.on.size() < kFrames) {
      lamp.on.insert(lamp.on.end(), static_cast<std::size_t>(uniform(4, 40)), on);
      on = !on;
    }
    lamps->push_back(std::move(lamp));
  }
  return {"40 lamps switching", kFrames, [=](int frame, PolarMap& map) {
            copy(*room, map);
            for (const Lamp& lamp : *lamps)
              if (lamp.on[static_cast<std::size_t>(frame)])
                add_disc(map, lamp.direction, 1.5, lamp.illuminance);
          }};
}

// Clouds drift; where one is before the sun its light falls to 2 %, and the cloud shines.
Sequence clouds_over_sun() {
  auto directions = std::make_shared<const std::vector<Vec3f>>(bin_directions(kGrid));
  return {"clouds over the sun", 120, [=](int frame, PolarMap& map) {
            const double drift = 0.03 * frame;
            const Vec3d sun = from_degrees(45, 210);
            const auto cover = [&](double x, double y, double z) {
              const double slant = 1.2 / std::max(0.12, y);
              return smooth_step((cloud_noise(x * slant + drift, z * slant + 0.4 * drift, 23) - 0.42) / 0.2);
            };
            for (std::size_t bin = 0; bin < directions->size(); ++bin) {
              const Vec3f& d = (*directions)[bin];
              const auto y = static_cast<double>(d.y());
              const double cloud = cover(static_cast<double>(d.x()), y, static_cast<double>(d.z()));
              const double blue = 900 * (1 + std::pow(1 - y, 3));
              const double near = std::pow(std::max(0.0, sun.dot(d.cast<double>())), 8);
              const double white = 1500 + 6000 * near;
              const std::array<double, 3> tint = {0.6, 0.9, 1.6};
              for (int c = 0; c < 3; ++c) {
                const double clear = blue * tint[static_cast<std::size_t>(c)];
                map.plane(c)[bin] = static_cast<float>(clear + cloud * (white - clear));
              }
            }
            const double through = std::exp(-4 * cover(sun.x(), sun.y(), sun.z()));
            add_disc(map, sun, 1, static_cast<float>(through) * Rgb(16000, 15000, 13000));
          }};
}

// A dark body, its head above the windows' middle, walks past both windows and back.
Sequence person(const MapPointer& room) {
  return {"person crossing the windows", 120, [=](int frame, PolarMap& map) {
            copy(*room, map);
            const double there = frame < 60 ? frame : 120 - frame;
            const double azimuth = 5 + 1.9 * there;
            const double step = 1.2 * std::sin(2 * kPi * frame / 15.0);  // the gait
            const Rgb cloth(6, 5, 5);
            blend_rectangle(map, {58 + step / 2, 90.5, azimuth - 8, azimuth + 8}, cloth);
            blend_rectangle(map, {50 + step / 2, 58 + step / 2, azimuth - 3, azimuth + 3}, Rgb(20, 14, 11));
          }};
}

// A wall of LEDs, a fifth of the horizon: waves of colour, another shot every 24 frames.
Sequence video_wall(const MapPointer& room) {
  return {"wall playing video", 120, [=](int frame, PolarMap& map) {
            copy(*room, map);
            const int shot = frame / 24;
            const double t = frame;
            for (int ring = 45; ring < 80; ++ring)
              for (int sector = 150; sector < 240; ++sector) {
                const auto bin = static_cast<std::size_t>(ring * kGrid.sectors + sector);
                for (int c = 0; c < 3; ++c) {
                  const double wave = 0.5 + 0.5 * std::sin(0.05 * (shot + 1) * sector + 0.11 * ring +
                                                           2.1 * c + 0.13 * t + 1.7 * shot);
                  const double patch = value_noise(0.08 * sector - 0.02 * t, 0.1 * ring,
                                                   static_cast<std::uint32_t>(7 * shot + c));
                  const double level = shot % 2 == 0 ? 700 : 250;
                  map.plane(c)[bin] = static_cast<float>(level * wave * wave * (0.2 + 1.6 * patch));
                }
              }
          }};
}

// The sky fades to a fortieth and turns from blue to red in the west, while twelve lamps come on at their times.
Sequence dusk(const MapPointer& sky) {
  auto glow = painted([](const Vec3d& d) {
    const double west = std::max(0.0, d.dot(from_degrees(85, 250)));
    return Rgb((Rgbd(3000, 1300, 500) * std::pow(west, 6)).cast<float>());
  });
  return {"dusk, lamps switched on", 120, [=](int frame, PolarMap& map) {
            const double t = frame / 119.0;
            const auto day = static_cast<float>(std::exp(-3.7 * t));
            const auto red = static_cast<float>(0.3 * std::exp(-2.5 * t) * (0.3 + t));
            for (std::size_t i = 0; i < map.radiance.size(); ++i)
              map.radiance[i] = 0.3f * day * sky->radiance[i] + red * glow->radiance[i];
            for (int lamp = 0; lamp < 12; ++lamp)
              if (frame >= 20 + 7 * lamp)
                add_disc(map, from_degrees(25 + 13 * lamp % 60, 97.0 * lamp), 1.2, Rgb(60, 50, 30));
          }};
}

// Small smooth turns about all three axes: some degrees, up to about half a degree a frame.
Sequence hand_held(const std::string& name, const MapPointer& sphere) {
  auto view = std::make_shared<const TurnedView>(*sphere, kGrid);
  return {name, kFrames, [=](int frame, PolarMap& map) {
            constexpr double kDegree = kPi / 180;
            const auto sway = [&](double amplitude, double period, double phase) {
              return amplitude * kDegree * std::sin(2 * kPi * frame / period + phase);
            };
            view->look({sway(2.1, 53, 0) + sway(0.5, 17, 1), sway(2.6, 71, 2) + sway(0.4, 19, 3),
                        sway(1.8, 47, 4) + sway(0.5, 15, 5)},
                       map);
          }};
}

// A real map of the whole sphere at one degree, of mean luminance 1000 cd/m²; null where the file is not there.
MapPointer real_sphere(const std::filesystem::path& file) {
  if (!std::filesystem::exists(file)) return nullptr;
  const auto environment = read_environment(file);
  if (!environment) return nullptr;
  PolarMap map = resample_polar(polar_map_from_lat_long(environment->image, false), kSphere);
  const double mean = luminance(total_illuminance(map)) / (4 * kPi);
  if (!(mean > 0)) return nullptr;
  for (float& value : map.radiance) value *= static_cast<float>(1000 / mean);
  return std::make_shared<const PolarMap>(std::move(map));
}

MapPointer upper_half(const PolarMap& sphere) {
  return std::make_shared<const PolarMap>(resample_polar(sphere, kGrid));
}

void add_real(const std::filesystem::path& maps, std::vector<Sequence>& all) {
  // An interior with windows, a high sun, a city at sunset.
  for (const std::string file : {"st_fagans_interior_1k", "kloppenheim_05_1k", "venice_sunset_1k"}) {
    const MapPointer sphere = real_sphere(maps / (file + ".hdr"));
    if (!sphere) continue;
    const MapPointer half = upper_half(*sphere);
    const std::string name = file.substr(0, file.rfind('_'));
    all.push_back(turning("turning " + name, half, 1, 0));
    all.push_back(turning("turning with noise " + name, half, 0.3, 0.02));
    all.push_back(hand_held("hand-held " + name, sphere));
  }
}

}  // namespace

PolarMap sequence_map() {
  return PolarMap::make(kGrid, 3);
}

// Lamps on 50 Hz mains: their light swings at 100 Hz, which a camera of 60 frames a second sees at 20 Hz. Two
// phases; the exposure of 2 ms averages a little. One lamp is switched off at frame 48, and on again at 72.
Sequence mains_flicker() {
  const MapPointer room = painted(room_radiance);
  return {"mains flicker, lamp switched", kFrames, [=](int frame, PolarMap& map) {
            copy(*room, map);
            constexpr double kExposure_s = 0.002;
            constexpr double kLamp_hz = 100;
            constexpr double kRate_hz = 60;
            const double x = kPi * kLamp_hz * kExposure_s;
            const double depth = 0.35 * std::sin(x) / x;
            const auto light = [&](double phase) {
              return static_cast<float>(1 + depth * std::cos(2 * kPi * kLamp_hz / kRate_hz * frame + phase));
            };
            add_disc(map, from_degrees(25, 150), 4, light(0) * Rgb(120, 125, 110));
            add_disc(map, from_degrees(50, 20), 4, light(2 * kPi / 3) * Rgb(90, 95, 85));
            if (frame < kMainsSwitchedFrame || frame >= kMainsSwitchedFrame + 24)
              add_disc(map, from_degrees(40, 280), 3, light(0) * Rgb(150, 155, 140));
          }};
}

Sequence sun_at_rate(double rate_hz) {
  const MapPointer sky = painted(sky_radiance);
  return {"sun at " + std::to_string(static_cast<int>(rate_hz)) + " Hz",
          std::min(120, static_cast<int>(2.5 * rate_hz)), [=](int frame, PolarMap& map) {
            const double t = frame / rate_hz;
            copy(*sky, map);
            add_relative_noise(map, 0.01, static_cast<std::uint32_t>(frame));
            add_disc(map, from_degrees(62 - 10 * t, 100 + 36 * t), 0.6, Rgb(3600, 3300, 2800));
          }};
}

std::vector<Sequence> sequences(const std::filesystem::path& maps) {
  const MapPointer sky = painted(sky_radiance);
  const MapPointer room_sphere = painted(room_radiance, kSphere);
  const MapPointer room = upper_half(*room_sphere);
  std::vector<Sequence> all = {
      noise(room),
      sun("sun 0.5 deg a frame", sky, 100),
      sun("sun crossing azimuth 0", sky, -31),
      pulsing_lamp(room),
      turning("turning room", room, 1, 0),
      lamps_switching(room),
      turning("turning room with noise", room, 0.3, 0.02),
      clouds_over_sun(),
      person(room),
      video_wall(room),
      dusk(sky),
      hand_held("hand-held room", room_sphere),
      mains_flicker(),
  };
  if (!maps.empty()) add_real(maps, all);
  return all;
}

}  // namespace lightwell::bench
