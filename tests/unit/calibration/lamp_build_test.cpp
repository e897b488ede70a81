// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/luminaire/lamp_build.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "interface/calibration_io.h"
#include "tests/support/simulated_rig.h"
#include "tests/support/temporary_folder.h"

namespace lightwell::calibration {
namespace {

using test::simulated_rig;
using test::SimulatedRig;
using testing::HasSubstr;

Result<BuiltLamp> build(SimulatedRig& rig, const std::filesystem::path& folder = "rig") {
  return build_lamp(rig.rig, folder,
                    [&](const std::string& file) -> Result<LatLongImage> { return rig.picture(file); });
}
BuiltLamp built(SimulatedRig& rig, const std::filesystem::path& folder = "rig") {
  rig.list_pictures();
  auto lamp = build(rig, folder);
  EXPECT_TRUE(lamp.ok()) << (lamp.ok() ? "" : lamp.error().message);
  return lamp.ok() ? *std::move(lamp) : BuiltLamp();
}
double error_of(const SimulatedRig& rig, const BuiltLamp& lamp, double distance) {
  return test::error_at(rig.lamp, distance, [&](const Vec3d& point, const Vec3d& normal) {
    return illuminance(lamp.lamp, point, normal);
  });
}

// Reach: 2.3e-2, 2e-3, 2e-5, 1e-4 at .2, .4, 1 and 4 distances of the planes.
void expect_rebuilt(const test::AnalyticLamp& lamp, int positions, int pixels) {
  SimulatedRig rig = simulated_rig(lamp, positions, pixels);
  rig.slides = false;
  const BuiltLamp out = built(rig);
  for (const auto& [distance, reach] :
       {std::pair(0.2, 2.3e-2), std::pair(0.4, 2e-3), std::pair(1.0, 2e-5), std::pair(4.0, 1e-4)})
    EXPECT_LE(error_of(rig, out, distance), reach) << distance;
  EXPECT_THAT(out.remarks, testing::IsEmpty());
}
TEST(LampBuild, AReflectorComesBackAtEveryDistance) {
  expect_rebuilt(test::reflector_lamp(), 17, 130);
}
TEST(LampBuild, LedsComeBackAtEveryDistance) {
  expect_rebuilt(test::led_array(), 17, 130);
}
TEST(LampBuild, AFresnelLensComesBackAtEveryDistance) {
  expect_rebuilt(test::fresnel_lamp(), 21, 160);  // narrower lobes, a wider lens
}

// A lamp that few positions span, a little beside the axis.
test::AnalyticLamp small_lamp() {
  const test::LampAxis u{0.02, 0.13, 0, 0.6, 0.4}, v{-0.03, 0.12, 0.1, 0.4, 0.4};
  return {0.1, {{Rgbd(1e6, 8e5, 5e5), {u, v}}}};
}
SimulatedRig small_rig(int positions = 11) {
  SimulatedRig rig = simulated_rig(small_lamp(), positions, 90);
  rig.rig.low_m = Vec2d::Constant(-0.18);
  rig.rig.high_m = -rig.rig.low_m;
  rig.rig.edges = Rig::Edges{rig.rig.low_m, rig.rig.high_m};
  return rig;
}

// The whole way: two slides, a screen that stays while the lamp moves, a camera beside it with a bent lens, vignetting, a
// response of 12 bits, noise, and light in the room.
SimulatedRig camera_rig() {
  SimulatedRig rig = small_rig(9);
  rig.rig.moves = Rig::Moves::lamp;
  rig.rig.unit = Rig::Unit::codes;
  rig.rig.screen_reflectance = 0.85;
  rig.rig.peak_transmission = 0.8;
  rig.rig.dark = "dark.exr";
  rig.rig.pixels = {50, 50};
  rig.rig_exposure_us = rig.rig.dark_exposure_us = 20000;
  rig.picture_size = {160, 160};
  rig.ambient_lux = 3;
  rig.noise = 1e-3;
  Calibration camera;
  camera.response = {LinearResponse{64, 40}, 12, 64, 4000, 10000};
  camera.lens.image_size = rig.picture_size;
  camera.lens.focal = {84, 85};
  camera.lens.center = {79, 81};
  camera.lens.k = {-0.03, 0.004, 0, 0};
  camera.lens.max_theta_rad = 1.4;
  camera.flat.image_size = rig.picture_size;
  camera.flat.vignetting = {-0.1, 0, 0};
  rig.camera = camera;
  return rig;
}

// Of 1100 codes one is noise, quantisation half of one; a pixel is 5 mm wide on a screen of 36 cm.
TEST(LampBuild, ACameraBesideTheScreenSeesTheLamp) {
  SimulatedRig rig = camera_rig();
  const test::TemporaryFolder folder;
  rig.rig.calibration = "camera";
  ASSERT_TRUE(write_calibration(folder.path() / "camera", *rig.camera));
  const BuiltLamp out = built(rig, folder.path());
  for (const double distance : {0.2, 0.4, 1.0, 4.0})
    EXPECT_LE(error_of(rig, out, distance), 0.01) << distance;
  EXPECT_LT(out.mark_rms_px, 1e-4) << "marks are where the lens puts them";
  EXPECT_EQ(out.most_saturated, 0);
  EXPECT_GT(out.most_negative, 0) << "noise about the dark frame";
  EXPECT_LT(out.most_negative, 0.01);
  EXPECT_THAT(out.remarks, testing::IsEmpty());
}

TEST(LampBuild, AMovedLampIsAMovedFilter) {
  SimulatedRig filter = small_rig(9), lamp = small_rig(9);
  // Both see the same pixels: a spacing is a whole number of them.
  filter.rig.pixels = lamp.rig.pixels = {36, 36};
  lamp.rig.moves = Rig::Moves::lamp;
  lamp.rig.edges = Rig::Edges{{-0.22, 0.22}, {0.22, -0.22}};  // upside down
  lamp.picture_size = {44, 44};
  filter.picture_size = {36, 36};
  const BuiltLamp a = built(filter), b = built(lamp);
  double most = 0, difference = 0;
  for (std::size_t i = 0; i < a.measured.irradiance.values.size(); ++i) {
    most = std::max(most, static_cast<double>(a.measured.irradiance.values[i].abs().maxCoeff()));
    difference =
        std::max(difference,
                 static_cast<double>(
                     (a.measured.irradiance.values[i] - b.measured.irradiance.values[i]).abs().maxCoeff()));
  }
  EXPECT_LT(difference, 1e-5 * most);
}

TEST(LampBuild, APositionLeftOutIsMadeOfItsNeighboursAndSaid) {
  SimulatedRig rig = small_rig();
  rig.slides = false;
  rig.list_pictures();
  const auto leave_out = [&](const std::string& file) {
    std::erase_if(rig.rig.pictures, [&](const Rig::Picture& p) { return p.file == file; });
  };
  leave_out("5_6.exr");
  leave_out("0_0.exr");
  const auto out = build(rig);
  ASSERT_TRUE(out) << out.error().message;
  EXPECT_EQ(out->completed, 2u);
  ASSERT_EQ(out->remarks.size(), 2u);
  EXPECT_THAT(out->remarks[0], HasSubstr("-0.05,-0.05 m of the lamp: dark"));
  EXPECT_THAT(out->remarks[1], HasSubstr("0,0.01 m of the lamp: completed from its neighbours"));
  // A spacing is 0.8 of the lamp's width: a cubic through its neighbours is off by some per cent of the one position.
  for (const double distance : {0.4, 1.0, 4.0}) EXPECT_LE(error_of(rig, *out, distance), 0.01) << distance;
}

TEST(LampBuild, AReferenceGivesTheScale) {
  SimulatedRig rig = small_rig(9);
  rig.rig.unit = Rig::Unit::relative;
  rig.rig.reference = Rig::Reference{{0, 0, -0.4}, Vec3d::UnitZ(), 321};
  const BuiltLamp out = built(rig);
  EXPECT_NEAR(luminance(illuminance(out.lamp, {0, 0, -0.4}, Vec3d::UnitZ())), 321, 0.01);
  EXPECT_NEAR(luminance(illuminance(out.measured, LampForm::exact, {0, 0, -0.1}, Vec3d::UnitZ())),
              luminance(illuminance(out.lamp, {0, 0, -0.1}, Vec3d::UnitZ())), 1)
      << "the measurement is scaled alike: of 4284 lux the forms agree within their error";
}

// What the rig of a small lamp is refused for, once something is changed.
template <class F>
void expect_refused(const F& change, const std::string& words) {
  SimulatedRig rig = small_rig(5);
  rig.rig.pixels = rig.picture_size = {20, 20};
  rig.list_pictures();
  std::map<std::string, LatLongImage> changed;
  change(rig, changed);
  const auto out = build_lamp(rig.rig, "rig", [&](const std::string& file) -> Result<LatLongImage> {
    return changed.contains(file) ? changed[file] : rig.picture(file);
  });
  ASSERT_FALSE(out) << words;
  EXPECT_EQ(out.error().kind, ErrorKind::bad_input);
  EXPECT_THAT(out.error().message, HasSubstr(words));
  EXPECT_EQ(out.error().message.find('\n'), std::string::npos);
}
using Changed = std::map<std::string, LatLongImage>;

TEST(LampBuild, BadPositionsAreRefused) {
  expect_refused([](SimulatedRig& r, Changed&) { r.rig.pictures[7].position_m.x() += 0.0007; },
                 "x,y = 0.0107,-0.02: 0.000686 m off the grid of 0.01 m, allowed: up to 0.0002 m");
  expect_refused(
      [](SimulatedRig& r, Changed&) { r.rig.pictures[0].position_m = r.rig.pictures[2].position_m; },
      "the same position and part as in line");
  expect_refused([](SimulatedRig& r, Changed&) { r.rig.pictures.erase(r.rig.pictures.begin()); },
                 "the position has no positive part");
  expect_refused([](SimulatedRig& r, Changed&) { r.rig.pictures[0].part = Rig::Part::whole; },
                 "a part of the filter as well as the whole");
  expect_refused([](SimulatedRig& r, Changed&) { r.rig.pictures.resize(44); },
                 "22 positions of a grid of 5x5, allowed: a tenth missing at most");
  expect_refused([](SimulatedRig& r, Changed&) { r.rig.pictures[0].position_m *= 1e4; },
                 "positions of a grid of");
}

TEST(LampBuild, BadPicturesAreRefused) {
  expect_refused(
      [](SimulatedRig& r, Changed& c) {
        c["1_1p.exr"] = r.picture("1_1p.exr");
        c["1_1p.exr"].at(3, 4)[1] = std::nanf("");
      },
      "1_1p.exr: 1 pixels are no numbers, the first 3,4, allowed: finite values");
  expect_refused([](SimulatedRig& r, Changed&) { r.rig.saturation = 1; },
                 "are saturated, allowed: most_saturated, 0.0001");
  expect_refused(
      [](SimulatedRig& r, Changed& c) {
        c["2_2n.exr"] = r.picture("2_2n.exr");
        c["2_2n.exr"].width = 10, c["2_2n.exr"].height = 40;
      },
      "2_2n.exr: size is 10x40, allowed: 20x20, that of the first picture");
  expect_refused([](SimulatedRig& r, Changed&) { r.rig.edges->first_m.x() += 0.009; },
                 "shows 97.5 % of the measurement plane, allowed: 100 %");
  expect_refused(
      [](SimulatedRig& r, Changed&) {
        r.rig.dark = r.rig.pictures[24].file;  // with the lamp on
      },
      "as negative light, allowed: most_negative, 0.05; is the dark frame of the same exposure?");
  expect_refused(
      [](SimulatedRig& r, Changed& c) {
        r.rig.dark = "dark.exr";
        c["dark.exr"] = r.picture("dark.exr");
        c["dark.exr"].at(0, 0)[0] = INFINITY;
      },
      "dark.exr: pixel 0,0 is no number");
  expect_refused(
      [](SimulatedRig& r, Changed& c) {
        r.rig.dark = "dark.exr";
        r.rig.saturation = 1e9;
        c["dark.exr"] = r.picture("dark.exr");
        c["dark.exr"].at(0, 0)[0] = 2e9F;
      },
      "dark.exr: 0.0025 of its pixels are saturated");
}

// As every one of a crew does once.
TEST(LampBuild, SwappedSlidesAreRefusedAndADarkLampIsSaid) {
  expect_refused(
      [](SimulatedRig& r, Changed& c) {
        for (const Rig::Picture& picture : r.rig.pictures) {
          std::string other = picture.file;  // 1_2p.exr, 1_2n.exr
          char& part = other[other.size() - 5];
          part = part == 'p' ? 'n' : 'p';
          c[picture.file] = r.picture(other);
        }
      },
      "allowed: 0 or more; are the slides positive and negative swapped");
  SimulatedRig dark = small_rig();
  dark.list_pictures();
  const auto built =
      calibration::build_lamp(dark.rig, "", [&](const std::string& file) -> Result<LatLongImage> {
        LatLongImage picture = dark.picture(file);
        for (Rgb& pixel : picture.pixels) pixel.setZero();
        return picture;
      });
  ASSERT_TRUE(built) << built.error().message;
  EXPECT_THAT(built->remarks, testing::Contains(HasSubstr("a dark lamp")));
}

TEST(LampBuild, MarksThatDoNotFixTheScreenAreRefused) {
  const auto with_marks = [](std::vector<Rig::Mark> marks) {
    return [marks](SimulatedRig& r, Changed&) {
      r.rig.edges.reset();
      r.rig.marks = marks;
    };
  };
  const Rig::Mark a{{-0.5, -0.5}, {-0.18, -0.18}}, b{{19.5, -0.5}, {0.18, -0.18}},
      c{{-0.5, 19.5}, {-0.18, 0.18}}, d{{19.5, 19.5}, {0.18, 0.18}};
  expect_refused(with_marks({a, b, {{5, -0.5}, {-0.081, -0.18}}, {{9.5, -0.5}, {0, -0.18}}}),
                 "the marks do not fix how the screen is seen, allowed: four, no three on a line");
  expect_refused(with_marks({a, b, c, d, {{9.5, 9.5}, {0.06, 0}}}),
                 "pixels from where the others put it, allowed: up to 2");
}

}  // namespace
}  // namespace lightwell::calibration
