// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <filesystem>

#include "calibration/lens_import/convert_lens.h"
#include "calibration/lens_import/projections.h"
#include "calibration/lens_import/source_lens.h"
#include "interface/atomic_file.h"
#include "tests/support/temporary_folder.h"

namespace lightwell::calibration {
namespace {

using testing::HasSubstr;

const std::filesystem::path kData = std::filesystem::path(LIGHTWELL_TEST_DATA) / "fisheye_cal";

// Directions for the references below, and one more behind the image plane.
const std::vector<Vec3d> kDirections = {{0.1, -0.2, 1}, {0.5, 0.4, 1}, {-0.6, 0.3, 1}, {1.0, -0.7, 0.8}};

void expect_pixels(const Projection& project, const std::vector<Vec3d>& directions,
                   const std::vector<Vec2d>& pixels, double tolerance) {
  ASSERT_LE(pixels.size(), directions.size());
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const auto pixel = project(directions[i]);
    ASSERT_TRUE(pixel) << i;
    EXPECT_LT((*pixel - pixels[i]).norm(), tolerance) << i;
  }
}

// mrcal 2.2: mrcal.project(directions, model, intrinsics), printed with nine decimals.
constexpr double kPrinted = 2e-9;

TEST(SourceProjection, IsMrcalsOwn) {
  const PinholePlane plane{{2000, 2010}, {1500, 1000}};
  const std::array<double, 12> k = {0.11, -0.05, 0.002, -0.003,  0.01,   0.2,
                                    0.03, 0.004, 0.001, -0.0005, 0.0007, 0.0003};
  const auto first = [&](std::size_t n) {
    PlaneDistortion out{};
    std::copy_n(k.begin(), n, out.begin());
    return out;
  };
  expect_pixels(stereographic(plane), kDirections,
                {{1697.560612768, 602.903168337},
                 {2414.313213189, 1735.107823404},
                 {411.149557977, 1547.147347116},
                 {3270.340810557, -245.434760227}},
                kPrinted);
  expect_pixels(
      perspective(plane, first(4)), kDirections,
      {{1700.495000000, 596.603050000}, {2532.835000000, 1834.025380000}, {244.290000000, 1631.446525000}},
      kPrinted);
  expect_pixels(
      perspective(plane, first(5)), kDirections,
      {{1700.495250000, 596.602547500}, {2533.524210000, 1834.579504840}, {243.196500000, 1631.996008750}},
      kPrinted);
  expect_pixels(
      perspective(plane, first(8)), kDirections,
      {{1698.489525001, 600.634054748}, {2450.215585443, 1767.599370696}, {352.997016096, 1576.821249412}},
      kPrinted);
  expect_pixels(
      perspective(plane, first(12)), kDirections,
      {{1698.587025001, 600.705912248}, {2450.867485443, 1768.277604996}, {353.694516096, 1577.576506912}},
      kPrinted);
  expect_pixels(
      cahvor(plane, {0.02, -0.03, 0.01, 0.05, -0.02}), kDirections,
      {{1701.886665395, 593.971011555}, {2526.204383256, 1827.593088207}, {263.118453918, 1622.729465082}},
      kPrinted);
}

TEST(SourceProjection, IsMrcalsSplinedOne) {
  SplinedStereographic model;
  model.plane = {{600, 610}, {500, 400}};
  model.nx = 6;
  model.ny = 5;
  model.fov_x_deg = 170;
  model.control = {0.0069,  0.0164,  0.0066,  -0.0261, 0.0181,  0.0089,  -0.0107, 0.0116,  0.0073,  0.0059,
                   0.0006,  0.0109,  -0.0147, -0.0033, -0.0096, 0.012,   0.0008,  -0.0058, -0.0156, -0.0051,
                   0.0002,  -0.0055, 0.0259,  0.0201,  -0.0542, -0.0378, -0.0035, -0.0084, 0.0043,  0.0043,
                   0.0424,  -0.0222, -0.0076, 0.0409,  0.0129,  0.0133,  -0.0103, -0.033,  0.0033,  0.0022,
                   -0.0245, -0.0137, -0.0014, -0.0189, -0.002,  0.0019,  0.0007,  -0.0101, 0.0119,  0.0178,
                   0.0064,  -0.0164, 0.0146,  -0.01,   0.0176,  -0.0214, 0.0183,  -0.0004, -0.025,  -0.0063};
  model.order = 2;
  expect_pixels(splined_stereographic(model), kDirections,
                {{569.005229654, 273.392020463},
                 {784.324339373, 615.244420348},
                 {172.350268145, 563.773036392},
                 {1031.777963567, 21.538127670}},
                kPrinted);
  model.order = 3;
  expect_pixels(splined_stereographic(model), kDirections,
                {{566.591263358, 274.339547532},
                 {782.403011617, 616.400238992},
                 {174.285903205, 562.610275715},
                 {1035.222645377, 20.110341143}},
                kPrinted);
}

TEST(SourceProjection, IsOpenCvsOwn) {
  // OpenCV 5.0: cv2.fisheye.projectPoints and cv2.omnidir.projectPoints, no rotation, no translation.
  const std::vector<Vec3d> directions = {
      {0.1, -0.2, 1}, {0.5, 0.4, 1}, {-0.6, 0.3, 1}, {1.0, -0.7, 0.4}, {3, 2, 0.1}};
  const PinholePlane plane{{285.5, 286.5}, {421.25, 398.75}};
  expect_pixels(equidistant(plane, {-0.0031, 0.0412, -0.0384, 0.0067}), directions,
                {{449.33632609437115, 342.38059596471226},
                 {548.486721181455, 500.8959071621348},
                 {270.00246391612245, 474.6386498914727},
                 {711.2463215077646, 195.04155068867885},
                 {759.6485640968486, 625.1392320227604}},
                1e-9);
  expect_pixels(omnidirectional(plane, 1.4, {-0.1, 0.02, 0.001, -0.002}), directions,
                {{432.9583557780291, 375.24401790029907},
                 {474.5031479948745, 441.54482477561544},
                 {357.7567153491844, 430.60783897103096},
                 {546.8688383401237, 310.47348271824893},
                 {579.6779262686885, 505.0662618614758}},
                1e-9);
}

// The inverses that their papers give, which the code does not use.
Vec3d double_sphere_ray(double xi, double alpha, const Vec2d& m) {
  const double r2 = m.squaredNorm();
  const double mz = (1 - alpha * alpha * r2) / (alpha * std::sqrt(1 - (2 * alpha - 1) * r2) + 1 - alpha);
  const double s = (mz * xi + std::sqrt(mz * mz + (1 - xi * xi) * r2)) / (mz * mz + r2);
  return {s * m.x(), s * m.y(), s * mz - xi};
}
Vec3d enhanced_unified_ray(double alpha, double beta, const Vec2d& m) {
  const double r2 = m.squaredNorm();
  const double mz =
      (1 - beta * alpha * alpha * r2) / (alpha * std::sqrt(1 - (2 * alpha - 1) * beta * r2) + 1 - alpha);
  return {m.x(), m.y(), mz};
}

TEST(SourceProjection, UndoesTheInversesOfTheUnifiedModels) {
  const PinholePlane plane{{158.3, 158.2}, {255, 257}};
  const auto ds = double_sphere(plane, -0.172, 0.593);
  const auto eucm = enhanced_unified(plane, 0.6, 1.1);
  std::size_t behind = 0;
  for (const Vec2d& m :
       {Vec2d(0, 0), Vec2d(0.3, -0.2), Vec2d(-1.1, 0.5), Vec2d(1.0, 1.2), Vec2d(-1.45, -1.4)}) {
    const Vec2d pixel = plane.focal.cwiseProduct(m) + plane.center;
    const Vec3d ray = double_sphere_ray(-0.172, 0.593, m);
    behind += ray.z() < 0;
    ASSERT_TRUE(ds(3 * ray));
    EXPECT_LT((*ds(3 * ray) - pixel).norm(), 1e-9);  // rounding, at hundreds of pixels
    const Vec3d other = enhanced_unified_ray(0.6, 1.1, m);
    ASSERT_TRUE(eucm(3 * other));
    EXPECT_LT((*eucm(3 * other) - pixel).norm(), 1e-9);
  }
  EXPECT_GT(behind, 0u);
  EXPECT_FALSE(ds({0, 0, -1}));
  EXPECT_FALSE(eucm({0, 0, -1}));
}

TEST(SourceProjection, StereographicIsASpecialCaseOfAllUnifiedModels) {
  const PinholePlane plane{{200, 201}, {320, 240}};
  const PinholePlane half{2 * plane.focal, plane.center};
  for (const Vec3d& d : {Vec3d(0.3, -0.8, 1), Vec3d(2, 1, -0.4), Vec3d(0, 0, 2)}) {
    const Vec2d expected = *stereographic(plane)(d);
    EXPECT_LT((*enhanced_unified(plane, 0.5, 1)(d) - expected).norm(), 1e-9);
    EXPECT_LT((*double_sphere(plane, 0, 0.5)(d) - expected).norm(), 1e-9);
    EXPECT_LT((*omnidirectional(half, 1, {})(d) - expected).norm(), 1e-9);
  }
}

TEST(SourceProjection, FieldOfViewIsTheAngleOfItsPaper) {
  // r_d = atan(2 r_u tan(w / 2)) / w; with 2 tan(w / 2) = 1 the distance is the angle itself over w.
  const double w = 2 * std::atan(0.5);
  const auto project = field_of_view({{100, 100}, {50, 60}}, w);
  for (const double theta : {0.0, 0.3, 1.2})
    EXPECT_LT((*project({std::sin(theta), 0, std::cos(theta)}) - Vec2d(50 + 100 * theta / w, 60)).norm(),
              1e-9);
}

class LensImport : public testing::Test {
 protected:
  std::string file(const std::string& text, const std::string& name = "source") const {
    const auto path = folder_.path() / name;
    EXPECT_TRUE(write_file_atomically(path, text));
    return path.string();
  }
  Result<SourceLens> read(const std::string& text, const SourceLensOptions& options = {}) const {
    return read_source_lens(file(text), options);
  }
  LensConversion converted(const std::string& text, std::optional<double> max_theta = {}) const {
    const auto source = read(text);
    if (!source) {
      ADD_FAILURE() << source.error().message;
      return {};
    }
    const auto out = convert_lens(*source, max_theta);
    EXPECT_TRUE(out.ok()) << (out.ok() ? "" : out.error().message);
    return out.ok() ? *out : LensConversion{};
  }
  void expect_refused(const std::string& text, const std::string& names,
                      ErrorKind kind = ErrorKind::bad_input, const SourceLensOptions& options = {}) const {
    const auto source = read(text, options);
    ASSERT_FALSE(source.ok()) << text;
    EXPECT_EQ(source.error().kind, kind);
    EXPECT_THAT(source.error().message, HasSubstr(names));
    EXPECT_THAT(source.error().message, HasSubstr("source"));  // the file
    EXPECT_EQ(source.error().message.find('\n'), std::string::npos) << source.error().message;
  }

