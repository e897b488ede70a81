// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/luminaire_options.h"

#include <CLI/CLI.hpp>
#include <cmath>
#include <optional>

#include "interface/option_range.h"

namespace lightwell::render {
namespace {

constexpr double kFarthest_m = 1e6;

std::optional<std::vector<double>> numbers_of(const std::string& text) {
  std::vector<double> numbers;
  std::size_t begin = 0;
  while (true) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const auto number = option_range::parse<double>(std::string_view(text).substr(begin, end - begin));
    if (!number || !std::isfinite(*number)) return std::nullopt;
    numbers.push_back(*number);
    if (end == text.size()) return numbers;
    begin = end + 1;
  }
}

Result<Eigen::Isometry3d> pose_of(const std::string& text) {
  const auto bad = [&] {
    return Error{ErrorKind::usage, "--luminaire-pose " + text +
                                       ": must be x,y,z, x,y,z,yaw,pitch,roll or x,y,z,qx,qy,qz,qw; metres "
                                       "from -1e6 to 1e6, degrees from -360 to 360, a unit quaternion"};
  };
  const auto numbers = numbers_of(text);
  if (!numbers || (numbers->size() != 3 && numbers->size() != 6 && numbers->size() != 7)) return bad();
  const std::vector<double>& n = *numbers;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = Vec3d(n[0], n[1], n[2]);
  if (pose.translation().cwiseAbs().maxCoeff() > kFarthest_m) return bad();
  if (n.size() == 6) {
    if (Vec3d(n[3], n[4], n[5]).cwiseAbs().maxCoeff() > 360) return bad();
    const auto turn = [](double deg, const Vec3d& axis) { return Eigen::AngleAxisd(deg * kPi / 180, axis); };
    pose.linear() = (turn(n[3], Vec3d::UnitY()) * turn(n[4], Vec3d::UnitX()) * turn(n[5], Vec3d::UnitZ()))
                        .toRotationMatrix();
  }
  if (n.size() == 7) {
    const Eigen::Quaterniond turn(n[6], n[3], n[4], n[5]);
    if (std::abs(turn.norm() - 1) > 1e-3) return bad();
    pose.linear() = turn.normalized().toRotationMatrix();
  }
  return pose;
}

}  // namespace

void LuminaireArguments::add_to(CLI::App& app) {
  auto* lamps =
      app.add_option("--luminaire", files_,
                     "a lamp near the scene: a file of lightwell luminaire; may be given again, and "
                     "with the light of the other options")
          ->allow_extra_args(false);
  app.add_option(
         "--luminaire-pose", poses_,
         "where it is: x,y,z or x,y,z,yaw,pitch,roll, metres and degrees; at zero it shines along -Z, "
         "yaw turns it left, pitch up (-90: straight down), roll about its own axis. The n-th belongs "
         "to the n-th lamp, as with the next two")
      ->allow_extra_args(false)
      ->needs(lamps);
  app.add_option("--luminaire-scale", scales_, "times its light; 0: off")
      ->check(numbers_from(0, 1e6, "0 to 1e6"))
      ->allow_extra_args(false)
      ->needs(lamps);
  app.add_option("--luminaire-node", nodes_,
                 "the scene's node that carries it and takes it along where it is animated; the pose is then "
                 "on the node. '' or world: none does")
      ->allow_extra_args(false)
      ->needs(lamps);
  app.add_option("--luminaire-error", max_error_,
                 "positions of a lamp are drawn as one where the picture changes by less than this "
                 "(relative); 0: each is drawn")
      ->check(numbers_from(0, 1, "0 to 1"))
      ->capture_default_str()
      ->needs(lamps);
}

Result<std::vector<LuminaireOptions>> LuminaireArguments::lamps() const {
  std::vector<LuminaireOptions> lamps;
  for (const std::string& file : files_) {
    lamps.emplace_back().file = file;
    if (file.empty()) return Error{ErrorKind::usage, "--luminaire '': must be the name of a file"};
  }
  const auto count = [&](const char* option, std::size_t given) -> Status {
    if (given <= lamps.size()) return {};
    return Error{ErrorKind::usage, std::string(option) + ": given " + std::to_string(given) + " times for " +
                                       std::to_string(lamps.size()) +
                                       (lamps.size() == 1 ? " lamp" : " lamps")};
  };
  for (const auto& [option, given] :
       {std::pair("--luminaire-pose", poses_.size()), std::pair("--luminaire-scale", scales_.size()),
        std::pair("--luminaire-node", nodes_.size())})
    if (Status s = count(option, given); !s) return s.error();
  for (std::size_t i = 0; i < poses_.size(); ++i) {
    const auto pose = pose_of(poses_[i]);
    if (!pose) return pose.error();
    lamps[i].pose = *pose;
  }
  for (std::size_t i = 0; i < scales_.size(); ++i) lamps[i].scale = scales_[i];
  for (std::size_t i = 0; i < nodes_.size(); ++i)
    if (nodes_[i] != "world") lamps[i].node = nodes_[i];
  return lamps;
}

}  // namespace lightwell::render
