// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/lens/lens_calibration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "calibration/lens/lens_report.h"
#include "calibration/lens/lens_selection.h"
#include "calibration/lens/lens_start.h"
#include "tests/support/board_views.h"

namespace lightwell::calibration {
namespace {

using testing::HasSubstr;

// A lens of a field of view on a sensor that holds its whole circle, off-centre by a part of its size.
Lens lens_of(double field_of_view_deg, double focal, const std::array<double, 4>& k,
             double off_centre = 0.1) {
  Lens lens;
  lens.max_theta_rad = field_of_view_deg / 2 * kPi / 180;
  lens.focal = {focal, focal};
  lens.k = k;
  const double radius =
      lens.project({std::sin(lens.max_theta_rad), 0, std::cos(lens.max_theta_rad)}).x() - lens.center.x();
  const int size = static_cast<int>(2.5 * radius);
  lens.image_size = {size, size};
  lens.center = {size * (0.5 + off_centre), size * (0.5 - off_centre)};
  return lens;
}

struct NamedLens {
  const char* name;
  Lens lens;
};
std::vector<NamedLens> wide_lenses() {
  return {{"180 equidistant", lens_of(180, 150, {0, 0, 0, 0})},
          {"180 orthographic", lens_of(178, 220, {-0.16, 0.008, -0.0002, 0.00001})},
          {"200", lens_of(200, 300, {-0.05, 0.0013, -0.0028, 0.00025})},
          {"220 stereographic", lens_of(220, 120, {0.05, 0.004, 0.001, -0.0001})}};
}

test::BoardSetup setup_of(const Lens& lens, unsigned seed = 1) {
  test::BoardSetup setup;
  setup.field_rad = lens.max_theta_rad;
  setup.seed = seed;
  return setup;
}

Eigen::Matrix<double, 8, 1> difference(const Lens& a, const Lens& b) {
  Eigen::Matrix<double, 8, 1> d;
  d << a.focal - b.focal, a.center - b.center, 0, 0, 0, 0;
  for (std::size_t i = 0; i < 4; ++i) d[static_cast<Eigen::Index>(4 + i)] = a.k[i] - b.k[i];
  return d;
}

TEST(LensCalibration, FindsWideLensesWithinThreeSigmaFromNoGuess) {
  for (const auto& [name, lens] : wide_lenses()) {
    test::BoardSetup setup = setup_of(lens);
    setup.outliers = 0.05;
    const auto made = test::board_views(lens, setup);
    const auto found = calibrate_lens(made.target_views);
    ASSERT_TRUE(found.ok()) << name << ": " << found.error().message;
    const auto error = difference(found->lens, lens);
    for (Eigen::Index i = 0; i < 8; ++i) {
      const double sigma = std::sqrt(found->covariance(i, i));
      EXPECT_LE(std::abs(error[i]), 3 * sigma) << name << " parameter " << i;
    }
    EXPECT_NEAR(found->noise_px / setup.noise_px, 1, 0.05) << name;
    EXPECT_NEAR(found->rms_px / (std::sqrt(2.0) * setup.noise_px), 1, 0.05) << name;
    // The errors of views not fitted to are larger by what the lens does not know: a few percent.
    EXPECT_NEAR(found->held_out_rms_px / found->rms_px, 1, 0.05) << name;
    EXPECT_TRUE(check(found->lens)) << name;
    EXPECT_NEAR(found->lens.max_theta_rad, lens.max_theta_rad, 0.05) << name;
  }
}

TEST(LensCalibration, ExactPointsGiveTheExactLens) {
  for (const auto& [name, lens] : wide_lenses()) {
    test::BoardSetup setup = setup_of(lens);
    setup.noise_px = 0;
    setup.views = 12;
    const auto found = calibrate_lens(test::board_views(lens, setup).target_views);
    ASSERT_TRUE(found.ok()) << name << ": " << found.error().message;
    EXPECT_LT(found->rms_px, 1e-5) << name;  // where the solver stops
    EXPECT_LT((found->lens.center - lens.center).norm(), 1e-3) << name;
    EXPECT_NEAR(found->lens.focal.x() / lens.focal.x(), 1, 1e-5) << name;
  }
}

TEST(LensCalibration, ExactPointsGiveNoMoreCoefficientsThanTheLensHas) {
  const std::array<double, 4> all = {-0.03, 0.004, -0.001, 0.0002};
  for (std::size_t count = 0; count <= 4; ++count) {
    std::array<double, 4> k{};
    std::copy_n(all.begin(), count, k.begin());
    const Lens lens = lens_of(180, 150, k);
    test::BoardSetup setup = setup_of(lens);
    setup.noise_px = 0;
    setup.views = 12;
    const auto found = calibrate_lens(test::board_views(lens, setup).target_views);
    ASSERT_TRUE(found.ok()) << count << ": " << found.error().message;
    EXPECT_EQ(found->freedom.coefficients, static_cast<int>(count));
    // What is 0 is held there, and says so.
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_EQ(found->lens.k[i] == 0, i >= count);
      EXPECT_EQ(found->covariance(static_cast<Eigen::Index>(4 + i), static_cast<Eigen::Index>(4 + i)) == 0,
                i >= count);
    }
  }
}

// A board photographed twice from a tripod, one file copied and read again, and one moved by a few pixels.
TEST(LensCalibration, APoseThatIsThereTwiceIsNamed) {
  const Lens lens = lens_of(180, 150, {-0.02, 0.004, -0.001, 0.0001});
  test::BoardSetup setup = setup_of(lens);
  setup.noise_px = 0;
  setup.views = 12;
  auto views = test::board_views(lens, setup).target_views;
  TargetView again = views.views[3], moved = views.views[5];
  again.name = "again";
  moved.name = "moved";
  for (auto& p : moved.points) p.pixel.x() += 1;
  views.views.push_back(again);
  views.views.push_back(moved);
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0, 0.1);
  for (auto& view : views.views)
    for (auto& p : view.points) p.pixel += Vec2d(noise(random), noise(random));
  TargetView copy = views.views[7];
  copy.name = "copy";
  views.views.push_back(copy);
  const auto found = calibrate_lens(views);
  ASSERT_TRUE(found.ok()) << found.error().message;
  for (std::size_t v = 0; v < found->views.size(); ++v) {
    const auto& repeats = found->views[v].repeats;
    const std::string& name = found->views[v].name;
    if (name == "again")
      EXPECT_EQ(repeats, 3U);
    else if (name == "copy")
      EXPECT_EQ(repeats, 7U);
    else
      EXPECT_FALSE(repeats) << name;
  }
  const auto warnings = lens_warnings(*found);
  ASSERT_EQ(warnings.size(), 2U);
  EXPECT_THAT(warnings[0], HasSubstr("again shows the board where view 3 does"));
  EXPECT_EQ(lens_report(*found, views)["views"][12]["repeats"], "view 3");
}

