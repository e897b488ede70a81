// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/lens_files.h"

namespace lightwell::calibration {
namespace {

using test::kKalibr;
using test::kOcam;
using test::kXml;
using test::kYaml;
using test::LensImport;
using test::replaced;
using testing::HasSubstr;

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