 private:
  test::TemporaryFolder folder_;
};

const std::string kYaml = R"(%YAML:1.0
---
image_width: 848
image_height: 800
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 285.5, 0., 421.25, 0., 286.5, 398.75, 0., 0., 1. ]
distortion_coefficients: !!opencv-matrix
   rows: 4
   cols: 1
   dt: d
   data: [ -0.0030999999999999999, 0.041200000000000001,
       -0.038399999999999997, 0.0067000000000000002 ]
)";
const std::string kXml = R"(<?xml version="1.0"?>
<opencv_storage>
<image_width>848</image_width>
<image_height>800</image_height>
<camera_matrix type_id="opencv-matrix">
  <rows>3</rows>
  <cols>3</cols>
  <dt>d</dt>
  <data>
    285.5 0. 421.25 0. 286.5 398.75 0. 0. 1.</data></camera_matrix>
<distortion_coefficients type_id="opencv-matrix">
  <rows>4</rows>
  <cols>1</cols>
  <dt>d</dt>
  <data>
    -0.0030999999999999999 0.041200000000000001 -0.038399999999999997
    0.0067000000000000002</data></distortion_coefficients>
</opencv_storage>
)";
const std::string kKalibr = R"(cam0:
  cam_overlaps: [1]
  camera_model: pinhole
  distortion_coeffs: [-0.0031, 0.0412, -0.0384, 0.0067]
  distortion_model: equidistant
  intrinsics: [285.5, 286.5, 421.25, 398.75]
  resolution: [848, 800]
  rostopic: /cam0/image_raw
