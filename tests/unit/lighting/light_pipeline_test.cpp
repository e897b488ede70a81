// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/light_pipeline.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/allocation_counter.h"
#include "tests/support/sampling_maps.h"

namespace lightwell {
namespace {

using Sampler = LightPipelineOptions::Sampler;

LightPipelineOptions plain(int count, Sampler sampler = Sampler::havran) {
  LightPipelineOptions options;
  options.count = count;
  options.sampler = sampler;
  options.filter = TemporalFilter::none;
  options.clusters = 0;
  return options;
}

LightPipeline make(const PolarMap& map, const LightPipelineOptions& options) {
  auto pipeline = LightPipeline::create(map.grid, map.channels, options);
  EXPECT_TRUE(pipeline.ok());
  return std::move(pipeline).value();
}

Rgbd sum(std::span<const DirectionalLight> lights) {
  Rgbd total = Rgbd::Zero();
  for (const auto& light : lights) total += light.illuminance.cast<double>();
  return total;
}

double relative(const Rgbd& a, const Rgbd& b) {
  return ((a - b).abs() / b.max(1e-30)).maxCoeff();
}

TEST(LightPipeline, TotalPowerIsExactAfterEveryStage) {
  for (const auto& [name, map] : test::hard_maps())
    for (const Sampler sampler : {Sampler::havran, Sampler::standard})
      for (const int clusters : {0, 1, 2, 16}) {
        LightPipelineOptions options = plain(100, sampler);
        options.clusters = clusters;
        options.filter = TemporalFilter::fir;
        LightPipeline pipeline = make(map, options);
        for (int frame = 0; frame < 12; ++frame) {
          const auto lights = pipeline.process(map);
          const Rgbd total = total_illuminance(map);
          // A constant map: float lights and float sums, a few parts in 10⁷ a stage.
          EXPECT_LT(relative(sum(lights), total), 3e-6) << name;
          EXPECT_LT(relative(sum(pipeline.unclustered()), total), 3e-6) << name;
          EXPECT_LT(relative(pipeline.total_illuminance().cast<double>(), sum(lights)), 1e-6) << name;
          if (clusters > 0) {
            EXPECT_LE(lights.size(), static_cast<std::size_t>(clusters));
          }
        }
      }
}

TEST(LightPipeline, AllBlackGivesPowerlessLightsInEveryStage) {
  const PolarMap map = PolarMap::make({18, 40, kPi / 2}, 3);
  for (const int clusters : {0, 1, 16}) {
    LightPipelineOptions options = plain(64);
    options.filter = TemporalFilter::fir;
    options.clusters = clusters;
    LightPipeline pipeline = make(map, options);
    for (int frame = 0; frame < 3; ++frame)
      for (const auto& light : pipeline.process(map)) {
        EXPECT_EQ(light.illuminance.abs().sum(), 0);
        EXPECT_NEAR(light.direction.norm(), 1, 1e-6);
        EXPECT_GE(light.direction.y(), 0);
      }
    EXPECT_EQ(pipeline.total_illuminance().sum(), 0);
  }
}

TEST(LightPipeline, OneLightAndAHundredThousand) {
  const PolarMap map = test::random_map({18, 40, kPi / 2}, 11);
  for (const int count : {1, 100000}) {
    LightPipelineOptions options = plain(count);
    options.clusters = 72;
    options.filter = TemporalFilter::fir;
    LightPipeline pipeline = make(map, options);
    const auto lights = pipeline.process(map);
    EXPECT_EQ(pipeline.unclustered().size(), static_cast<std::size_t>(count));
    EXPECT_LE(lights.size(), 72u);
    EXPECT_LT(relative(sum(lights), total_illuminance(map)), 1e-5);  // 1e5 floats
  }
}

TEST(LightPipeline, SameMapsGiveTheSameLightsBitForBit) {
  LightPipelineOptions options;
  const PolarGrid grid{90, 360, kPi / 2};
  const PolarMap first = test::sun_and_sky(grid, 0, 40, 0.6);
  LightPipeline a = make(first, options);
  LightPipeline b = make(first, options);
  for (int frame = 0; frame < 15; ++frame) {
    const PolarMap map = test::sun_and_sky(grid, 3 * frame, 40, 0.6);
    const auto la = a.process(map);
    const auto lb = b.process(map);
    ASSERT_EQ(la.size(), lb.size());
    for (std::size_t i = 0; i < la.size(); ++i) {
      EXPECT_EQ(la[i].direction, lb[i].direction);
      EXPECT_TRUE((la[i].illuminance == lb[i].illuminance).all());
      EXPECT_EQ(la[i].id, lb[i].id);
    }
  }
  // And again after a reset.
  a.reset();
  LightPipeline fresh = make(first, options);
  const auto la = a.process(first);
  const auto lf = fresh.process(first);
  ASSERT_EQ(la.size(), lf.size());
  for (std::size_t i = 0; i < la.size(); ++i) EXPECT_EQ(la[i].direction, lf[i].direction);
}

TEST(LightPipeline, SpikeThroughTheFilterStaysBoundedAndPositive) {
  const PolarGrid grid{18, 40, kPi / 2};
  PolarMap map = test::random_map(grid, 12);
  PolarMap flash = map;
  for (float& v : flash.radiance) v *= 100;
  LightPipelineOptions options = plain(200);
  options.filter = TemporalFilter::fir;
  options.clusters = 72;
  LightPipeline pipeline = make(map, options);
  const Rgbd quiet = total_illuminance(map);
  for (int frame = 0; frame < 40; ++frame) {
    const auto lights = pipeline.process(frame == 15 ? flash : map);
    const Rgbd total = sum(lights);
    EXPECT_TRUE((total >= quiet * (1 - 1e-5)).all() && (total <= 100 * quiet * (1 + 1e-5)).all()) << frame;
    for (const auto& light : lights) EXPECT_GE(light.illuminance.minCoeff(), 0);
  }
  EXPECT_LT(relative(sum(pipeline.process(map)), quiet), 1e-5);
}

TEST(LightPipeline, LightsOfAConstantMapBalanceLikeTheHemisphere) {
  // Σ illuminance · direction over a constant hemisphere of radiance 1 is π in +Y.
  const PolarMap map = test::constant_map({90, 360, kPi / 2}, Rgb::Constant(1));
  for (const Sampler sampler : {Sampler::havran, Sampler::standard}) {
    LightPipeline pipeline = make(map, plain(1024, sampler));
    Vec3d flux = Vec3d::Zero();
    for (const auto& light : pipeline.process(map))
      flux += light.direction.cast<double>() * static_cast<double>(light.illuminance[0]);
    EXPECT_LT((flux - Vec3d(0, kPi, 0)).norm(), 0.01 * kPi);  // discrepancy of 1024 points: well below 1 %
  }
}

TEST(LightPipeline, IrradianceConvergesToTheMapsWhereThePowerWeightedRepairHolds) {
  const PolarGrid grid{90, 360, kPi / 2};
  const PolarMap map = test::sun_and_sky(grid, 100, 40, 0.8);
  LightPipeline pipeline = make(map, plain(65536));
  const auto lights = pipeline.process(map);
  for (const Vec3d& normal :
       {Vec3d(0, 1, 0), Vec3d(1, 0, 0), Vec3d(-1, 0, 0), Vec3d(0, 0, 1), Vec3d(0.6, 0.8, 0)}) {
    Rgbd expected = Rgbd::Zero(), got = Rgbd::Zero();
    for (int k = 0; k < grid.rings; ++k)
      for (int s = 0; s < grid.sectors; ++s)
        expected += map.rgb(static_cast<std::size_t>(k * grid.sectors + s)).cast<double>() *
                    grid.bin_solid_angle_sr(k) * std::max(0.0, normal.dot(grid.bin_direction(k, s)));
    for (const auto& light : lights)
      got += light.illuminance.cast<double>() * std::max(0.0, normal.dot(light.direction.cast<double>()));
    // papers/NOTES.md: the repair leaves .3 to .4 % of the printed method's 2.4 %.
    EXPECT_LT(relative(got, expected), 0.006) << normal.transpose();
  }
}

TEST(LightPipeline, RefusesWhatIsOutOfRangeAndNamesIt) {
  const auto message = [](LightPipelineOptions options, PolarGrid grid = {}, int channels = 3) {
    const auto pipeline = LightPipeline::create(grid, channels, options);
    EXPECT_FALSE(pipeline.ok());
    return pipeline.ok() ? std::string() : pipeline.error().message;
  };
  LightPipelineOptions o;
  o.count = 0;
  EXPECT_NE(message(o).find("count 0 "), std::string::npos);
  o.count = 100001;
  EXPECT_NE(message(o).find("1 to 100000"), std::string::npos);
  o = {};
  o.clusters = -1;
  EXPECT_NE(message(o).find("clusters"), std::string::npos);
  o = {};
  o.rate_hz = 40;
  EXPECT_NE(message(o).find("stop"), std::string::npos);
  EXPECT_NE(message({}, {0, 360, 1}).find("rings"), std::string::npos);
  EXPECT_NE(message({}, {90, 0, 1}).find("sectors"), std::string::npos);
  EXPECT_NE(message({}, {90, 360, 4}).find("theta_max"), std::string::npos);
  EXPECT_NE(message({}, {}, 2).find("channels"), std::string::npos);
}

TEST(LightPipeline, ProcessAllocatesNothing) {
  const PolarGrid grid{90, 360, kPi / 2};
  // A sun that pushes the seam, a lamp that makes it jump, darkness.
  std::vector<PolarMap> maps;
  for (const double azimuth : {0.0, 60.0, 120.0, 125.0})
    maps.push_back(test::sun_and_sky(grid, azimuth, 50, 0.8));
  maps.push_back(test::sun_and_sky(grid, 300, 50, 0.9));
  maps.push_back(PolarMap::make(grid, 3));
  for (const Sampler sampler : {Sampler::havran, Sampler::standard}) {
    LightPipelineOptions options;
    options.sampler = sampler;
    LightPipeline pipeline = make(maps[0], options);
    const test::AllocationCounter counter;  // from the very first frame on
    for (const PolarMap& map : maps) static_cast<void>(pipeline.process(map));
    pipeline.reset();
    static_cast<void>(pipeline.process(maps[0]));
    EXPECT_EQ(counter.count(), 0u);
  }
}

TEST(LightPipeline, DelayIsHalfTheOrderOrNone) {
  const PolarMap map = PolarMap::make({18, 40, kPi / 2}, 1);
  EXPECT_EQ(make(map, LightPipelineOptions{}).delay_frames(), 4);
  EXPECT_EQ(make(map, plain(10)).delay_frames(), 0);
}

}  // namespace
}  // namespace lightwell