TEST(LensCalibration, LeavesOutTheWrongPointsAndNoOthers) {
  const Lens lens = lens_of(200, 300, {-0.05, 0.0013, -0.0028, 0.00025});
  test::BoardSetup setup = setup_of(lens);
  setup.outliers = 0.05;
  const auto made = test::board_views(lens, setup);
  const auto found = calibrate_lens(made.target_views);
  ASSERT_TRUE(found.ok()) << found.error().message;
  std::size_t missed = 0, points = 0;
  for (std::size_t v = 0; v < found->views.size(); ++v) {
    const ViewResult& view = found->views[v];
    EXPECT_TRUE(view.used) << view.name << ": " << view.reason;
    points += made.target_views.views[v].points.size();
    // Beyond 5 sigma: one right point in 300,000.
    for (const std::size_t i : view.rejected)
      EXPECT_EQ(made.wrong.count({v, i}), 1u) << view.name << " " << i;
  }
  std::size_t rejected = 0;
  for (const ViewResult& view : found->views) rejected += view.rejected.size();
  missed = made.wrong.size() - rejected;
  // A wrong point within 0.5 px of the right place cannot be told: π 0.5² of 60², one in 4600.
  EXPECT_LE(missed, 1u) << "of " << made.wrong.size() << " in " << points;
}

