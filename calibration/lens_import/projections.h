// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <vector>

#include "lighting/lens.h"

// Lens models of other programs, as their own documents give them. A direction is in the camera frame (x right, y down,
// z along the axis), of any length; a pixel has its centre at whole numbers. Nothing where the model has no pixel.
namespace lightwell::calibration {

using Projection = std::function<std::optional<Vec2d>(const Vec3d& direction)>;

// u = f m + c
struct PinholePlane {
  Vec2d focal = {1, 1};
  Vec2d center = {0, 0};
};

// Distortion of the plane's normalised coordinates by k1 k2 p1 p2 k3 k4 k5 k6 s1 s2 s3 s4, zeros where absent.
// OpenCV, "Camera Calibration and 3D Reconstruction".
using PlaneDistortion = std::array<double, 12>;
Vec2d distorted(const PlaneDistortion& k, const Vec2d& m);

Projection perspective(const PinholePlane& plane, const PlaneDistortion& k);
// x / z is bent to atan(2 r tan(w / 2)) / w. Devernay and Faugeras 2001; Kalibr's "fov".
Projection field_of_view(const PinholePlane& plane, double w);
// Kannala–Brandt with four coefficients: cv::fisheye, Kalibr's "equidistant".
Projection equidistant(const PinholePlane& plane, const std::array<double, 4>& k);
// 2 tan(θ / 2); mrcal's LENSMODEL_STEREOGRAPHIC
Projection stereographic(const PinholePlane& plane);
// Onto a unit sphere, then from a point xi before its centre. Mei and Rives 2007; Kalibr's "omni", cv::omnidir.
Projection omnidirectional(const PinholePlane& plane, double xi, const PlaneDistortion& k);
// Khomutenko, Garcia and Martinet 2016; Kalibr's "eucm".
Projection enhanced_unified(const PinholePlane& plane, double alpha, double beta);
// Usenko, Demmel and Cremers 2018; Kalibr's "ds".
Projection double_sphere(const PinholePlane& plane, double xi, double alpha);
// Yakimovsky and Cunningham 1978, Gennery 2001; mrcal's parameters: the optical axis by alpha, beta, then r0 r1 r2.
Projection cahvor(const PinholePlane& plane, const std::array<double, 5>& p);

// A stereographic projection moved by a surface: B-splines over a grid of control points, evenly spaced in
// u = 2 tan(θ / 2). mrcal, "Splined stereographic lens model".
struct SplinedStereographic {
  PinholePlane plane;
  int order = 3;  // 2 or 3
  int nx = 0, ny = 0;
  double fov_x_deg = 0;
  std::vector<double> control;  // [ny][nx][2]
};
Projection splined_stereographic(SplinedStereographic model);

// θ of a point rho pixels from the centre is atan2(rho, -polynomial(rho)); the plane is sheared by [c d; e 1].
// Scaramuzza, Martinelli and Siegwart 2006, with OCamCalib's axes: first the row, then the column.
struct OcamModel {
  std::vector<double> polynomial;  // [0] below 0: the direct one, which was calibrated
  Vec2d center_row_column = {0, 0};
  double c = 1, d = 0, e = 0;
  double largest_rho = 0;  // pixels
};
Projection ocam(OcamModel model);

}  // namespace lightwell::calibration
