// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/field_pictures.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <utility>

#include "cli/command.h"
#include "field/field_state.h"
#include "interface/atomic_file.h"
#include "interface/calibration_io.h"
#include "interface/environment_io.h"
#include "interface/option_range.h"

namespace lightwell::cli {
namespace {

// cd/m²: more than half a million suns. Fits and what stands over them take squares, which 1e19 has not in floats.
constexpr float kMostRadiance = 1e15f;

}  // namespace

void add_picture_options(CLI::App& command, PictureArguments& o) {
  o.options = {
      command.add_option("--projection", o.projection, "Of the images: latlong, mirror-ball, fisheye")
          ->capture_default_str()
          ->type_name("NAME"),
      command
          .add_option("--ball-radius", o.ball_radius_m,
                      "Mirror ball's radius, metres: its rays start on its surface")
          ->check(numbers_above_0_to(10, "above 0 to 10 metres"))
          ->type_name("M"),
      command
          .add_option("--camera-distance", o.camera_distance_m,
                      "From the mirror ball's centre to the camera, metres; else as if from far away")
          ->check(numbers_above_0_to(1000, "above 0 to 1000 metres"))
          ->type_name("M"),
      command
          .add_option("--blind-cone", o.blind_cone_deg,
                      "Half angle behind the mirror ball of which its rim shows nothing")
          ->check(numbers_from(0, 60, "0 to 60 degrees"))
          ->capture_default_str()
          ->type_name("DEG"),
      command.add_option("--lens", o.lens, "lens.json of a fisheye probe")->type_name("FILE")};
}

Status check_no_picture_options(const PictureArguments& o) {
  for (const CLI::Option* option : o.options)
    if (option->count() > 0)
      return usage(option->get_name() +
                   " needs a list of pictures, allowed: PROBES.csv in place of a recording");
  return {};
}

Result<ProbeProjection> projection_of(const PictureArguments& o) {
  if (o.projection != "fisheye" && !o.lens.empty()) return usage("--lens needs --projection fisheye");
  if (o.projection != "mirror-ball" && (o.ball_radius_m > 0 || o.camera_distance_m))
    return usage("--ball-radius and --camera-distance need --projection mirror-ball");
  if (o.projection == "latlong") return ProbeProjection(LatLongProbe{});
  if (o.projection == "mirror-ball") {
    if (o.camera_distance_m && !(o.ball_radius_m > 0)) return usage("--camera-distance needs --ball-radius");
    if (o.camera_distance_m && !(*o.camera_distance_m > o.ball_radius_m))
      return usage("--camera-distance is " + std::to_string(*o.camera_distance_m) +
                   ", allowed: above --ball-radius, from the ball's centre");
    return ProbeProjection(
        MirrorBallProbe{o.ball_radius_m, o.camera_distance_m, o.blind_cone_deg * kPi / 180});
  }
  if (o.projection != "fisheye")
    return usage("--projection is " + o.projection + ", allowed: latlong, mirror-ball, fisheye");
  if (o.lens.empty()) return usage("--projection fisheye needs --lens lens.json");
  auto lens = read_lens(o.lens);
  if (!lens) return lens.error();
  return ProbeProjection(FisheyeProbe{*std::move(lens)});
}

Result<std::string> origin_of(const PictureArguments& o, const ProbeList& list) {
  std::string lens;
  if (!o.lens.empty()) {
    auto read = read_text_file(o.lens);
    if (!read) return read.error();
    lens = *std::move(read);
  }
  std::uint64_t mark = fnv1a(lens);
  char text[200];
  for (std::size_t i = 0; i < list.files.size(); ++i) {
    std::error_code error, ignored;
    const auto time = std::filesystem::last_write_time(list.files[i], error).time_since_epoch().count();
    if (error)
      return Error{ErrorKind::bad_input, list.files[i].string() + ": cannot read: " + error.message()};
    const auto size = std::filesystem::file_size(list.files[i], ignored);  // none of a pipe
    const Vec3d& at = list.positions[i];
    std::snprintf(text, sizeof text, "%.17g %.17g %.17g %ju %jd ", at.x(), at.y(), at.z(),
                  static_cast<std::uintmax_t>(size), static_cast<std::intmax_t>(time));
    mark = fnv1a(list.files[i].string() + '\n', fnv1a(text, mark));
  }
  std::snprintf(text, sizeof text, "%s ball %.17g camera %.17g blind %.17g files %016jx",
                o.projection.c_str(), o.ball_radius_m, o.camera_distance_m.value_or(0), o.blind_cone_deg,
                static_cast<std::uintmax_t>(mark));
  return std::string(text);
}

void PictureFaults::set(std::size_t picture, std::uint64_t unseen_pixels, std::uint64_t negative_values) {
  if (unseen_pixels + negative_values == 0) return;
  const std::scoped_lock lock(mutex_);
  faults_[picture] = {unseen_pixels, negative_values};
}

std::vector<std::string> PictureFaults::remarks(const ProbeTake& take, FieldRanks& ranks) const {
  std::vector<std::uint64_t> counts(2 * take.positions.size());
  for (const auto& [picture, faults] : faults_)
    if (picture > 0 || ranks.rank() == 0)  // each rank has looked at the first one
      std::copy(faults.begin(), faults.end(), counts.begin() + 2 * static_cast<std::ptrdiff_t>(picture));
  ranks.sum(counts);
  std::vector<std::string> lines;
  const auto add = [&](std::size_t which, const std::string& what) {
    std::uint64_t count = 0, pictures = 0;
    std::string first;
    for (std::size_t i = which; i < counts.size(); i += 2) {
      if (counts[i] == 0) continue;
      count += counts[i];
      if (pictures++ == 0) first = take.name(i / 2);
    }
    if (count == 0) return;
    std::string who = first;
    if (pictures > 1) who += " and " + std::to_string(pictures - 1) + (pictures > 2 ? " others" : " other");
    lines.push_back(who + ": " + std::to_string(count) + what);
  };
  add(0, " pixels are NaN, infinite or above 1e15 cd/m²; taken as not seen");
  add(1, " values are negative; read as 0");
  return lines;
}

ProbeTake take_of(ProbeList pictures, std::shared_ptr<PictureFaults> faults) {
  const auto list = std::make_shared<const ProbeList>(std::move(pictures));
  ProbeTake take;
  take.positions = list->positions;
  take.name = [list](std::size_t i) { return list->files[i].string(); };
  take.picture = [list, faults](std::size_t i) -> Result<LatLongImage> {
    auto environment = read_environment(list->files[i], NotFinite::kept);
    if (!environment) return environment.error();
    std::uint64_t unseen = 0;
    for (Rgb& pixel : environment->image.pixels)
      if (!(pixel.abs() <= kMostRadiance).all()) {
        pixel.setConstant(std::numeric_limits<float>::quiet_NaN());
        ++unseen;
      }
    faults->set(i, unseen, environment->negative);
    return std::move(environment->image);
  };
  return take;
}

}  // namespace lightwell::cli