cam1:
  T_cn_cnm1:
  - [1.0, 0.0, 0.0, -0.1]
  - [0.0, 1.0, 0.0, 0.0]
  - [0.0, 0.0, 1.0, 0.0]
  - [0.0, 0.0, 0.0, 1.0]
  camera_model: ds
  distortion_coeffs: []
  distortion_model: none
  intrinsics: [-0.17213086034353243, 0.5931177593944744, 158.28600034966977, 158.2743455478755, 254.96116578191653, 256.8894394501779]
  resolution: [512, 512]
)";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

void expect_the_lens(const LensConversion& c) {
  EXPECT_TRUE(c.exact);
  EXPECT_EQ(c.lens.image_size, (std::array<int, 2>{848, 800}));
  EXPECT_EQ(c.lens.focal, Vec2d(285.5, 286.5));
  EXPECT_EQ(c.lens.center, Vec2d(421.25, 398.75));
  EXPECT_EQ(c.lens.k, (std::array<double, 4>{-0.0031, 0.0412, -0.0384, 0.0067}));
  EXPECT_TRUE(check(c.lens));
  EXPECT_LT(c.error.max_px, 1e-9);
  EXPECT_LT(c.error.max_deg, 1e-9);
}

TEST_F(LensImport, OpenCvsFilesInAllThreeFormsAreExact) {
  expect_the_lens(converted(kYaml, 1.5));
  expect_the_lens(converted(kXml, 1.5));
  expect_the_lens(converted(
      R"({"K": [[285.5, 0.0, 421.25], [0.0, 286.5, 398.75], [0.0, 0.0, 1.0]],
          "D": [[-0.0031], [0.0412], [-0.0384], [0.0067]], "DIM": [848, 800]})",
      1.5));
  // Under ROS's names, which also say the model.
  expect_the_lens(converted(
      "image_width: 848\nimage_height: 800\ncamera_name: probe\n"
      "camera_matrix:\n  rows: 3\n  cols: 3\n"
      "  data: [285.5, 0, 421.25, 0, 286.5, 398.75, 0, 0, 1]\n"
      "distortion_model: equidistant\n"
      "distortion_coefficients:\n  rows: 1\n  cols: 4\n  data: [-0.0031, 0.0412, -0.0384, 0.0067]\n",
      1.5));
}

TEST_F(LensImport, KalibrsEquidistantIsExact) {
  const auto source = read(kKalibr, {{}, "cam0"});
  ASSERT_TRUE(source.ok()) << source.error().message;
  EXPECT_EQ(source->model, "pinhole-equidistant");
  const auto c = convert_lens(*source, 1.5);
  ASSERT_TRUE(c.ok()) << c.error().message;
  expect_the_lens(*c);
}

TEST_F(LensImport, WithoutALimitTheFieldIsWhatTheImageShows) {
  const LensConversion c = converted(kYaml);
  // The corner farthest from the centre, (-0.5, -0.5), in pixels over the focal length: its angle is the field's.
  const double corner = c.lens.theta_rad({-0.5, -0.5});
  EXPECT_LE(c.lens.max_theta_rad, corner + 1e-9);
  EXPECT_GT(c.lens.max_theta_rad, corner - 0.05);  // azimuths are 5 degrees apart
}

TEST_F(LensImport, ACentreOutsideTheImageIsOfAnotherSizeAndRefused) {
  const auto source =
      read(replaced(kKalibr, "resolution: [848, 800]", "resolution: [424, 400]"), {{}, "cam0"});
  ASSERT_TRUE(source.ok()) << source.error().message;
  EXPECT_TRUE(convert_lens(*source, 1.0).ok());  // just inside
  const auto smaller =
      read(replaced(kKalibr, "resolution: [848, 800]", "resolution: [420, 400]"), {{}, "cam0"});
  ASSERT_TRUE(smaller.ok()) << smaller.error().message;
  const auto c = convert_lens(*smaller, 1.0);
  ASSERT_FALSE(c.ok());
  EXPECT_EQ(c.error().kind, ErrorKind::bad_input);
  EXPECT_THAT(c.error().message, HasSubstr("(421.2, 398.8) lies outside the image of 420x400"));
}

