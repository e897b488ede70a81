// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/light_source.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "interface/environment_io.h"
#include "interface/field_file.h"
#include "interface/printable.h"
#include "lighting/decomposition/best_lights.h"
#include "render/live_news.h"

namespace lightwell::render {
namespace {

class FixedLights final : public LightSource {
 public:
  explicit FixedLights(LightSet lights) { lights_ = std::move(lights); }
  Result<bool> update(int frame, std::chrono::milliseconds /*wait*/) override { return frame == 0; }
};

class FieldLight final : public LightSource {
 public:
  explicit FieldLight(LightField field) : field_(std::move(field)) {}
  Result<bool> update(int frame, std::chrono::milliseconds /*wait*/) override { return frame == 0; }
  [[nodiscard]] const LightField* field() const override { return &field_; }
  [[nodiscard]] int field_version() const override { return 1; }

 private:
  LightField field_;
};

class EnvironmentLights final : public LightSource {
 public:
  EnvironmentLights(EnvironmentOptions options, LatLongImage image)
      : options_(std::move(options)), image_(std::move(image)) {}

  Result<bool> update(int frame, std::chrono::milliseconds /*wait*/) override {
    const double turn_rad = std::remainder(frame * options_.spin_deg, 360.0) * kPi / 180;
    if (made_ && turn_rad == turn_rad_) return false;
    const PolarMap map = polar_map_from_lat_long(image_, options_.coverage == Coverage::hemisphere, turn_rad);
    const auto set = lights_of(map);
    if (!set) return Error{set.error().kind, options_.file.string() + ": " + set.error().message};
    lights_ =
        options_.max_lights > 0 ? take_lights(*set, static_cast<std::size_t>(options_.max_lights)) : *set;
    turn_rad_ = turn_rad;
    made_ = true;
    return true;
  }
  [[nodiscard]] const LatLongImage* environment() const override { return &image_; }
  [[nodiscard]] double environment_turn_rad() const override { return turn_rad_; }
  [[nodiscard]] int environment_version() const override { return 1; }

 private:
  // A map that spins is followed as a live one is.
  Result<LightSet> lights_of(const PolarMap& map) {
    if (options_.method != Method::best || options_.spin_deg == 0 || options_.lights > kMostPlacedLights)
      return decompose(map, options_.method, options_.lights);
    if (!best_) best_.emplace(map.grid, options_.lights, Effort::thorough);
    const auto lights = best_->process(map);
    LightSet set;
    set.method = name(Method::best);
    set.coverage = options_.coverage;
    set.total_illuminance = best_->total_illuminance().cast<float>();
    set.lights.assign(lights.begin(), lights.end());
    set.has_parents = true;
    if (!set.total_illuminance.isFinite().all())
      return Error{ErrorKind::bad_input, "total illuminance is beyond a 32 bit float (3.4e38 lux)"};
    return set;
  }

  EnvironmentOptions options_;
  LatLongImage image_;
  std::optional<BestLights> best_;
  double turn_rad_ = 0;
  bool made_ = false;
};

class LiveLights final : public LightSource {
 public:
  LiveLights(const LiveOptions& options, std::unique_ptr<LightReader> lights,
             std::unique_ptr<EnvironmentReader> environment)
      : max_lights_(static_cast<std::size_t>(options.max_lights)),
        reader_(std::move(lights)),
        environment_reader_(std::move(environment)),
        news_("light", options.dds.domain) {}

  Result<bool> update(int /*frame*/, std::chrono::milliseconds wait) override {
    if (environment_reader_ && environment_reader_->take(environment_frame_, std::chrono::milliseconds(0))) {
      environment_ = lat_long_from_polar_map(environment_frame_.map);
      ++environment_version_;
    }
    const bool arrived = reader_->take(frame_, wait);
    if (arrived) lights_ = take_lights(frame_.light_set(), max_lights_);
    news_.tell(reader_->age(), arrived, "probe '" + reader_->probe() + "'");
    return arrived;
  }

  [[nodiscard]] bool ready() const override { return reader_->age().has_value(); }
  [[nodiscard]] int environment_version() const override { return environment_version_; }
  [[nodiscard]] std::optional<std::chrono::nanoseconds> age() const override { return reader_->age(); }
  [[nodiscard]] const LatLongImage* environment() const override {
    return environment_.pixels.empty() ? nullptr : &environment_;
  }

 private:
  std::size_t max_lights_;
  std::unique_ptr<LightReader> reader_;
  std::unique_ptr<EnvironmentReader> environment_reader_;
  LightFrame frame_;
  EnvironmentFrame environment_frame_;
  LatLongImage environment_;
  int environment_version_ = 0;
  LiveNews news_;
};

}  // namespace

std::unique_ptr<LightSource> fixed_lights(const LightSet& lights, int max_lights) {
  return std::make_unique<FixedLights>(
      max_lights > 0 ? take_lights(lights, static_cast<std::size_t>(max_lights)) : lights);
}

Result<std::unique_ptr<LightSource>> field_light(const std::filesystem::path& file) {
  auto read = read_field(file);
  if (!read) return read.error();
  return std::unique_ptr<LightSource>(std::make_unique<FieldLight>(std::move(read->field)));
}

Result<std::unique_ptr<LightSource>> environment_lights(const EnvironmentOptions& options) {
  auto environment = read_environment(options.file);
  if (!environment) return environment.error();
  if (const std::string remark = environment->remark(options.file); !remark.empty())
    std::fprintf(stderr, "lightwell-render: %s\n", printable(remark).c_str());
  return std::unique_ptr<LightSource>(
      std::make_unique<EnvironmentLights>(options, std::move(environment->image)));
}

Result<std::unique_ptr<LightSource>> live_lights(const LiveOptions& options) {
  auto domain = DdsDomain::open(options.dds);
  if (!domain) return domain.error();
  auto lights = LightReader::create(*domain);
  if (!lights) return lights.error();
  std::unique_ptr<EnvironmentReader> environment;
  if (options.with_environment) {
    auto reader = EnvironmentReader::create(*domain);
    if (!reader) return reader.error();
    environment = std::move(reader).value();
  }
  return std::unique_ptr<LightSource>(
      std::make_unique<LiveLights>(options, std::move(lights).value(), std::move(environment)));
}

}  // namespace lightwell::render
