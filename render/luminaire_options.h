// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <string>
#include <vector>

#include "lighting/result.h"
#include "lighting/vector.h"

namespace CLI {
class App;
}

namespace lightwell::render {

// A lamp of the command line.
struct LuminaireOptions {
  std::filesystem::path file;
  // In the world, or on the node. Yaw turns about +Y (to the left), pitch about the turned +X (up), roll about the lamp's
  // own +Z, right-handed all; at zero it shines along −Z, as glTF's cameras look and its spot lights shine.
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  double scale = 1;  // times its light
  std::string node;  // of the scene; empty: the world
};

// What is typed: the n-th of each belongs to the n-th lamp.
class LuminaireArguments {
 public:
  // The arguments must outlive the app.
  void add_to(CLI::App& app);
  // usage: more poses, scales or nodes than lamps, or a pose that is none
  [[nodiscard]] Result<std::vector<LuminaireOptions>> lamps() const;
  [[nodiscard]] double max_error() const { return max_error_; }

 private:
  std::vector<std::string> files_, poses_, nodes_;
  std::vector<double> scales_;
  double max_error_ = 0.01;
};

}  // namespace lightwell::render