TEST_F(LensImport, AFieldBeyondWhereTheProjectionGrowsIsRefusedWithTheLimit) {
  // 1 - 3 · 0.12 θ² = 0.001 at θ = 1.6658: 95.4 degrees.
  const auto source =
      read(replaced(kYaml,
                    "-0.0030999999999999999, 0.041200000000000001,\n       -0.038399999999999997, "
                    "0.0067000000000000002",
                    "-0.12, 0, 0, 0"));
  ASSERT_TRUE(source.ok()) << source.error().message;
  EXPECT_TRUE(convert_lens(*source, 95.0 * kPi / 180).ok());
  const auto c = convert_lens(*source, 100.0 * kPi / 180);
  ASSERT_FALSE(c.ok());
  EXPECT_EQ(c.error().kind, ErrorKind::usage);
  EXPECT_THAT(c.error().message, HasSubstr("95."));
}

TEST_F(LensImport, ADoubleSphereIsFollowedToAHundredthOfAPixel) {
  // TUM VI's first camera.
  const auto source = read(kKalibr, {{}, "cam1"});
  ASSERT_TRUE(source.ok()) << source.error().message;
  const auto c = convert_lens(*source, 97 * kPi / 180);
  ASSERT_TRUE(c.ok()) << c.error().message;
  EXPECT_FALSE(c->exact);
  EXPECT_EQ(c->coefficients, 4);
  EXPECT_LT(c->error.rms_px, 0.01);
  // The error that is reported is the error: over directions of its own, not those of the fit.
  const auto truth =
      double_sphere({{158.28600034966977, 158.2743455478755}, {254.96116578191653, 256.8894394501779}},
                    -0.17213086034353243, 0.5931177593944744);
  double weight = 0, px2 = 0, largest = 0;
  for (int i = 0; i < 20000; ++i) {
    const double z = 1 - (1 - std::cos(c->lens.max_theta_rad)) * (i + 0.5) / 20000;  // equal areas
    const double phi = i * 2.399963229728653;                                        // the golden angle
    const double h = std::sqrt(1 - z * z);
    const Vec3d d(h * std::cos(phi), h * std::sin(phi), z);
    const auto pixel = truth(d);
    ASSERT_TRUE(pixel);
    if (!(pixel->minCoeff() >= -0.5 && pixel->maxCoeff() <= 511.5)) continue;
    const double e = (c->lens.project(d) - *pixel).norm();
    weight += 1;
    px2 += e * e;
    largest = std::max(largest, e);
  }
  // Both sums stand for the same integral, over 14,400 and 20,000 directions.
  EXPECT_NEAR(c->error.rms_px / std::sqrt(px2 / weight), 1, 0.02);
  EXPECT_NEAR(c->error.max_px / largest, 1, 0.1);
}

TEST_F(LensImport, ACameraFrameThatIsTurnedAgainstTheImageIsFound) {
  const Lens lens{{900, 800}, {280, 281}, {455, 395}, {-0.02, 0.004, -0.001, 0.0001}, 80 * kPi / 180};
  const Vec3d turn(0.03, -0.02, 0.07);
  const Eigen::AngleAxisd ours_from_source(turn.norm(), turn.normalized());
  SourceLens source;
  source.image_size = lens.image_size;
  source.project = [=](const Vec3d& d) -> std::optional<Vec2d> {
    const Vec3d ours = ours_from_source * d;
    return std::atan2(ours.head<2>().norm(), ours.z()) < 1.5 ? std::optional(lens.project(ours))
                                                             : std::nullopt;
  };
  const auto c = convert_lens(source, {});
  ASSERT_TRUE(c.ok()) << c.error().message;
  EXPECT_LT((c->turn - turn).norm(), 1e-6);  // where the solver stops
  EXPECT_LT((c->lens.center - lens.center).norm(), 1e-3);
  EXPECT_LT(c->error.max_px, 1e-3);
  const Vec3d up(0.1, -0.2, 0.97);
  EXPECT_LT((turned(*c, up) - ours_from_source * up).norm(), 1e-6);
}

TEST_F(LensImport, AFieldBeyondWhatTheImageShowsIsExtrapolatedAndSaidToBe) {
  const auto source = read(kYaml, {{}, "", "fisheye"});
  ASSERT_TRUE(source.ok()) << source.error().message;
  const auto shown = convert_lens(*source, {});
  ASSERT_TRUE(shown.ok()) << shown.error().message;
  EXPECT_EQ(shown->supported_theta_rad, shown->lens.max_theta_rad);
  const double wide = shown->lens.max_theta_rad + 0.1, narrow = shown->lens.max_theta_rad - 0.1;
  const auto beyond = convert_lens(*source, wide), within = convert_lens(*source, narrow);
  ASSERT_TRUE(beyond.ok()) << beyond.error().message;
  ASSERT_TRUE(within.ok()) << within.error().message;
  EXPECT_EQ(beyond->lens.max_theta_rad, wide);
  EXPECT_NEAR(beyond->supported_theta_rad, shown->lens.max_theta_rad, 1e-12);
  EXPECT_NEAR(import_report(*source, *beyond)["supported_theta_deg"], beyond->supported_theta_rad * 180 / kPi,
              1e-12);
  EXPECT_EQ(within->supported_theta_rad, narrow);
}

