// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// walk_pictures scenes FOLDER: ground.gltf and set.gltf, what stands on the stage of the simulated walk.
// walk_pictures truth SCENE.gltf WIDTH HEIGHT OUT.exr: how the stage's own light shows it, traced.
// walk_pictures sheet OUT.png TRUTH.exr PICTURE.exr...: all in a row, as TRUTH's exposure has them; prints their errors.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>

#include "bench/pictures/picture_error.h"
#include "bench/pictures/ray_tracer.h"
#include "bench/pictures/walk_scenes.h"
#include "daemon/simulator/walk_stage.h"
#include "interface/atomic_file.h"
#include "lighting/direction.h"
#include "render/gltf_scene.h"

namespace {

using namespace lightwell;  // NOLINT(google-build-using-namespace)

constexpr int kWallRows = 24;     // of directions, from the zenith to the horizon
constexpr int kLampSamples = 64;  // of each lamp and lens
constexpr int kGap = 4;

// Lamps and lenses in parts, and the walls by equal steps of the hemisphere.
void stage_lights_in_parts(const Vec3f& at, std::vector<DirectionalLight>& lights) {
  const Vec3d point = at.cast<double>();
  for (const simulator::DiscLight& lamp : simulator::stage_lights(point)) {
    if (!(lamp.illuminance.maxCoeff() > 0)) continue;
    for (const Vec3d& d : simulator::disc_samples(lamp, kLampSamples))
      lights.push_back({d.cast<float>(), (lamp.illuminance / kLampSamples).cast<float>(), -1, 0});
  }
  for (int i = 0; i < kWallRows; ++i) {
    const double top = kPi / 2 * i / kWallRows, bottom = kPi / 2 * (i + 1) / kWallRows;
    const int around =
        std::max(4, static_cast<int>(std::lround(4 * kWallRows * std::sin((top + bottom) / 2))));
    const double solid_angle_sr = 2 * kPi / around * (std::cos(top) - std::cos(bottom));
    for (int j = 0; j < around; ++j) {
      const Vec3d d = direction_from_spherical({(top + bottom) / 2, 2 * kPi * (j + 0.5) / around});
      lights.push_back({d.cast<float>(),
                        (simulator::stage_wall_radiance(point, d) * solid_angle_sr).cast<float>(), -1, 0});
    }
  }
}

Status make_scenes(const std::filesystem::path& folder) {
  if (Status s = write_file_atomically(folder / "ground.gltf", pictures::walk_ground_gltf()); !s) return s;
  return write_file_atomically(folder / "set.gltf", pictures::walk_set_gltf());
}

Status make_truth(const std::filesystem::path& file, int width, int height,
                  const std::filesystem::path& out) {
  const auto scene = render::read_gltf(file);
  if (!scene) return scene.error();
  const auto tracer = pictures::RayTracer::create(*scene, pictures::Edges::watertight);
  if (!tracer) return tracer.error();
  const auto picture =
      tracer->picture(scene->cameras.at(0), width, height, pictures::LightsAt(stage_lights_in_parts),
                      static_cast<int>(std::max(1u, std::thread::hardware_concurrency())));
  return pictures::write_reference(out, pictures::reference_of(picture));
}

std::uint8_t code_of(float linear) {  // IEC 61966-2-1
  const float c = std::clamp(linear, 0.0f, 1.0f);
  const float encoded = c <= 0.0031308f ? 12.92f * c : 1.055f * std::pow(c, 1 / 2.4f) - 0.055f;
  return static_cast<std::uint8_t>(std::lround(255 * encoded));
}

Status make_sheet(const std::filesystem::path& out, const std::vector<std::filesystem::path>& files) {
  std::vector<pictures::Reference> all;
  for (const auto& file : files) {
    auto picture = pictures::read_reference(file);
    if (!picture) return picture.error();
    all.push_back(*std::move(picture));
    if (all.back().width != all[0].width || all.back().height != all[0].height)
      return Error{ErrorKind::bad_input, file.string() + ": is not of the size of " + files[0].string()};
  }
  const int width = all[0].width, height = all[0].height, count = static_cast<int>(all.size());
  render::DisplayPicture sheet{count * width + (count - 1) * kGap, height, {}};
  sheet.rgba.assign(static_cast<std::size_t>(sheet.width) * static_cast<std::size_t>(height) * 4, 255);
  for (int i = 0; i < count; ++i) {
    const auto& radiance = all[static_cast<std::size_t>(i)].radiance;
    const auto shown = pictures::displayed(radiance, all[0]).pixels;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        for (int c = 0; c < 3; ++c)
          sheet.rgba[4 * static_cast<std::size_t>(y * sheet.width + i * (width + kGap) + x) +
                     static_cast<std::size_t>(c)] =
              code_of(shown[static_cast<std::size_t>(y * width + x)][c]);
    const pictures::PictureError error = pictures::picture_error(radiance, all[0]);
    std::printf("%s: relative RMSE %.4f, bias %+.4f, FLIP %.4f\n", files[static_cast<std::size_t>(i)].c_str(),
                error.relative_rmse, error.bias, error.flip);
  }
  return render::write_png(out, sheet);
}

}  // namespace

int main(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "";
  Status made;
  if (what == "scenes" && argc == 3) {
    made = make_scenes(argv[2]);
  } else if (what == "truth" && argc == 6 && std::atoi(argv[3]) > 0 && std::atoi(argv[4]) > 0) {
    made = make_truth(argv[2], std::atoi(argv[3]), std::atoi(argv[4]), argv[5]);
  } else if (what == "sheet" && argc >= 4) {
    made = make_sheet(argv[2], {argv + 3, argv + argc});
  } else {
    std::fprintf(stderr,
                 "usage: walk_pictures scenes FOLDER | truth SCENE.gltf WIDTH HEIGHT OUT.exr | "
                 "sheet OUT.png TRUTH.exr PICTURE.exr...\n");
    return 2;
  }
  if (made) return 0;
  std::fprintf(stderr, "walk_pictures: %s\n", made.error().message.c_str());
  return static_cast<int>(made.error().kind);
}
