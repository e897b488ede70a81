// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "interface/photometric_file.h"
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

TEST_F(LuminaireCommandTest, RaysAsTextAreALampAndItsFarFieldGoesOut) {
  std::ofstream rays(path("rays.csv"));
  rays << "x,y,z,u,v,w,flux\n";
  for (int i = 0; i < 20000; ++i) {  // Lambertian, 100 lm, by a spiral
    const double sine = std::sqrt((i + 0.5) / 20000), turn = 2.399963 * i;
    rays << 0.01 * ((i % 7) - 3) << "," << 0.01 * ((i % 5) - 2) << ",0," << sine * std::cos(turn) << ","
         << sine * std::sin(turn) << "," << -std::sqrt(1 - sine * sine) << ",0.005\n";
  }
  rays.close();
  const auto imported = import("rays.csv");
  ASSERT_EQ(imported.exit_code, 0) << imported.err;
  EXPECT_EQ(nlohmann::json::parse(imported.out)["rays"], 20000);
  EXPECT_NEAR(nlohmann::json::parse(imported.out)["flux_lm"].get<double>(), 100, 0.01);
  const auto exported =
      lightwell({"luminaire", "export", path("lamp.exr"), "--out", path("lamp.ies"), "--json"});
  ASSERT_EQ(exported.exit_code, 0) << exported.err;
  const auto report = nlohmann::json::parse(exported.out);
  EXPECT_NEAR(report["flux_lm"].get<double>(), 100, 1);
  const auto back = lightwell({"luminaire", "import", path("lamp.ies"), "--out", path("far.exr"), "--json"});
  ASSERT_EQ(back.exit_code, 0) << back.err;
  EXPECT_NEAR(nlohmann::json::parse(back.out)["flux_lm"].get<double>(), report["flux_lm"].get<double>(),
              1e-5);
}

TEST_F(LuminaireCommandTest, SaysHowNearALampOfRaysServes) {
  std::ofstream rays(path("panel.csv"));
  rays << "x,y,z,u,v,w,flux\n";
  for (int y = 0; y <= 20; ++y)
    for (int x = 0; x <= 20; ++x) rays << 0.03 * x << "," << 0.03 * y << ",0,0,0,-1,1\n";
  rays.close();
  for (const auto& [positions, spacing_m] : {std::pair(8, 0.6 / 7), std::pair(16, 0.04)}) {
    const auto imported = lightwell({"luminaire", "import", path("panel.csv"), "--positions",
                                     std::to_string(positions), "--out", path("lamp.exr"), "--json"});
    ASSERT_EQ(imported.exit_code, 0) << imported.err;
    const auto report = nlohmann::json::parse(imported.out);
    EXPECT_EQ(report["positions"], (std::array{positions, positions}));
    EXPECT_NEAR(report["spacing_m"].get<double>(), spacing_m, 1e-9);
    EXPECT_NEAR(report["nearest_m"].get<double>(), 2 * spacing_m, 1e-9);
    if (positions == 8)
      EXPECT_THAT(imported.err, HasSubstr("its 8 x 8 sources are 0.0857 m apart: nearer than 0.171 m"));
    else
      EXPECT_EQ(imported.err, "") << "0.08 m is near enough";
    EXPECT_EQ(report["remarks"].size(), positions == 8 ? 1u : 0u);
  }
}