TEST_F(LensImport, AnOpenCvFileThatNamesNoModelIsAssumedToBeAFisheyesAndSaysSo) {
  const auto assumed = read(kYaml), stated = read(kYaml, {{}, "", "fisheye"});
  ASSERT_TRUE(assumed.ok() && stated.ok());
  EXPECT_TRUE(assumed->assumed);
  EXPECT_FALSE(stated->assumed);
  EXPECT_EQ(import_report(*assumed, *convert_lens(*assumed, 1.5))["imported"]["assumed"], "cv::fisheye");
  EXPECT_FALSE(import_report(*stated, *convert_lens(*stated, 1.5))["imported"].contains("assumed"));
  // A pinhole camera's plane comes before either model.
  EXPECT_TRUE(read(kYaml + "camera_model: pinhole\n")->assumed);
  for (const char* name : {"distortion_model: equidistant", "fisheye_model: 1", "model: KB4", "xi: 1.2",
                           "distortion_model: omnidir\nxi: 1.2"}) {
    const auto named = read(kYaml + name + "\n");
    ASSERT_TRUE(named.ok()) << named.error().message;
    EXPECT_FALSE(named->assumed) << name;
    EXPECT_EQ(named->model,
              std::string(name).find("xi") == std::string::npos ? "cv::fisheye" : "cv::omnidir");
  }
}

TEST_F(LensImport, AFileThatCouldBeAPerspectiveLensIsRefusedUnlessTheModelIsStated) {
  // OpenCV's own calibration of its sample pictures, left01.jpg to left14.jpg: k1, k2, p1, p2 with k3 held at 0.
  const std::string webcam =
      "%YAML:1.0\nimage_width: 640\nimage_height: 480\n"
      "camera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n"
      "   data: [ 535.9, 0., 342.3, 0., 535.9, 235.6, 0., 0., 1. ]\n"
      "distortion_coefficients: !!opencv-matrix\n   rows: 4\n   cols: 1\n   dt: d\n"
      "   data: [ -0.2664, -0.0386, 0.0018, -0.0003 ]\n";
  expect_refused(webcam, "names no lens model", ErrorKind::usage);
  expect_refused(webcam, "--model fisheye states it", ErrorKind::usage);
  EXPECT_TRUE(read(webcam, {{}, "", "fisheye"}).ok());
  EXPECT_TRUE(read(webcam + "distortion_model: fisheye\n").ok());
  // The farthest corner, 426.25 and 400.75 px off: 2.05 focal lengths; with one of 300 px across 1.99.
  EXPECT_TRUE(read(kYaml).ok());
  expect_refused(replaced(kYaml, "285.5", "300"), "1.99 focal lengths", ErrorKind::usage);
}

TEST_F(LensImport, AModelAtOddsWithXiOrWithTheOptionIsRefused) {
  expect_refused(kYaml + "distortion_model: omnidir\n", "xi is missing");
  expect_refused(kYaml + "distortion_model: fisheye\nxi: 1.2\n", "distortion_model = \"fisheye\"");
  expect_refused(kYaml + "fisheye_model: 1\nxi: 1.2\n", "fisheye_model = 1: allowed omnidir");
  expect_refused(kYaml + "model: omnidir\ndistortion_model: fisheye\n", "contradicts");
  expect_refused(kYaml, "xi is missing", ErrorKind::bad_input, {{}, "", "omnidir"});
  for (const auto& [line, asked] :
       {std::pair("model: fisheye\n", "omnidir"), std::pair("xi: 1.2\n", "fisheye")}) {
    const auto refused = read(kYaml + line, {{}, "", asked});
    ASSERT_FALSE(refused.ok());
    EXPECT_EQ(refused.error().kind, ErrorKind::usage);
    EXPECT_THAT(refused.error().message, HasSubstr("--model is \"" + std::string(asked)));
    EXPECT_THAT(refused.error().message, HasSubstr("source says"));  // the file
  }
  expect_refused(kKalibr, "--model", ErrorKind::usage, {{}, "cam0", "fisheye"});
  expect_refused(replaced(kYaml, "0.0067000000000000002 ]", "0.0067, 0.1 ]"), "perspective");
}

TEST_F(LensImport, EveryModelThatKalibrWritesIsRead) {
  const auto with = [](const std::string& model, const std::string& intrinsics, const std::string& distortion,
                       const std::string& numbers) {
    return "cam0:\n  camera_model: " + model + "\n  intrinsics: [" + intrinsics +
           "]\n  distortion_model: " + distortion + "\n  distortion_coeffs: [" + numbers +
           "]\n  resolution: [640, 480]\n";
  };
  for (const std::string& text :
       {with("pinhole", "400, 401, 320, 240", "radtan", "-0.2, 0.05, 0.001, -0.001"),
        with("pinhole", "400, 401, 320, 240", "none", ""),
        with("pinhole", "300, 301, 320, 240", "fov", "0.9"),
        with("omni", "1.4, 500, 501, 320, 240", "radtan", "-0.1, 0.02, 0.001, -0.001"),
        with("omni", "0.9, 400, 401, 320, 240", "none", ""),
        with("eucm", "0.6, 1.1, 200, 201, 320, 240", "none", "")}) {
    const LensConversion c = converted(text);
    EXPECT_TRUE(check(c.lens)) << text;
    EXPECT_LT(c.error.rms_px, 0.5) << text;
    EXPECT_LE(c.error.rms_px, c.error.max_px) << text;
  }
}

const std::string kOcam =
    R"(#polynomial coefficients for the DIRECT mapping function (ocam_model.ss in MATLAB). These are used by cam2world

5 -4.714441e+02 0.000000e+00 7.356108e-04 -3.773045e-07 5.800006e-10

#polynomial coefficients for the inverse mapping function (ocam_model.invpol in MATLAB). These are used by world2cam

10 772.405470 504.754051 7.034666 45.327180 54.651570 0.458049 -7.873745 15.588713 13.743404 2.968883

