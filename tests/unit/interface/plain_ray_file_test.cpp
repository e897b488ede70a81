// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/plain_ray_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace lightwell {
namespace {

using testing::HasSubstr;

void expect_bad(const std::string& text, const std::string& words) {
  const auto file = parse_plain_rays(text, "lamp.csv");
  ASSERT_FALSE(file) << words;
  EXPECT_EQ(file.error().kind, ErrorKind::bad_input);
  EXPECT_THAT(file.error().message, HasSubstr("lamp.csv"));
  EXPECT_THAT(file.error().message, HasSubstr(words));
  EXPECT_EQ(file.error().message.find('\n'), std::string::npos);
}

TEST(PlainRayFile, NamedColumnsAreTheLampsFrame) {
  const auto file = parse_plain_rays(
      "# a lamp\nflux,x,y,z,u,v,w,colour\r\n\n2.5, 0.1,-0.2,0.3, 0.6,0,-0.8, 5\n0,0,0,0,0,0,-1,5\n",
      "lamp.csv");
  ASSERT_TRUE(file) << file.error().message;
  ASSERT_EQ(file->rays.size(), 1u);
  EXPECT_EQ(file->name, "lamp");
  EXPECT_EQ(file->rays[0].flux_lm, 2.5);
  EXPECT_EQ(file->rays[0].origin_m, Vec3d(0.1, -0.2, 0.3));
  EXPECT_LT((file->rays[0].direction - Vec3d(0.6, 0, -0.8)).norm(), 1e-15);
  EXPECT_THAT(file->remarks, testing::ElementsAre("1 rays have no flux"));
}

TEST(PlainRayFile, ZemaxsTextIsTurnedAndInItsUnit) {
  for (const auto& [unit, metres] : {std::pair("0", 1.0), std::pair("1", 0.0254), std::pair("2", 0.01),
                                     std::pair("3", 0.3048), std::pair("4", 0.001)}) {
    const auto file = parse_plain_rays(
        std::string("! LED\n2 ") + unit + "\n1 2 3 0 0.6 0.8 0.5 0.55\n\t1.0e0 0 0 0 0 1 1\n", "lamp.dat");
    ASSERT_TRUE(file) << file.error().message;
    ASSERT_EQ(file->rays.size(), 2u);
    EXPECT_LT((file->rays[0].origin_m - metres * Vec3d(1, -2, -3)).norm(), 1e-12);
    EXPECT_LT((file->rays[0].direction - Vec3d(0, -0.6, -0.8)).norm(), 1e-12) << "its +z is the lamp's aim";
    EXPECT_THAT(file->remarks, testing::ElementsAre("the unit of flux is not said: taken as lumens"));
  }
}

TEST(PlainRayFile, ACutFileIsRefusedOrSaid) {
  const std::string good = "3 4\n0 0 0 0 0 1 1\n0 0 0 0 0 1 1\n0 0 0 0 0 1 1\n";
  ASSERT_TRUE(parse_plain_rays(good, "lamp.dat"));
  for (std::size_t length = 0; length + 1 < good.size(); ++length)
    EXPECT_FALSE(parse_plain_rays(good.substr(0, length), "lamp.dat")) << length;
  const auto no_end = parse_plain_rays(good.substr(0, good.size() - 1), "lamp.dat");
  ASSERT_TRUE(no_end);
  EXPECT_THAT(no_end->remarks.back(), HasSubstr("may be cut short"));
  expect_bad("x,y,z,u,v,w,flux\n0,0,0,0,0,-1,1\n0,0,0,0,0\n",
             "line 3: has 5 numbers, allowed: 7; the file may be cut");
  expect_bad("2 4\n0 0 0 0 0 1 1\n", "has 1 rays where its first line says 2: the file is cut short");
  expect_bad("1 4\n0 0 0 0 0 1 1\n0 0 0 0 0 1 1\n", "has 2 rays where its first line says 1");
}

TEST(PlainRayFile, BadInputIsRefusedInOneLine) {
  const std::string head = "x,y,z,u,v,w,flux\n";
  expect_bad("", "holds no rays");
  expect_bad("# nothing\n", "holds no rays");
  expect_bad(std::string("ab\0c\n", 5), "is no text");
  expect_bad("x,y,z,u,v,w\n0,0,0,0,0,-1\n", "line 1: column flux is missing");
  expect_bad("0,0,0,0,0,-1,1\n", "line 1: begins with 7 numbers, allowed: names of columns");
  expect_bad("2.5 4\n", "number of rays is 2.5, allowed: 1 to 1e10");
  expect_bad("0 4\n", "number of rays is 0");
  expect_bad("2 5\n", "unit is 5, allowed: 0 (m), 1 (in), 2 (cm), 3 (ft), 4 (mm)");
  expect_bad(head + "nan,0,0,0,0,-1,1\n", "line 2: x is nan, allowed: within 1000 metres");
  expect_bad(head + "0,5000,0,0,0,-1,1\n", "y is 5000");
  expect_bad(head + "0,0,0,0,0,-1,-2\n", "flux is -2, allowed: 0 to 1e12");
  expect_bad(head + "0,0,0,0,0,-1,inf\n", "flux is inf");
  expect_bad(head + "0,0,0,0,0,down,1\n", "w is down, allowed: a part of a unit vector");
  expect_bad(head + "0,0,0,0.5,0,-0.5,1\n",
             "line 2: the direction u, v, w is 0.707107 long, allowed: 1 within 0.01");
  expect_bad(head + "0,0,0,0,0,-1,0\n", "no ray has any flux");
}

}  // namespace
}  // namespace lightwell
