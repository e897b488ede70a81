// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "calibration/lens_import/convert_lens.h"
#include "calibration/lens_import/source_lens.h"
#include "interface/atomic_file.h"
#include "tests/support/temporary_folder.h"

namespace lightwell::test {

using calibration::LensConversion;
using calibration::SourceLens;
using calibration::SourceLensOptions;

// Files of other programs that describe a lens, and what becomes of them.
class LensImport : public testing::Test {
 protected:
  std::string file(const std::string& text, const std::string& name = "source") const {
    const auto path = folder_.path() / name;
    EXPECT_TRUE(write_file_atomically(path, text));
    return path.string();
  }
  Result<SourceLens> read(const std::string& text, const SourceLensOptions& options = {}) const {
    return calibration::read_source_lens(file(text), options);
  }
  LensConversion converted(const std::string& text, std::optional<double> max_theta = {}) const {
    const auto source = read(text);
    if (!source) {
      ADD_FAILURE() << source.error().message;
      return {};
    }
    const auto out = calibration::convert_lens(*source, max_theta);
    EXPECT_TRUE(out.ok()) << (out.ok() ? "" : out.error().message);
    return out.ok() ? *out : LensConversion{};
  }
  void expect_refused(const std::string& text, const std::string& names,
                      ErrorKind kind = ErrorKind::bad_input, const SourceLensOptions& options = {}) const {
    const auto source = read(text, options);
    ASSERT_FALSE(source.ok()) << text;
    EXPECT_EQ(source.error().kind, kind);
    EXPECT_THAT(source.error().message, testing::HasSubstr(names));
    EXPECT_THAT(source.error().message, testing::HasSubstr("source"));  // the file
    EXPECT_EQ(source.error().message.find('\n'), std::string::npos) << source.error().message;
  }

 private:
  TemporaryFolder folder_;
};

inline const std::string kYaml = R"(%YAML:1.0
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
inline const std::string kXml = R"(<?xml version="1.0"?>
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
inline const std::string kKalibr = R"(cam0:
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
inline const std::string kOcam =
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

inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

}  // namespace lightwell::test