#center: "row" and "column", starting from 0 (C convention)

794.308657 798.175741

#affine parameters "c", "d", "e"

1.000305 -0.000277 -0.000925

#image size: "height" and "width"

1600 1500
)";

// OCamCalib's cam2world: row and column from 0, the direction of its frame (row, column, away from the scene).
Vec3d ocam_direction(double row, double column) {
  const double c = 1.000305, d = -0.000277, e = -0.000925;
  const double u = row - 794.308657, v = column - 798.175741;
  const double inverse = 1 / (c - d * e);
  const double x = inverse * (u - d * v), y = inverse * (-e * u + c * v);
  const double rho = std::hypot(x, y);
  const double z =
      -471.4441 + 7.356108e-4 * rho * rho - 3.773045e-7 * std::pow(rho, 3) + 5.800006e-10 * std::pow(rho, 4);
  return {x, y, z};
}

TEST_F(LensImport, OcamCalibsRowsColumnsAndAxesAreRight) {
  const auto source = read(kOcam);
  ASSERT_TRUE(source.ok()) << source.error().message;
  EXPECT_EQ(source->image_size, (std::array<int, 2>{1500, 1600}));  // its height stands first
  const double inverse[] = {772.405470, 504.754051, 7.034666,  45.327180, 54.651570,
                            0.458049,   -7.873745,  15.588713, 13.743404, 2.968883};
  for (const auto& [row, column] :
       {std::pair{794.308657, 798.175741}, {100., 700.}, {1300., 1200.}, {800., 30.}}) {
    const Vec3d ocam = ocam_direction(row, column);
    const Vec3d ours(ocam.y(), ocam.x(), -ocam.z());  // right, down, toward the scene
    const auto pixel = source->project(ours);
    ASSERT_TRUE(pixel);
    EXPECT_LT((*pixel - Vec2d(column, row)).norm(), 1e-6) << row << " " << column;
    // Its world2cam approximates this by the second polynomial.
    const double norm = std::hypot(ocam.x(), ocam.y());
    if (norm == 0) continue;
    const double t = std::atan(ocam.z() / norm);
    double rho = 0;
    for (int i = 9; i >= 0; --i) rho = rho * t + inverse[i];
    const double x = ocam.x() / norm * rho, y = ocam.y() / norm * rho;
    const Vec2d approximate(-0.000925 * x + y + 798.175741, 1.000305 * x - 0.000277 * y + 794.308657);
    EXPECT_LT((*pixel - approximate).norm(), 0.5) << row << " " << column;
  }
  const LensConversion c = converted(kOcam, 95 * kPi / 180);
  EXPECT_LT((c.lens.center - Vec2d(798.175741, 794.308657)).norm(), 1);  // its shear moves the fit by less
  EXPECT_LT(c.error.rms_px, 0.5);  // a thousandth of its shear at the edge
}

TEST_F(LensImport, RealFilesOfMrcalAndOcamCalib) {
  const auto ocam = kData / "ocam_matsuren" / "calib_results_0.txt";
  const auto opencv8 = kData / "mrcal_figueroa" / "opencv8-0.cameramodel";
  const auto splined = kData / "mrcal_figueroa" / "splined-0.cameramodel";
  for (const auto& path : {ocam, opencv8, splined})
    if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
  // mrcal 2.2: mrcal.project at 5, 30, 60 and 75 degrees off axis, azimuths 10, 130 and 250.
  std::vector<Vec3d> directions;
  for (const double theta : {5., 30., 60., 75.})
    for (const double phi : {10., 130., 250.}) {
      const double t = theta * kPi / 180, p = phi * kPi / 180;
      directions.emplace_back(std::sin(t) * std::cos(p), std::sin(t) * std::sin(p), std::cos(t));
    }
  const auto a = read_source_lens(opencv8, {});
  const auto b = read_source_lens(splined, {});
  ASSERT_TRUE(a.ok() && b.ok());
  EXPECT_EQ(a->image_size, (std::array<int, 2>{6016, 4016}));
  EXPECT_GT(a->valid_region.size(), 10u);
  constexpr double kSixDecimals = 2e-6;
  expect_pixels(a->project, directions,
                {{3182.978712, 2028.869915},
                 {2888.313824, 2136.305034},
                 {2942.766809, 1826.961006},
                 {4087.335351, 2188.638777},
                 {2297.984476, 2841.066634},
                 {2628.691695, 962.609092},
                 {5259.117296, 2395.867340},
                 {1532.728474, 3754.803010},
                 {2221.774181, -156.893898},
                 {5924.536556, 2514.446984},
                 {1096.646136, 4276.081919},
                 {1990.832568, -790.761271}},
                kSixDecimals);
  expect_pixels(b->project, directions,
                {{3263.610853, 1945.700767},
                 {2973.688357, 2066.188631},
                 {3013.702050, 1754.505921},
                 {4176.402842, 2071.657941},
                 {2417.592395, 2794.324768},
                 {2651.922574, 907.338641},
                 {5363.453313, 2250.752947},
                 {1699.588647, 3728.997096},
                 {2118.701514, -132.662623},
                 {6041.436671, 2313.929500},
                 {1222.061746, 4300.309173},
                 {2291.145178, -2377.196639}},
                kSixDecimals);
  for (const auto& path : {ocam, opencv8, splined}) {
    const auto source = read_source_lens(path, {});
    ASSERT_TRUE(source.ok()) << source.error().message;
    const auto c = convert_lens(*source, {});
    ASSERT_TRUE(c.ok()) << path << c.error().message;
    EXPECT_TRUE(check(c->lens));
    EXPECT_GT(c->lens.max_theta_rad, 60 * kPi / 180);
    // The lenses are nearly ours: to a pixel over all of the field; splines, which follow noise too, to two of 6016.
    EXPECT_LT(c->error.rms_px, path == splined ? 2 : 1) << path;
    // Its camera frame is rolled by some degrees against the image.
    EXPECT_EQ(c->turn.norm() > 0.01, path == splined) << path;
    RecordProperty("rms_px " + path.filename().string(), std::to_string(c->error.rms_px));
  }
}