TEST(LensCalibration, LeavesOutAViewOfAnotherBoardAndSaysWhy) {
  const Lens lens = lens_of(180, 150, {-0.02, 0.004, -0.001, 0.0001});
  auto views = test::board_views(lens, setup_of(lens)).target_views;
  for (auto& p : views.views[7].points) p.target_mm.y() = 1.3 * p.target_mm.y();  // a board of another pitch
  std::reverse(views.views[11].points.begin(), views.views[11].points.end());
  for (std::size_t i = 0; i < views.views[12].points.size(); ++i)  // points in a wrong order
    views.views[12].points[i].target_mm =
        views.views[12].points[(7 * i + 3) % views.views[12].points.size()].target_mm;
  const auto found = calibrate_lens(views);
  ASSERT_TRUE(found.ok()) << found.error().message;
  for (std::size_t v = 0; v < found->views.size(); ++v) {
    EXPECT_EQ(found->views[v].used, v != 7 && v != 12) << found->views[v].reason;
    EXPECT_EQ(found->views[v].reason.empty(), found->views[v].used);
  }
  EXPECT_LT((found->lens.center - lens.center).norm(), 0.2);  // ten sigma, not the pixels of a wrong board
}

TEST(LensCalibration, PointsBehindTheImagePlaneCount) {
  const Lens lens = lens_of(220, 120, {0, 0, 0, 0});
  const auto views = test::board_views(lens, setup_of(lens)).target_views;
  const auto found = calibrate_lens(views);
  ASSERT_TRUE(found.ok());
  std::size_t behind = 0;
  for (std::size_t v = 0; v < views.views.size(); ++v)
    for (const auto& p : views.views[v].points) behind += lens.theta_rad(p.pixel) > kPi / 2;
  ASSERT_GT(behind, 100u);
  std::size_t rejected = 0;
  for (const auto& view : found->views) rejected += view.rejected.size();
  EXPECT_EQ(rejected, 0u);
  EXPECT_GT(found->lens.max_theta_rad, 105 * kPi / 180);
}

TEST(LensCalibration, SolidTargetsWork) {
  const Lens lens = lens_of(180, 150, {-0.02, 0.004, -0.001, 0.0001});
  auto setup = setup_of(lens);
  setup.noise_px = 0;
  auto views = test::board_views(lens, setup).target_views;
  // Two planes at a right angle: the pixels follow from poses that fit the flat half.
  for (auto& view : views.views) {
    const ViewResult pose = fit_view(lens, view);
    ASSERT_TRUE(pose.used);
    const Eigen::Matrix3d rotation = pose.pose.camera_from_target();
    std::vector<Correspondence> folded;
    for (const auto& p : view.points) {
      const Vec3d target(std::min(p.target_mm.x(), 135.0), p.target_mm.y(),
                         -std::max(0.0, p.target_mm.x() - 135.0));
      const Vec3d seen = rotation * target + pose.pose.translation_mm;
      if (seen.norm() > 100) folded.push_back({target, lens.project(seen)});
    }
    view.points = folded;
  }
  const auto found = calibrate_lens(views);
  ASSERT_TRUE(found.ok()) << found.error().message;
  EXPECT_LT(found->rms_px, 1e-5);
  EXPECT_NEAR(found->lens.focal.x() / lens.focal.x(), 1, 1e-5);
}

TEST(LensCalibration, UnequalAxesAreFoundAndEqualOnesHeld) {
  Lens lens = lens_of(180, 150, {-0.02, 0.004, -0.001, 0.0001});
  lens.focal.y() *= 1.003;
  const auto stretched = calibrate_lens(test::board_views(lens, setup_of(lens)).target_views);
  ASSERT_TRUE(stretched.ok());
  EXPECT_TRUE(stretched->freedom.aspect);
  EXPECT_NEAR(stretched->lens.focal.y() / stretched->lens.focal.x(), 1.003, 0.0005);
  lens.focal.y() = lens.focal.x();
  const auto square = calibrate_lens(test::board_views(lens, setup_of(lens)).target_views);
  ASSERT_TRUE(square.ok());
  EXPECT_FALSE(square->freedom.aspect);
  EXPECT_EQ(square->lens.focal.y(), square->lens.focal.x());
  EXPECT_EQ(square->covariance(1, 1), square->covariance(0, 0));
}

