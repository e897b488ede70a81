// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/calibration_choice.h"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "interface/flat_field_json.h"
#include "tests/support/temporary_folder.h"

namespace lightwell {
namespace {

using nlohmann::json;

TEST(CameraFromBoard, TakesThreeAxesAndRefusesTheRest) {
  const auto turned = camera_from_board("x, -z, y");
  ASSERT_TRUE(turned);
  EXPECT_EQ((*turned * Vec3d(1, 2, 3)), Vec3d(1, -3, 2));
  EXPECT_EQ((*camera_from_board("+y,-x,z") * Vec3d(1, 2, 3)), Vec3d(2, -1, 3));
  for (const char* wrong :
       {"", "x", "x,y", "x,y,z,x", "x,x,z", "x,y,-z", "a,y,z", "xx,y,z", "x;y;z", "-,y,z", "x,y,z,"}) {
    const auto refused = camera_from_board(wrong);
    ASSERT_FALSE(refused) << wrong;
    EXPECT_EQ(refused.error().kind, ErrorKind::usage);
    EXPECT_NE(refused.error().message.find("board.axes"), std::string::npos);
  }
}

class CalibrationChoices : public ::testing::Test {
 protected:
  static Calibration base() {
    Calibration calibration;
    calibration.lens.image_size = {8, 8};
    calibration.lens.focal = {4, 4};
    calibration.lens.center = {3.5, 3.5};
    calibration.id = calibration_id(calibration);
    return calibration;
  }
  void write_flat(const std::string& name, double offset, const json& fit) {
    FlatField flat;
    flat.image_size = {8, 8};
    flat.offset_codes.assign(64, static_cast<float>(offset));
    json file = flat_field_to_json(flat);
    if (!fit.is_null()) file["fit"] = fit;
    std::ofstream(folder_.path() / name) << file.dump();
  }
  [[nodiscard]] CalibrationChoice with_flats() const {
    const auto flats = flats_by_temperature(folder_.path());
    EXPECT_TRUE(flats) << (flats ? "" : flats.error().message);
    return {base(), flats ? *flats : std::vector<FlatAtTemperature>(), std::nullopt};
  }
  static CalibrationChoice::Circumstances up(double x, double y, double z) {
    return {Vec3d(x, y, z), std::nullopt};
  }
  static CalibrationChoice::Circumstances warm(double temperature_c) { return {std::nullopt, temperature_c}; }

  test::TemporaryFolder folder_;
};

TEST_F(CalibrationChoices, GravityTurnsTheLensOnceItRests) {
  CalibrationChoice choice(base(), {}, *camera_from_board("x,y,z"));
  EXPECT_FALSE(*choice.consider(up(0, 0, 9.8))) << "as it is";
  const Vec3d tilted(0, 9.8 * std::sin(0.2), 9.8 * std::cos(0.2));
  EXPECT_FALSE(*choice.consider(up(tilted.x(), tilted.y(), tilted.z()))) << "it may still move";
  EXPECT_FALSE(*choice.consider({})) << "it moves";
  EXPECT_FALSE(*choice.consider(up(tilted.x(), tilted.y(), tilted.z())));
  const auto turned = choice.consider(up(tilted.x(), tilted.y(), tilted.z()));
  ASSERT_TRUE(turned && *turned);
  EXPECT_NEAR(((*turned)->lens.zenith - tilted / 9.8).norm(), 0, 1e-12);
  EXPECT_NE((*turned)->id, base().id);
  EXPECT_EQ((*turned)->id, calibration_id(**turned));
  EXPECT_NEAR(choice.tilt_deg(), 0.2 * 180 / kPi, 1e-9);
  // Less than an accelerometer's own error turns nothing.
  for (int i = 0; i < 5; ++i)
    EXPECT_FALSE(*choice.consider(up(0, 9.8 * std::sin(0.206), 9.8 * std::cos(0.206))));
}

TEST_F(CalibrationChoices, TheBoardsAxesAreTakenIntoAccountAndNoneMeansNoGravity) {
  CalibrationChoice turned(base(), {}, *camera_from_board("y,-x,z"));
  for (int i = 0; i < 2; ++i) (void)turned.consider(up(1, 0, 1));
  EXPECT_NEAR((turned.current().lens.zenith - Vec3d(0, -1, 1).normalized()).norm(), 0, 1e-12);
  CalibrationChoice off(base(), {}, std::nullopt);
  for (int i = 0; i < 3; ++i) EXPECT_FALSE(*off.consider(up(1, 0, 1)));
}

TEST_F(CalibrationChoices, ACameraOnItsHeadIsSaidOnceAndTheLastStays) {
  CalibrationChoice choice(base(), {}, *camera_from_board("x,y,z"));
  const auto refused = choice.consider(up(0, 0, -9.8));
  ASSERT_FALSE(refused);
  EXPECT_FALSE(*choice.consider(up(0.01, 0, -9.8))) << "said once, whatever its digits";
  EXPECT_EQ(choice.current().lens.zenith, Vec3d::UnitZ());
}

TEST_F(CalibrationChoices, TheFixedPatternNearestToTheTemperatureIsPickedWithoutFlutter) {
  write_flat("flat.json", 1, {{"temperature_c", 25.0}, {"dark_temperature_c", 20.0}});
  write_flat("flat_40.json", 2, {{"temperature_c", 40.0}, {"dark_temperature_c", nullptr}});
  write_flat("flat_note.json", 3, nullptr);  // names no temperature
  CalibrationChoice choice = with_flats();
  EXPECT_FALSE(*choice.consider({})) << "no thermometer";
  auto picked = choice.consider(warm(38));
  ASSERT_TRUE(picked && *picked);
  EXPECT_EQ((*picked)->flat.offset_codes[0], 2);
  EXPECT_EQ((*picked)->id, calibration_id(**picked));
  for (const double middle : {29.8, 30.2, 29.6, 30.4}) EXPECT_FALSE(*choice.consider(warm(middle))) << middle;
  picked = choice.consider(warm(29));
  ASSERT_TRUE(picked && *picked);
  EXPECT_EQ((*picked)->flat.offset_codes[0], 1);
}

TEST_F(CalibrationChoices, APatternThatCannotBeReadIsNamedAndTheOneInUseStays) {
  write_flat("flat.json", 1, {{"temperature_c", 20.0}});
  write_flat("flat_40.json", 2, {{"temperature_c", 40.0}});
  CalibrationChoice choice = with_flats();
  ASSERT_TRUE(*choice.consider(warm(20)));
  std::ofstream(folder_.path() / "flat_40.json") << "{";
  const auto refused = choice.consider(warm(41));
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("flat_40.json"), std::string::npos);
  EXPECT_FALSE(*choice.consider(warm(41))) << "said once";
  EXPECT_EQ(choice.current().flat.offset_codes[0], 1);
}

TEST_F(CalibrationChoices, WhatIsNoPatternIsNamed) {
  std::ofstream(folder_.path() / "flat_notes.json") << "[]";
  const auto refused = flats_by_temperature(folder_.path());
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::bad_input);
  EXPECT_NE(refused.error().message.find("flat_notes.json"), std::string::npos);
}

TEST_F(CalibrationChoices, TwoPatternsOfOneTemperatureAreRefused) {
  write_flat("flat.json", 1, {{"temperature_c", 20.0}});
  write_flat("flat_b.json", 2, {{"temperature_c", 20.05}});
  const auto refused = flats_by_temperature(folder_.path());
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("same temperature"), std::string::npos);
}

}  // namespace
}  // namespace lightwell