TEST_F(LensImport, ACahvorFileIsFollowedWithinItsSaidError) {
  const auto source = read(
      "{ 'lensmodel': 'LENSMODEL_CAHVOR',\n 'intrinsics': [ 2000, 2010, 1500, 1000, 0.02, -0.03, 0.01, 0.05, "
      "-0.02 ],\n"
      " 'imagersize': [ 3000, 2000 ], }\n");
  ASSERT_TRUE(source.ok()) << source.error().message;
  EXPECT_EQ(source->model, "LENSMODEL_CAHVOR");
  const auto c = convert_lens(*source, {});
  ASSERT_TRUE(c.ok()) << c.error().message;
  EXPECT_FALSE(c->exact);
  EXPECT_LT(c->error.rms_px, 1);  // of a lens whose axis is off the image's by two degrees
  // Where mrcal itself projects (SourceProjection.IsMrcalsOwn).
  const std::pair<Vec3d, Vec2d> mrcals[] = {{{0.1, -0.2, 1}, {1701.886665395, 593.971011555}},
                                            {{0.5, 0.4, 1}, {2526.204383256, 1827.593088207}},
                                            {{-0.6, 0.3, 1}, {263.118453918, 1622.729465082}}};
  for (const auto& [direction, pixel] : mrcals)
    EXPECT_LE((c->lens.project(turned(*c, direction)) - pixel).norm(), 1.01 * c->error.max_px) << pixel;
  const auto beyond = convert_lens(*source, c->supported_theta_rad + 0.1);
  ASSERT_TRUE(beyond.ok()) << beyond.error().message;
  EXPECT_LT(beyond->supported_theta_rad, beyond->lens.max_theta_rad);
}

TEST_F(LensImport, RoundTripsAndSolidAnglesOfImportedLensesAreExact) {
  const auto ds = convert_lens(*read(kKalibr, {{}, "cam1"}), 95 * kPi / 180);
  ASSERT_TRUE(ds.ok());
  for (const Lens& imported :
       {converted(kYaml, 70 * kPi / 180).lens, ds->lens, converted(kOcam, 88 * kPi / 180).lens}) {
    double largest = 0;
    for (int i = 0; i <= 400; ++i)
      for (const double phi : {0.1, 2.0, 4.5}) {
        const double t = imported.max_theta_rad * i / 400;
        const Vec3d d(std::sin(t) * std::cos(phi), std::sin(t) * std::sin(phi), std::cos(t));
        largest = std::max(largest, imported.unproject(imported.project(d)).cross(d).norm());
      }
    EXPECT_LT(largest, 1e-9);
    // The cap's sum needs the whole circle: on an image that holds it.
    Lens whole = imported;
    whole.focal /= 4;  // of fewer pixels, for the time it takes
    const double radius =
        (whole.project({std::sin(whole.max_theta_rad), 0, std::cos(whole.max_theta_rad)}) - whole.center)
            .norm();
    const int size = static_cast<int>(std::ceil(2.1 * radius));
    whole.image_size = {size, size};
    whole.center = Vec2d::Constant(size / 2.0) + Vec2d(0.3, -0.2);
    double sum = 0;
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x) sum += whole.pixel_solid_angle_sr({x, y});
    EXPECT_NEAR(sum / (2 * kPi * (1 - std::cos(whole.max_theta_rad))), 1, 1e-6);
  }
}

TEST_F(LensImport, OpenCvsFilesAreRefusedByFieldAndValue) {
  expect_refused(replaced(kYaml, "285.5, 0.,", "285.5, 0.5,"), "skew");
  expect_refused(replaced(kYaml, "285.5, 0.,", ".Nan, 0.,"), "finite");
  expect_refused(replaced(kYaml, "285.5, 0.,", "-285.5, 0.,"), "fx = -285.5");
  expect_refused(replaced(kYaml, "0., 0., 1.", "0., 0., 2."), "[2][2]");
  expect_refused(replaced(kYaml, "image_width: 848\n", ""), "image_width is missing");
  expect_refused(replaced(kYaml, "848", "848.5"), "848.5");
  expect_refused(replaced(kYaml, "848", "0"), "image_width");
  expect_refused(replaced(kYaml, "0.0067000000000000002 ]", "0.0067, 0.1 ]"), "5 numbers");
  expect_refused(replaced(kYaml, "distortion_coefficients", "other"), "distortion_coefficients is missing");
  expect_refused(replaced(kYaml, "camera_matrix", "other"), "camera_matrix is missing");
  expect_refused(kYaml + "distortion_model: plumb_bob\n", "plumb_bob");
  expect_refused(kYaml + "fisheye_model: 0\n", "fisheye_model");
  expect_refused(kYaml.substr(0, 200), "line");
  expect_refused(kXml.substr(0, 300), "XML");
  for (std::size_t length = 40; length < kXml.size() - 20; length += 7)
    EXPECT_FALSE(read(kXml.substr(0, length)).ok()) << length;  // cut anywhere
  expect_refused(replaced(kXml, "285.5", ".Nan"), "finite");
  std::string deep = "<opencv_storage>";
  for (int i = 0; i < 100000; ++i) deep += "<a>";
  expect_refused(deep, "too deep");
  // Entities are not expanded.
  expect_refused(replaced(replaced(kXml, "<opencv_storage>",
                                   "<!DOCTYPE a [<!ENTITY b \"84\"><!ENTITY c \"&b;8\">]><opencv_storage>"),
                          "<image_width>848", "<image_width>&c;"),
                 "image_width = \"&c;\"");
  expect_refused("<?xml version=\"1.0\"?><svg/>", "expected <opencv_storage>");
  expect_refused("<?xml version=\"1.0\"?>", "expected <opencv_storage>");
  expect_refused("image_width: [\n", "line");
  expect_refused("", "format");
  expect_refused("just a sentence", "format");
}