TEST(LensCalibration, TheHeldOutErrorIsOfTheLensThatIsReturned) {
  std::vector<NamedLens> lenses = {wide_lenses()[2], {"30", lens_of(30, 900, {0.05, 0, 0, 0}, 0.02)}};
  for (const auto& [name, lens] : lenses) {
    test::BoardSetup setup = setup_of(lens);
    setup.views = 8;
    setup.columns = setup.rows = 6;
    const TargetViews views = test::board_views(lens, setup).target_views;
    const auto found = calibrate_lens(views);
    ASSERT_TRUE(found.ok()) << name << ": " << found.error().message;
    std::vector<PosedView> posed;
    for (std::size_t v = 0; v < found->views.size(); ++v) {
      const ViewResult& view = found->views[v];
      if (!view.used) continue;
      posed.push_back({view.pose, {}});
      for (std::size_t i = 0; i < views.views[v].points.size(); ++i)
        if (!std::binary_search(view.rejected.begin(), view.rejected.end(), i))
          posed.back().points.push_back(views.views[v].points[i]);
    }
    // The folds stop at a relative change of 1e-7 of the cost, from starts that differ a little.
    EXPECT_NEAR(found->held_out_rms_px / held_out_rms_px(found->lens, posed, found->freedom), 1, 1e-3)
        << name;
  }
}

TEST(LensCalibration, AFieldBeyondThePointsIsExtrapolatedAndSaidToBe) {
  const Lens lens = lens_of(180, 150, {-0.02, 0.004, -0.001, 0.0001});
  test::BoardSetup setup = setup_of(lens);
  setup.field_rad = 80 * kPi / 180;
  setup.views = 12;
  const TargetViews views = test::board_views(lens, setup).target_views;
  auto found = calibrate_lens(views);
  ASSERT_TRUE(found.ok()) << found.error().message;
  const double supported = found->supported_theta_rad;
  EXPECT_EQ(found->lens.max_theta_rad, supported);
  EXPECT_LT(supported, 80.1 * kPi / 180);
  const auto narrow = lens_report(*found, views);
  const double field = 90 * kPi / 180;
  ASSERT_TRUE(set_field(*found, field));
  EXPECT_EQ(found->lens.max_theta_rad, field);
  EXPECT_EQ(found->supported_theta_rad, supported);
  const auto wide = lens_report(*found, views);
  EXPECT_NEAR(wide["max_theta_deg"], 90, 1e-9);
  EXPECT_NEAR(wide["supported_theta_deg"], supported * 180 / kPi, 1e-9);
  const auto& map = wide["projection_uncertainty"];
  EXPECT_NEAR(map["theta_deg"].back(), 90, 1e-9);
  // Where there are points the map says what it said; beyond them it grows.
  EXPECT_NEAR(map["sigma_px"][0][0], narrow["projection_uncertainty"]["sigma_px"][0][0], 1e-12);
  EXPECT_GT(map["largest_sigma_px"],
            1.2 * narrow["projection_uncertainty"]["largest_sigma_px"].get<double>());
  EXPECT_THAT(coverage_gaps(*found, views), HasSubstr("80 to 90 degrees off axis: azimuth"));
}

TEST(LensCalibration, AFieldBeyondWhereTheProjectionGrowsIsRefusedWithTheLimit) {
  LensCalibration calibration;
  calibration.lens.k = {-0.12, 0, 0, 0};  // 1 - 0.36 θ² = 0.001 at 95.4 degrees
  calibration.lens.max_theta_rad = calibration.supported_theta_rad = 1;
  const Status refused = set_field(calibration, 100 * kPi / 180);
  ASSERT_FALSE(refused.ok());
  EXPECT_THAT(refused.error().message, HasSubstr("at most 95.4"));
  EXPECT_EQ(calibration.lens.max_theta_rad, 1);
  EXPECT_TRUE(set_field(calibration, 95.4 * kPi / 180).ok());
  EXPECT_FALSE(set_field(calibration, std::nan("")).ok());
}

TEST(LensCalibration, OnePlaceAtTheEndOfTheWorldIsLeftOut) {
  const Lens lens = lens_of(180, 150, {0, 0, 0, 0});
  auto views = test::board_views(lens, setup_of(lens)).target_views;
  views.views[2].points[3].target_mm.x() = 1e9;  // the largest that a file may hold
  const auto found = calibrate_lens(views);
  ASSERT_TRUE(found.ok()) << found.error().message;
  EXPECT_TRUE(!found->views[2].used || found->views[2].rejected == std::vector<std::size_t>{3});
  EXPECT_LT((found->lens.center - lens.center).norm(), 0.1);
}