// What a file says comes out as it went in, to the nine digits that are written.
TEST_F(LuminaireCommandTest, AMakersTableGoesOutAsItCameIn) {
  std::ofstream(path("odd.ies")) << "IESNA:LM-63-2002\n[LUMINAIRE] Odd\nTILT=NONE\n1 -1 0.37 4 3 1 2 0 0 "
                                    "0\n1 1 10\n0 13.5 45 90\n0 45 90\n"
                                 << "101.3 88 41.7 0\n101.3 77.25 12.125 0.5\n101.3 66 3 0.001\n";
  ASSERT_EQ(import("odd.ies").exit_code, 0);
  const auto exported = lightwell({"luminaire", "export", path("lamp.exr"), "--out", path("out.ies")});
  ASSERT_EQ(exported.exit_code, 0) << exported.err;
  const auto before = read_ies(path("odd.ies")), after = read_ies(path("out.ies"));
  ASSERT_TRUE(before && after);
  EXPECT_EQ(after->name, "Odd");
  EXPECT_EQ(after->lamp.vertical_deg, before->lamp.vertical_deg);
  EXPECT_EQ(after->lamp.horizontal_deg, before->lamp.horizontal_deg);
  ASSERT_EQ(after->lamp.candela.size(), before->lamp.candela.size());
  for (std::size_t i = 0; i < before->lamp.candela.size(); ++i)
    EXPECT_NEAR(after->lamp.candela[i], before->lamp.candela[i], 5e-9 * before->lamp.candela[i]);
  EXPECT_NEAR(luminous_flux(after->lamp) / luminous_flux(before->lamp), 1, 1e-8);
  const auto over = lightwell({"luminaire", "export", path("lamp.exr"), "--out", path("lamp.exr")});
  EXPECT_EQ(over.exit_code, 2) << over.err;
  expect_refused(lightwell({"luminaire", "export", path("odd.ies"), "--out", path("x.ies")}), 3, "is no EXR");
}

TEST_F(LuminaireCommandTest, TiltFactorsCountForTheAngleThatIsTold) {
  std::ofstream(path("tilt.ies")) << "IESNA:LM-63-2002\nTILT=INCLUDE\n1\n3\n0 45 90\n0.9 0.8 0.6\n1 -1 1 2 1 "
                                     "1 2 0 0 0\n1 1 10\n0 90\n0\n100 100\n";
  const auto flux = [&](std::vector<std::string> more, const std::string& said) {
    more.insert(more.begin(), {"luminaire", "import", path("tilt.ies"), "--out", path("lamp.exr"), "--json"});
    const auto imported = lightwell(more);
    EXPECT_EQ(imported.exit_code, 0) << imported.err;
    EXPECT_THAT(imported.err, HasSubstr(said));
    return nlohmann::json::parse(imported.out)["flux_lm"].get<double>() / (200 * M_PI);
  };
  EXPECT_NEAR(flux({}, "is 0.9 of the table's, for --tilt 0"), 0.9, 1e-9);
  EXPECT_NEAR(flux({"--tilt", "67.5"}, "is 0.7 of the table's"), 0.7, 1e-9);
  expect_refused(
      lightwell({"luminaire", "import", path("even.ies"), "--tilt", "10", "--out", path("lamp.exr")}), 2,
      "has no TILT factors");
}

TEST_F(LuminaireCommandTest, BadInputIsOneLineAndLeavesNothing) {
  std::ofstream(path("cut.ies")) << "IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 2\n";
  expect_refused(import("cut.ies"), 3, "the file is cut short");
  expect_refused(import("missing.ldt"), 3, "missing.ldt");
  std::ofstream(path("text.tm25ray")) << "TM26";
  expect_refused(import("text.tm25ray"), 3, "not a ray file");
  EXPECT_FALSE(std::filesystem::exists(path("lamp.exr")));
  expect_refused(lightwell({"luminaire", "import", path("even.ies"), "--out", path("lamp.png")}), 2,
                 "lamp.png, allowed: a name that ends in .exr");
  expect_refused(lightwell({"luminaire", "import", path("even.ies"), "--out", path("none/lamp.exr")}), 1,
                 "none");
  ASSERT_EQ(import("even.ies").exit_code, 0);
  expect_refused(lightwell({"luminaire", "export", path("lamp.exr"), "--out", path("lamp.txt")}), 2,
                 "lamp.txt, allowed: a name that ends in .ies");
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
