// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/integration/commands/command_fixture.h"

namespace lightwell::test {
namespace {

using testing::HasSubstr;

class LuminaireCommandTest : public CommandTest {
 protected:
  // 100 cd everywhere below.
  void SetUp() override {
    std::ofstream(path("even.ies"))
        << "IESNA:LM-63-2002\n[LUMINAIRE] Even\nTILT=NONE\n1 -1 1 2 1 1 2 0 0 0\n1 1 10\n0 90\n0\n100 100\n";
  }
  [[nodiscard]] ProcessResult import(const std::string& file) const {
    return lightwell({"luminaire", "import", path(file), "--out", path("lamp.exr"), "--json"});
  }
  void expect_refused(const ProcessResult& result, int code, const std::string& text) const {
    EXPECT_EQ(result.exit_code, code) << result.err;
    EXPECT_THAT(result.err, HasSubstr(text));
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  }
};

TEST_F(LuminaireCommandTest, ALampIsImportedAndAsked) {
  const auto imported = import("even.ies");
  ASSERT_EQ(imported.exit_code, 0) << imported.err;
  const auto report = nlohmann::json::parse(imported.out);
  EXPECT_EQ(report["name"], "Even");
  EXPECT_EQ(report["near_field"], false);
  EXPECT_NEAR(report["flux_lm"].get<double>(), 200 * M_PI, 1e-9);
  const auto below =
      lightwell({"luminaire", "query", path("lamp.exr"), "--at", "0,0,-2", "--toward", "0,0,5", "--json"});
  ASSERT_EQ(below.exit_code, 0) << below.err;
  EXPECT_NEAR(nlohmann::json::parse(below.out)["illuminance"][0][1].get<double>(), 25, 1e-9);
  std::ofstream(path("p.csv")) << "x,y,z,u,v,w\n0,0,-1,0,0,1\n0,0,1,0,0,-1\n3,0,-4,0,0,1\n";
  const auto many = lightwell({"luminaire", "query", path("lamp.exr"), "--points", path("p.csv"), "--json"});
  ASSERT_EQ(many.exit_code, 0) << many.err;
  const auto lux = nlohmann::json::parse(many.out)["illuminance"];
  ASSERT_EQ(lux.size(), 3u);
  EXPECT_NEAR(lux[0][0].get<double>(), 100, 1e-9);
  EXPECT_EQ(lux[1][0].get<double>(), 0) << "behind the lamp";
  EXPECT_NEAR(lux[2][0].get<double>(), 100 / 25.0 * 0.8, 1e-9);
}

TEST_F(LuminaireCommandTest, BadInputIsOneLineAndLeavesNothing) {
  std::ofstream(path("cut.ies")) << "IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 2\n";
  expect_refused(import("cut.ies"), 3, "the file is cut short");
  expect_refused(import("missing.ldt"), 3, "missing.ldt");
  std::ofstream(path("text.tm25ray")) << "TM26";
  expect_refused(import("text.tm25ray"), 3, "not a ray file");
  EXPECT_FALSE(std::filesystem::exists(path("lamp.exr")));
  ASSERT_EQ(import("even.ies").exit_code, 0);
  const auto query = [&](std::vector<std::string> where) {
    where.insert(where.begin(), {"luminaire", "query", path("lamp.exr")});
    return lightwell(where);
  };
  expect_refused(query({"--at", "0,0,-2"}), 2, "--at X,Y,Z with --toward U,V,W, or --points FILE");
  expect_refused(query({"--at", "0,0", "--toward", "0,0,1"}), 2, "--at is 0,0, allowed: three numbers");
  expect_refused(query({"--at", "0,0,1", "--toward", "0,0,0"}), 2, "--toward is 0,0,0");
  std::ofstream(path("p.csv")) << "x,y,z,u,v,w\n0,0,-1,0,0,0\n";
  expect_refused(query({"--points", path("p.csv")}), 3, "line 2: the normal u,v,w is 0");
  expect_refused(lightwell({"luminaire", "query", path("even.ies"), "--at", "0,0,-1", "--toward", "0,0,1"}),
                 3, "is no EXR file");
}

}  // namespace
}  // namespace lightwell::test
