// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <thread>

#include "interface/dds_topics.h"

namespace lightwell::test {

// A daemon as far as a renderer can tell: one light from above, in an even sky.
struct FakeProbe {
  static constexpr float kSky = 50;  // cd/m²

  explicit FakeProbe(const DdsOptions& options, float times = 1)
      : domain(DdsDomain::open(options).value()), power(times) {
    writer = LightWriter::create(domain, "fake").value();
    environment = EnvironmentWriter::create(domain, "fake").value();
    EnvironmentFrame sky;
    sky.header.capture_mono_ns =
        std::chrono::steady_clock::now().time_since_epoch().count();  // no repetition
    sky.map = PolarMap::make({.rings = 30, .sectors = 120}, 3);
    std::fill(sky.map.radiance.begin(), sky.map.radiance.end(), kSky * power);
    EXPECT_TRUE(environment->write(sky));
  }
  void send() {
    LightFrame frame;
    frame.header.number = ++number;
    DirectionalLight light;
    light.direction = Vec3f::UnitY();
    light.illuminance = Rgb(100, 200, 300) * power;
    light.predicted_error = 0.125f;
    frame.header.total_illuminance = light.illuminance;
    frame.lights = {light};
    EXPECT_TRUE(writer->write(frame));
    std::this_thread::sleep_for(std::chrono::milliseconds(20));  // a camera of 50 Hz
  }
  std::shared_ptr<DdsDomain> domain;
  float power;
  std::unique_ptr<LightWriter> writer;
  std::unique_ptr<EnvironmentWriter> environment;
  std::uint64_t number = 0;
};

}  // namespace lightwell::test
