// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/photometric_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "tests/support/temporary_folder.h"

namespace lightwell {
namespace {

const std::filesystem::path kData = LIGHTWELL_TEST_DATA;

std::string ies(const std::string& numbers, const std::string& tilt = "TILT=NONE") {
  return "IESNA:LM-63-2002\r\n[MANUFAC] Maker\r\n[LUMINAIRE] Spot\r\n" + tilt + "\r\n" + numbers;
}
PhotometricFile good_ies(const std::string& text) {
  auto file = parse_ies(text, "lamp.ies");
  EXPECT_TRUE(file) << (file ? "" : file.error().message);
  return file ? *file : PhotometricFile{};
}
void expect_bad(const Result<PhotometricFile>& file, const std::string& words) {
  ASSERT_FALSE(file) << "expected: " << words;
  EXPECT_EQ(file.error().kind, ErrorKind::bad_input);
  EXPECT_NE(file.error().message.find(words), std::string::npos) << file.error().message;
  EXPECT_EQ(file.error().message.find('\n'), std::string::npos);
}

TEST(IesFile, MultipliersUnitsAndNamesAreApplied) {
  const auto file = good_ies(ies("2 500 3 3 1 1 1 1 2 0.5\n.5 2 40\n0 45 90\n0\n10 20 30\n"));
  EXPECT_EQ(file.name, "Maker Spot");
  EXPECT_EQ(file.lamp.horizontal_deg, std::vector<double>{0});
  EXPECT_EQ(file.lamp.candela, (std::vector<double>{30, 60, 90})) << "times 3, .5 and 2";
  EXPECT_NEAR(file.opening_m.x(), 2 * 0.3048, 1e-12) << "length along C0, in feet";
  EXPECT_NEAR(file.opening_m.y(), 0.3048, 1e-12);
  EXPECT_EQ(file.input_power_w, 40);
  EXPECT_FALSE(file.round_opening);
}

TEST(IesFile, SymmetriesAreUnfolded) {
  const auto quadrant = good_ies(ies("1 -1 1 2 3 1 2 0 0 0 1 1 0 0 90 0 45 90 1 1 2 2 3 3"));
  EXPECT_EQ(quadrant.lamp.horizontal_deg, (std::vector<double>{0, 45, 90, 135, 180, 225, 270, 315}));
  for (const double c : {45.0, 135.0, 225.0, 315.0})
    EXPECT_EQ(intensity(quadrant.lamp, PhotometricAngles{c, 90}), 2);
  EXPECT_EQ(intensity(quadrant.lamp, PhotometricAngles{270, 90}), 3);

  const auto half = good_ies(ies("1 -1 1 2 3 1 2 0 0 0 1 1 0 0 90 0 90 180 1 1 2 2 3 3"));
  EXPECT_EQ(intensity(half.lamp, PhotometricAngles{270, 90}), 2);
  EXPECT_EQ(intensity(half.lamp, PhotometricAngles{180, 90}), 3);

  const auto other_half = good_ies(ies("1 -1 1 2 3 1 2 0 0 0 1 1 0 0 90 90 180 270 1 1 2 2 3 3"));
  EXPECT_EQ(intensity(other_half.lamp, PhotometricAngles{0, 90}), 2);
  EXPECT_EQ(intensity(other_half.lamp, PhotometricAngles{90, 90}), 1);

  const auto whole = good_ies(ies("1 -1 1 2 3 1 2 0 0 0 1 1 0 0 90 0 180 360 1 1 2 2 1 1"));
  EXPECT_EQ(whole.lamp.horizontal_deg, (std::vector<double>{0, 180}));

  // Floodlights of type B and A: a quarter, then all.
  const auto flood = good_ies(ies("1 -1 1 2 2 2 2 0 0 0 1 1 0 0 90 0 90 1 2 3 4"));
  EXPECT_EQ(flood.lamp.horizontal_deg, (std::vector<double>{-90, 0, 90}));
  EXPECT_EQ(flood.lamp.vertical_deg, (std::vector<double>{-90, 0, 90}));
  EXPECT_EQ(intensity(flood.lamp, PhotometricAngles{-90, -90}), 4);
  EXPECT_EQ(intensity(flood.lamp, PhotometricAngles{0, -90}), 2);
}

TEST(IesFile, TiltIsKeptAndMayStandInAFileBeside) {
  const test::TemporaryFolder folder;
  const std::string numbers = "1 -1 1 2 1 1 2 0 0 0 1 1 0 0 90 0 5 5";
  const auto file = good_ies(ies(numbers, "TILT=INCLUDE\r\n1\r\n3\r\n0 45 90\r\n1 0.8 0.6"));
  EXPECT_DOUBLE_EQ(tilt_factor(file, 0), 1);
  EXPECT_DOUBLE_EQ(tilt_factor(file, 22.5), 0.9);
  EXPECT_DOUBLE_EQ(tilt_factor(file, 120), 0.6);
  std::ofstream(folder.path() / "lamp.tlt") << "1 2 0 90 1 0.5";
  std::ofstream(folder.path() / "lamp.ies") << ies(numbers, "TILT=lamp.tlt");
  const auto other = read_photometric_file(folder.path() / "lamp.ies");
  ASSERT_TRUE(other) << other.error().message;
  EXPECT_DOUBLE_EQ(tilt_factor(*other, 45), 0.75);
  expect_bad(parse_ies(ies(numbers, "TILT=nowhere.tlt"), folder.path() / "lamp.ies"), "nowhere.tlt");
}

TEST(IesFile, UnitsThatAreNotCandelaAreSaid) {
  std::string text = ies("1 -1 1 2 1 1 2 0 0 0\r\n1 1 10\r\n0 90\r\n0\r\n100 100");
  text.replace(text.find("[MANUFAC]"), 0, "[MORE] file are expressed in mW/sr (200-280nm).\r\n");
  const auto file = good_ies(text);
  ASSERT_EQ(file.remarks.size(), 1u);
  EXPECT_EQ(file.remarks[0], "speaks of mW/sr: its intensities are taken as candela");
}

TEST(IesFile, BadInputNamesLineFieldValueAndRange) {
  expect_bad(parse_ies("", "lamp.ies"), "lamp.ies: has no line TILT=");
  expect_bad(parse_ies(ies("1 -1 1 2"), "lamp.ies"),
             "number of horizontal angles is missing: the file is cut short");
  expect_bad(parse_ies(ies("1 -1 1 2 1 1 2 0 0 0 1 1 0 0 90 0 5"), "lamp.ies"),
             "plane 1: candela 2 of 2 is missing");
  expect_bad(parse_ies(ies("1 -1 0 2 1 1 2 0 0 0 1 1 0 0 90 0 5 5"), "lamp.ies"),
             "line 5: candela multiplier is 0, allowed: above 0 to 1e9");
  expect_bad(parse_ies(ies("1 -1 1 2 1 4 2 0 0 0 1 1 0 0 90 0 5 5"), "lamp.ies"),
             "photometric type is 4, allowed: 1 to 3");
  expect_bad(parse_ies(ies("1 -1 1 2 1 1 3 0 0 0 1 1 0 0 90 0 5 5"), "lamp.ies"),
             "units type is 3, allowed: 1 to 2");
  expect_bad(parse_ies(ies("1 -1 1 2 1 1 2 0 0 0\n1 1 0\n90 0\n0 5 5"), "lamp.ies"),
             "vertical angle 2 is 0 after 90, allowed: increasing angles");
  expect_bad(parse_ies(ies("1 -1 1 2 1 1 2 0 0 0 1 1 0 0 190 0 5 5"), "lamp.ies"),
             "is 190, allowed: 0 to 180 degrees");
  expect_bad(parse_ies(ies("1 -1 1 2 1 1 2 0 0 0 1 1 0 0 90 0\nnan 5"), "lamp.ies"), "candela 1 of 2 is nan");
  expect_bad(parse_ies(ies("1 -1 1 2 2 1 2 0 0 0 1 1 0 0 90 10 20 5 5 5 5"), "lamp.ies"), "go from 10 to 20");
  expect_bad(parse_ies(ies("1 -1 1 99999999 1 1 2 0 0 0 1 1 0"), "lamp.ies"),
             "number of vertical angles is 99999999");
  expect_bad(read_photometric_file("no-such-lamp.ies"), "no-such-lamp.ies");
}

TEST(IesFile, NegativeIntensitiesCountAsNoneAndAreSaid) {
  const auto file = good_ies(ies("1 -1 1 2 1 1 2 0 0 0 1 1 0 0 90 0 5 -5"));
  EXPECT_EQ(file.lamp.candela, (std::vector<double>{5, 0}));
  ASSERT_EQ(file.remarks.size(), 1u);
  EXPECT_EQ(file.remarks[0], "1 negative intensities count as 0");
}

TEST(IesFile, WhatIsWrittenReadsBackTheSame) {
  const test::TemporaryFolder folder;
  for (const char* planes :
       {"1 1 2 0 0 0 1 1 7 0 90 0 5.125 6", "3 1 2 -.2 0 0 1 1 7 0 90 0 90 180 5 6 7.5 8 9 10",
        "2 2 2 .1 .2 .3 1 1 7 0 90 0 90 1 2 3 4"}) {
    const auto file = good_ies(ies(std::string("1 -1 1 2 ") + planes));
    ASSERT_TRUE(write_ies(folder.path() / "out.ies", file));
    const auto back = read_ies(folder.path() / "out.ies");
    ASSERT_TRUE(back) << back.error().message;
    EXPECT_EQ(back->lamp.system, file.lamp.system);
    EXPECT_EQ(back->lamp.horizontal_deg, file.lamp.horizontal_deg);
    EXPECT_EQ(back->lamp.vertical_deg, file.lamp.vertical_deg);
    EXPECT_EQ(back->lamp.candela, file.lamp.candela);
    EXPECT_LT((back->opening_m - file.opening_m).norm(), 1e-9);
    EXPECT_EQ(back->round_opening, file.round_opening);
    EXPECT_EQ(back->input_power_w, 7);
  }
}

// One lamp set of 2000 lm at 50 %; four planes of two angles unless told otherwise.
std::string ldt(int symmetry, const std::string& values, const std::string& flux = "2000", int planes = 4) {
  std::ostringstream out;
  out << "Maker\n1\n"
      << symmetry << "\n"
      << planes << "\n"
      << 360.0 / planes << "\n2\n90\nreport\nFlood\n1\nf.ldt\ndate\n";
  out << "500\n0\n80\n400\n0\n10\n20\n30\n40\n100\n50\n1.0\n0\n1\n1\nLED\n" << flux << "\n4000\n80\n25,5\n";
  for (int i = 0; i < 10; ++i) out << "0.5\n";
  for (int i = 0; i < planes; ++i) out << 360.0 / planes * i << "\n";
  out << "0\n90\n" << values;
  return out.str();
}

TEST(EulumdatFile, CandelaAreAKilolumensTimesTheLampsFlux) {
  const auto file = parse_eulumdat(ldt(1, "100\n50,5\n"), "lamp.ldt");
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(file->lamp.candela, (std::vector<double>{200, 101})) << "a comma stands for the point too";
  EXPECT_EQ(file->name, "Flood");
  EXPECT_DOUBLE_EQ(*file->stated_flux_lm, 1000);
  EXPECT_EQ(file->input_power_w, 25.5);
  EXPECT_TRUE(file->round_opening);
  EXPECT_LT((file->opening_m - Vec3d(0.4, 0.4, 0.04)).norm(), 1e-12);
}

TEST(EulumdatFile, SymmetriesAreUnfolded) {
  const auto at = [](int symmetry, const std::string& values, double c) {
    const auto file = parse_eulumdat(ldt(symmetry, values, "1000"), "lamp.ldt");
    EXPECT_TRUE(file) << (file ? "" : file.error().message);
    return file ? intensity(file->lamp, PhotometricAngles{c, 90}) : -1;
  };
  EXPECT_EQ(at(0, "1\n1\n1\n2\n1\n3\n1\n4\n", 270), 4);
  EXPECT_EQ(at(2, "1\n1\n1\n2\n1\n3\n", 270), 2) << "C0 to C180 stand for the other half";
  EXPECT_EQ(at(3, "1\n1\n1\n2\n1\n3\n", 180), 2) << "from C270 over C0 to C90";
  EXPECT_EQ(at(3, "1\n1\n1\n2\n1\n3\n", 270), 1);
  EXPECT_EQ(at(3, "1\n1\n1\n2\n1\n3\n", 90), 3);
  EXPECT_EQ(at(4, "1\n1\n1\n2\n", 180), 1);
  EXPECT_EQ(at(4, "1\n1\n1\n2\n", 270), 2);
}

TEST(EulumdatFile, BadInputNamesLineFieldValueAndRange) {
  const std::string good = ldt(1, "100\n50\n");
  // Cut anywhere it is refused in one line, and never read beyond its end.
  for (std::size_t length = 0; length + 2 < good.size(); ++length)
    if (const auto cut = parse_eulumdat(good.substr(0, length), "lamp.ldt"); !cut) {
      EXPECT_EQ(cut.error().message.find('\n'), std::string::npos);
    }
  expect_bad(parse_eulumdat(good.substr(0, 60), "lamp.ldt"), "the file is cut short");
  expect_bad(parse_eulumdat(ldt(1, "100\nbright\n"), "lamp.ldt"),
             "intensity at C 0, gamma 90 is bright, allowed: a number");
  expect_bad(parse_eulumdat(ldt(1, "100\n50\n", "0"), "lamp.ldt"),
             "total flux of lamps is 0, allowed: above 0");
  expect_bad(parse_eulumdat(ldt(9, "100\n50\n"), "lamp.ldt"), "symmetry indicator is 9, allowed: 0 to 4");
  expect_bad(parse_eulumdat(ldt(4, "100\n50\n", "2000", 6), "lamp.ldt"), "number of C planes is 6");
}

TEST(PhotometricFile, RealLampsReadAndSendTheFluxThatTheySay) {
  if (!std::filesystem::exists(kData / "luminaires")) GTEST_SKIP() << "no real lamps at " << kData;
  int read = 0;
  for (const auto& entry : std::filesystem::directory_iterator(kData / "luminaires")) {
    if (entry.path().extension() != ".ies" && entry.path().extension() != ".ldt") continue;
    const auto file = read_photometric_file(entry.path());
    ASSERT_TRUE(file) << file.error().message;
    EXPECT_GT(luminous_flux(file->lamp), 0);
    ++read;
    // projector.ldt says 77.71 % of its lamps' flux where its own table holds 79.36.
    const double tolerance = entry.path().filename() == "projector.ldt" ? 0.022 : 0.005;
    if (file->stated_flux_lm) {
      EXPECT_NEAR(luminous_flux(file->lamp) / *file->stated_flux_lm, 1, tolerance) << entry;
    }
  }
  EXPECT_EQ(read, 15);
  const auto maxwell = read_ies(
      kData / "luminaires" / "S01.01.02.354_MAXWELL-8-T4_LUXEON_5050_Square_with_glass-MEASURED_IESNA.ies");
  ASSERT_TRUE(maxwell);
  EXPECT_NEAR(luminous_flux(maxwell->lamp), 1000, 5) << "1 lamp of 1000 lm";
}

}  // namespace
}  // namespace lightwell
