// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "bench/chart.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <regex>

namespace lightwell::bench {
namespace {

using testing::HasSubstr;

std::vector<std::pair<double, double>> drawn(const std::string& svg) {
  std::smatch line;
  std::vector<std::pair<double, double>> points;
  if (!std::regex_search(svg, line, std::regex("<polyline points='([^']*)'"))) return points;
  const std::string text = line[1];
  const std::regex pair("([-0-9.]+),([-0-9.]+)");
  for (auto p = std::sregex_iterator(text.begin(), text.end(), pair); p != std::sregex_iterator(); ++p)
    points.emplace_back(std::stod((*p)[1]), std::stod((*p)[2]));
  return points;
}

TEST(Chart, LogarithmicAxesMakeEqualRatiosEqualSteps) {
  const auto points =
      drawn(to_svg({{"t", "x", "y", true, true, {{"a", {{1, 1}, {10, 0.1}, {100, 0.01}}}}}}, ""));
  ASSERT_EQ(points.size(), 3u);
  EXPECT_NEAR(points[1].first - points[0].first, points[2].first - points[1].first,
              0.2);  // a tenth of a pixel
  EXPECT_NEAR(points[1].second - points[0].second, points[2].second - points[1].second, 0.2);
  EXPECT_GT(points[1].second, points[0].second);  // down the page
}

TEST(Chart, WhatCannotBeShownIsLeftOut) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Line> lines = {{"a", {{0, 1}, {1, nan}, {2, 3}, {4, -1}, {8, 6}}}};
  EXPECT_EQ(drawn(to_svg({{"t", "x", "y", true, true, lines}}, "")).size(), 2u);
  EXPECT_EQ(drawn(to_svg({{"t", "x", "y", false, false, lines}}, "")).size(), 4u);
  EXPECT_THAT(to_svg({{"t", "x", "y", true, true, {{"none", {}}}}}, ""), HasSubstr("none"));
  EXPECT_THAT(to_svg({}, "nothing"), HasSubstr("nothing"));
  for (const auto& svg :
       {to_svg({{"t", "x", "y", true, true, lines}}, ""), to_svg({{"t", "x", "y", false, false, {}}}, "")})
    EXPECT_FALSE(std::regex_search(svg, std::regex("[^a-z](nan|inf)"))) << svg;
}

TEST(Chart, NamesAreEscapedAndStandOnceInTheLegend) {
  const std::string svg = to_svg({{"a < b", "x", "y", true, true, {{"p & q", {{1, 1}}}}},
                                  {"c", "x", "y", true, true, {{"p & q", {{1, 1}}}}}},
                                 "");
  EXPECT_THAT(svg, HasSubstr("a &lt; b"));
  const auto first = svg.find("p &amp; q");
  ASSERT_NE(first, std::string::npos);
  EXPECT_EQ(svg.find("p &amp; q", first + 1), std::string::npos);
}

}  // namespace
}  // namespace lightwell::bench
