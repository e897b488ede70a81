// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/statistics.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace lightwell::render {
namespace {

TEST(Statistics, PercentilesAreTakenFromTheFrames) {
  Statistics s;
  for (int i = 1; i <= 100; ++i) s.frames.push_back({static_cast<double>(101 - i), 2.0 * i, {1, 2, 3, 4}});
  s.lights = 72;
  s.gl_renderer = "x";
  const auto json = nlohmann::json::parse(s.json());
  EXPECT_EQ(json["frames"], 100);
  EXPECT_EQ(json["ms"]["p50"], 50);
  EXPECT_EQ(json["ms"]["p99"], 99);
  EXPECT_EQ(json["cpu_ms"]["p50"], 100);
  EXPECT_EQ(json["passes"]["shadow"], 1);
  EXPECT_EQ(json["passes"]["tonemap"], 4);
  EXPECT_TRUE(json["predicted_error"].is_null());
  for (const char* key : {"lights", "shadow_maps", "shadow_size", "triangles", "gl_renderer"})
    EXPECT_TRUE(json.contains(key));
}

TEST(Statistics, ARunWithoutFramesReportsNullTimes) {
  EXPECT_TRUE(nlohmann::json::parse(Statistics{}.json())["ms"]["p50"].is_null());
}

}  // namespace
}  // namespace lightwell::render