TEST_F(LensImport, YamlThatHoldsItselfOrNeverEndsIsRefused) {
  expect_refused("a: &x [*x]\n", "too deep");
  expect_refused("a: &x\n  b: *x\n", "too deep");
  expect_refused("a: &x [[*x], *x]\nb: &y {c: *x, d: *y}\n", "too deep");
  for (const char* opening : {"[", "{a: ", "- "}) {
    std::string deep = "a:\n ";
    for (int i = 0; i < 100000; ++i) deep += opening;
    expect_refused(deep, "line 2");
  }
  std::string forty = "a: ";
  for (int i = 0; i < 40; ++i) forty += '[';
  expect_refused(forty + std::string(40, ']') + "\n", "too deep");
  std::string bomb = "a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]\n";
  for (int i = 1; i < 9; ++i) {
    bomb += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [";
    for (int n = 0; n < 10; ++n) bomb += (n > 0 ? ", *a" : "*a") + std::to_string(i - 1);
    bomb += "]\n";
  }
  expect_refused(bomb, "more than a million values");
  std::string texts = "a: &a " + std::string(1 << 16, 'x') + "\nb: [";  // ten thousand of them: 655 MB
  for (int i = 0; i < 10000; ++i) texts += "*a, ";
  expect_refused(texts + "1]\n", "more than a million values");
}

TEST_F(LensImport, KalibrsFilesAreRefusedByFieldAndValue) {
  const std::string one = kKalibr.substr(0, kKalibr.find("cam1:"));
  expect_refused(kKalibr, "cam0, cam1", ErrorKind::usage);
  expect_refused(kKalibr, "cam7", ErrorKind::usage, {{}, "cam7"});
  expect_refused(kYaml, "--camera", ErrorKind::usage, {{}, "cam0"});
  expect_refused(replaced(one, "0.0067]", "0.0067, 1]"), "distortion_coeffs has 5");
  expect_refused(replaced(one, "equidistant", "fisheye8"), "fisheye8");
  expect_refused(replaced(one, "pinhole", "thinlens"), "thinlens");
  expect_refused(replaced(one, "285.5, ", ""), "intrinsics has 3");
  expect_refused(replaced(one, "285.5", ".nan"), "intrinsics[0]");
  expect_refused(replaced(one, "  resolution: [848, 800]\n", ""), "resolution is missing");
  expect_refused(replaced(one, "848", "84800"), "84800");
  expect_refused("a: 1\n", "holds no camera", ErrorKind::bad_input, {LensFormat::kalibr, ""});
}

TEST_F(LensImport, OcamCalibsAndMrcalsFilesAreRefusedByFieldAndValue) {
  expect_refused(replaced(kOcam, "5 -4.7", "6 -4.7"), "line 3");
  expect_refused(replaced(kOcam, "-4.714441e+02", "4.714441e+02"), "line 3");
  expect_refused(replaced(kOcam, "794.308657", "nan"), "nan", ErrorKind::bad_input,
                 {LensFormat::ocamcalib, ""});
  expect_refused(replaced(kOcam, "1600 1500", ""), "image size");
  expect_refused(replaced(kOcam, "1600 1500", "1600 1500.5"), "whole");
  expect_refused(replaced(kOcam, "1.000305", "0"), "affine");
  const std::string mrcal =
      "# a comment\n{ 'lensmodel': 'LENSMODEL_STEREOGRAPHIC',\n 'intrinsics': [ 600, 601, 500, 400, ],\n"
      " 'extrinsics': (0, 0, 0), 'imagersize': [ 1000, 800,],\n 'optimization_inputs': b'ab'\n b'cd', }\n";
  const auto good = read(mrcal);
  ASSERT_TRUE(good.ok()) << good.error().message;
  EXPECT_EQ(good->model, "LENSMODEL_STEREOGRAPHIC");
  expect_refused(replaced(mrcal, "STEREOGRAPHIC", "CAHVORE_linearity=0.37"), "CAHVORE");
  expect_refused(replaced(mrcal, "400,", "400, 1,"), "intrinsics has 5");
  expect_refused(replaced(mrcal, "600", "nan"), "intrinsics[0]");
  expect_refused(replaced(mrcal, "'imagersize'", "'other'"), "imagersize is missing");
  expect_refused(replaced(mrcal, "LENSMODEL_STEREOGRAPHIC",
                          "LENSMODEL_SPLINED_STEREOGRAPHIC_order=4_Nx=6_Ny=5_fov_x_deg=170"),
                 "order=2 or 3");
  expect_refused(replaced(mrcal, "(0, 0, 0)", "(0, 0, 0"), "line 4");
  expect_refused(mrcal.substr(0, mrcal.size() - 4), "line");
  std::string deep = "{ 'lensmodel': ";
  for (int i = 0; i < 100000; ++i) deep += '[';
  expect_refused(deep, "too deep");
}

}  // namespace
}  // namespace lightwell::calibration