TEST(LensCalibration, NumbersThatOverflowAreRefusedWithoutAWordOnStderr) {
  const Lens lens = lens_of(180, 150, {0, 0, 0, 0});
  test::BoardSetup setup = setup_of(lens);
  setup.views = 5;
  auto views = test::board_views(lens, setup).target_views;
  for (auto& view : views.views) view.points[3].target_mm.x() = 1e300;
  testing::internal::CaptureStderr();
  const auto found = calibrate_lens(views);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  ASSERT_FALSE(found.ok());
  EXPECT_EQ(found.error().kind, ErrorKind::bad_input);
}

TEST(LensCalibration, ANarrowFieldGetsFewerCoefficientsAndStaysIncreasing) {
  // 30 degrees off axis, few points, much noise: θ⁹ is out of reach.
  Lens lens = lens_of(60, 500, {0.03, 0, 0, 0}, 0.02);
  test::BoardSetup setup = setup_of(lens);
  setup.views = 6;
  setup.columns = setup.rows = 5;
  setup.pitch_mm = 40;
  setup.noise_px = 0.5;
  const auto found = calibrate_lens(test::board_views(lens, setup).target_views);
  ASSERT_TRUE(found.ok()) << found.error().message;
  EXPECT_LT(found->freedom.coefficients, 4);
  EXPECT_TRUE(check(found->lens));
  for (Eigen::Index i = 4 + found->freedom.coefficients; i < 8; ++i) {
    EXPECT_EQ(found->lens.k[static_cast<std::size_t>(i - 4)], 0);
    EXPECT_TRUE(found->covariance.row(i).isZero(0));
    EXPECT_TRUE(found->covariance.col(i).isZero(0));
  }
}

TEST(LensCalibration, APrintedBoardsShapeIsFoundAndNoneIsInvented) {
  const Lens lens = lens_of(180, 300, {-0.02, 0.004, -0.001, 0.0001});
  test::BoardSetup setup = setup_of(lens);
  setup.noise_px = 0;
  auto views = test::board_views(lens, setup).target_views;
  TargetShape shape = square_shape(views.views);
  shape.change_mm << 0.3, 0.5, 0, 0.4, 0;
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0, 0.1);
  for (auto& view : views.views) {
    const ViewResult pose = fit_view(lens, view);
    for (auto& p : view.points)
      p.pixel =
          lens.project(pose.pose.camera_from_target() * shape.place(p.target_mm) + pose.pose.translation_mm) +
          Vec2d(noise(random), noise(random));
  }
  const auto exact = calibrate_lens(views);
  const auto printed = calibrate_lens(views, TargetTrust::printed);
  ASSERT_TRUE(exact.ok() && printed.ok());
  EXPECT_FALSE(exact->shape);
  ASSERT_TRUE(printed->shape);
  // 3000 points of 0.1 px at some 0.7 px a millimetre: hundredths of a millimetre.
  EXPECT_LT((printed->shape->change_mm - shape.change_mm).cwiseAbs().maxCoeff(), 0.05);
  EXPECT_NEAR(printed->noise_px, 0.1, 0.005);
  EXPECT_GT(exact->noise_px, 1.2 * printed->noise_px);  // what a shape that is not asked for leaves
  const auto square =
      calibrate_lens(test::board_views(lens, setup_of(lens)).target_views, TargetTrust::printed);
  ASSERT_TRUE(square.ok());
  EXPECT_FALSE(square->shape);
  EXPECT_FALSE(calibrate_lens(test::board_views(lens, setup_of(lens)).target_views)->doubted_shape);
  ASSERT_TRUE(exact->doubted_shape);  // said to be exact, and is not
  EXPECT_LT((exact->doubted_shape->change_mm - shape.change_mm).cwiseAbs().maxCoeff(), 0.05);
}

