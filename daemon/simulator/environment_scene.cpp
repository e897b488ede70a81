// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "daemon/simulator/scene.h"
#include "interface/environment_io.h"

namespace lightwell::simulator {
namespace {

class EnvironmentScene final : public Scene {
 public:
  EnvironmentScene(std::vector<LatLongImage> images, double hold_s)
      : images_(std::move(images)), hold_s_(hold_s) {
    for (const LatLongImage& image : images_)
      for (const Rgb& p : image.pixels) brightest_ = std::max(brightest_, static_cast<double>(p.maxCoeff()));
  }

  SceneMoment at(double begin_s, double end_s) const override {
    const auto count = static_cast<double>(images_.size());
    const double turn = std::floor((begin_s + end_s) / 2 / hold_s_);
    const double index = turn - count * std::floor(turn / count);
    SceneMoment moment;
    moment.parts = {{static_cast<std::int64_t>(index), 1}};
    return moment;
  }

  Layer layer(std::int64_t id) const override { return {images_[static_cast<std::size_t>(id)], false}; }

  std::vector<std::int64_t> lasting_layers() const override {
    std::vector<std::int64_t> ids;
    for (std::size_t i = 0; i < images_.size(); ++i) ids.push_back(static_cast<std::int64_t>(i));
    return ids;
  }

  double brightest_cd_m2() const override { return brightest_; }

 private:
  std::vector<LatLongImage> images_;
  double hold_s_;
  double brightest_ = 0;
};

}  // namespace

std::shared_ptr<const Scene> make_image_scene(std::vector<LatLongImage> images, double hold_s) {
  return std::make_shared<EnvironmentScene>(std::move(images), hold_s);
}

Result<std::shared_ptr<const Scene>> make_environment_scene(const std::vector<std::filesystem::path>& files,
                                                            double hold_s,
                                                            std::vector<std::string>& messages) {
  std::vector<LatLongImage> images;
  for (const auto& file : files) {
    auto environment = read_environment(file);
    if (!environment) return environment.error();
    if (std::string remark = environment->remark(file); !remark.empty())
      messages.push_back(std::move(remark));
    images.push_back(std::move(environment->image));
  }
  return make_image_scene(std::move(images), hold_s);
}

}  // namespace lightwell::simulator
