// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <filesystem>

#include "tests/support/expect_pixels.h"
#include "tests/support/lens_files.h"

namespace lightwell::calibration {
namespace {

using test::expect_pixels;
using test::kKalibr;
using test::kOcam;
using test::kXml;
using test::kYaml;
using test::LensImport;

const std::filesystem::path kData = std::filesystem::path(LIGHTWELL_TEST_DATA) / "fisheye_cal";

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

}  // namespace
}  // namespace lightwell::calibration