// Rows 10 % farther apart than said: without the board's shape the lens would take a focal length 40 % off, with its
// error stated as 1 %.
TEST(LensCalibration, ABoardOfAnotherPitchAlongOneSideIsRefused) {
  const Lens lens = lens_of(180, 300, {-0.02, 0.004, -0.001, 0.0001});
  auto views = test::board_views(lens, setup_of(lens)).target_views;
  for (auto& view : views.views)
    for (auto& p : view.points) p.target_mm.y() *= 0.9;
  for (const TargetTrust trust : {TargetTrust::exact, TargetTrust::printed}) {
    const auto found = calibrate_lens(views, trust);
    ASSERT_FALSE(found.ok());
    EXPECT_EQ(found.error().kind, ErrorKind::bad_input);
    EXPECT_THAT(found.error().message, HasSubstr("is the board's size right"));
  }
}

TEST(LensStart, TheEpipoleOfTheViewsIsTheCentreOfTheLens) {
  const Lens lens = lens_of(180, 150, {0, 0, 0, 0}, 0.1);
  const auto centers = distortion_centers(test::board_views(lens, setup_of(lens)).target_views);
  ASSERT_GE(centers.size(), 2u);
  // The image's middle is 0.14 of its size off; the views bring that to within a fiftieth.
  EXPECT_LT((centers[0] - lens.center).norm(), 0.02 * lens.image_size[0]);
  EXPECT_LT((centers.back() - Vec2d::Constant((lens.image_size[0] - 1) / 2.0)).norm(), 1e-9);
}

class Refused : public testing::Test {
 protected:
  void expect(const TargetViews& views, const std::string& names) {
    const auto found = calibrate_lens(views);
    ASSERT_FALSE(found.ok()) << names;
    EXPECT_EQ(found.error().kind, ErrorKind::bad_input);
    EXPECT_THAT(found.error().message, HasSubstr(names));
    EXPECT_EQ(found.error().message.find('\n'), std::string::npos);
  }
  Lens lens_ = lens_of(180, 150, {-0.02, 0.004, -0.001, 0.0001});
};

TEST_F(Refused, FewerThanThreeViews) {
  auto views = test::board_views(lens_, setup_of(lens_)).target_views;
  expect({views.image_size, {}}, "0 views");
  views.views.resize(3);
  views.views[1].points.resize(5);
  expect(views, "2 views");
}

TEST_F(Refused, ParallelBoards) {
  // One board moved about without turning: any focal length fits with another distance.
  TargetViews views{lens_.image_size, {}};
  for (int v = 0; v < 8; ++v) {
    TargetView view{"v" + std::to_string(v), {}};
    for (int r = 0; r < 8; ++r)
      for (int c = 0; c < 10; ++c) {
        const Vec3d target(30 * c, 30 * r, 0);
        view.points.push_back(
            {target, lens_.project(target + Vec3d(-400 + 90 * v, -250 + 60 * (v % 4), 150))});
      }
    views.views.push_back(view);
  }
  expect(views, "parallel");
}

TEST_F(Refused, BoardsInTheMiddle) {
  test::BoardSetup setup = setup_of(lens_);
  setup.field_rad = 0.35;
  expect(test::board_views(lens_, setup).target_views, "middle");
}

TEST_F(Refused, PointsOfNoBoard) {
  auto views = test::board_views(lens_, setup_of(lens_)).target_views;
  std::mt19937 random(3);
  for (auto& view : views.views)
    for (auto& p : view.points)
      p.pixel = {double(random() % static_cast<unsigned>(lens_.image_size[0])),
                 double(random() % static_cast<unsigned>(lens_.image_size[1]))};
  expect(views, "fit no lens");
}

TEST_F(Refused, PointsOnALine) {
  auto views = test::board_views(lens_, setup_of(lens_)).target_views;
  for (auto& view : views.views)
    for (auto& p : view.points) p.target_mm = {p.target_mm.x() + 0.01 * p.target_mm.y(), 0, 0};
  expect(views, "the points of view 0, view 1, view 2, view 3, view 4 and 25 more do not determine");
}

TEST_F(Refused, TwoGoodViewsAmongLinesNameTheLines) {
  auto views = test::board_views(lens_, setup_of(lens_)).target_views;
  views.views.resize(4);
  for (const std::size_t v : {1u, 3u})
    for (auto& p : views.views[v].points) p.target_mm = {p.target_mm.x() + 0.01 * p.target_mm.y(), 0, 0};
  expect(views, "usable in 2 views, allowed at least 3: the points of view 1, view 3 do not determine");
}

}  // namespace
}  // namespace lightwell::calibration
