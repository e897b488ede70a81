// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "calibration/lens_import/source_formats.h"

namespace lightwell::calibration {
namespace {

// The first of the names that the file has; the first of all where it has none, for the message.
std::string present(const JsonFields& fields, const std::vector<const char*>& names) {
  for (const char* name : names)
    if (fields.has(name)) return name;
  return names[0];
}

// Numbers of a matrix: {rows, cols, data}, a list, or a list of rows.
std::vector<double> matrix_numbers(const JsonFields& fields, const std::string& key) {
  if (!fields.has(key)) fields.fail(key, "is missing");
  if (fields.is_object(key)) return fields.object(key).number_list("data");
  if (!fields.holds_lists(key)) return fields.number_list(key);
  std::vector<double> out;
  for (const auto& row : fields.lists(key)) out.insert(out.end(), row.begin(), row.end());
  return out;
}

PinholePlane camera_matrix(const JsonFields& fields) {
  const std::string key = present(fields, {"camera_matrix", "K", "cameraMatrix", "Camera_Matrix",
                                           "CameraMatrix", "intrinsic_matrix", "mtx"});
  const std::vector<double> m = matrix_numbers(fields, key);
  if (m.size() != 9)
    fields.fail(key, "has " + std::to_string(m.size()) + " numbers: allowed 9, of a 3x3 matrix");
  if (m[1] != 0)
    fields.fail(key, "[0][1] = " + std::to_string(m[1]) + ": allowed 0, this lens model has no skew");
  constexpr std::pair<std::size_t, double> kFixed[] = {{3, 0}, {6, 0}, {7, 0}, {8, 1}};
  for (const auto& [i, value] : kFixed)
    if (m[i] != value)
      fields.fail(key, "[" + std::to_string(i / 3) + "][" + std::to_string(i % 3) +
                           "] = " + std::to_string(m[i]) + ": allowed " +
                           std::to_string(static_cast<int>(value)) + " in a camera matrix");
  return pinhole_plane(fields, key, m[0], m[4], m[2], m[5]);
}

std::vector<double> coefficients(const JsonFields& fields, const std::string& of_model) {
  const std::string key =
      present(fields, {"distortion_coefficients", "D", "distCoeffs", "Distortion_Coefficients", "dist_coeffs",
                       "distortion_coeffs", "DistCoeffs", "dist"});
  std::vector<double> d = matrix_numbers(fields, key);
  if (d.size() != 4)
    fields.fail(key, "has " + std::to_string(d.size()) + " numbers: allowed 4, those of " + of_model +
                         (d.size() > 4 ? "; more are a perspective lens's" : ""));
  return d;
}

std::array<int, 2> image_size(const JsonFields& fields) {
  for (const char* key : {"image_size", "imageSize", "img_size", "DIM", "dim", "resolution", "size"}) {
    if (!fields.has(key)) continue;
    const std::vector<double> size = matrix_numbers(fields, key);
    if (size.size() != 2)
      fields.fail(key, "has " + std::to_string(size.size()) + " numbers: allowed 2, [w, h]");
    return {image_side(fields, std::string(key) + "[0]", size[0]),
            image_side(fields, std::string(key) + "[1]", size[1])};
  }
  const auto side = [&](const std::vector<const char*>& names) {
    const std::string key = present(fields, names);
    return image_side(fields, key, fields.number(key));
  };
  return {side({"image_width", "image_Width", "imageWidth", "width"}),
          side({"image_height", "image_Height", "imageHeight", "height"})};
}

constexpr std::string_view kFisheye = "fisheye", kOmnidir = "omnidir";

std::string lower_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

// The model under a name that a program gives it; empty where it is none of ours.
std::string_view model_called(std::string_view name) {
  if (name == kOmnidir) return kOmnidir;
  for (const std::string_view own : {"equidistant", "fisheye", "kannala_brandt", "kannala-brandt",
                                     "kannalabrandt", "kb4", "opencv_fisheye"})
    if (name == own) return kFisheye;
  return "";
}

// The model that the file says it is of: by a name, by OpenCV's flag, by the xi that only cv::omnidir has; empty where
// nothing does, for coefficients of a perspective lens look the same. What contradicts itself or names another model is
// refused.
std::string_view stated_model(const JsonFields& fields) {
  std::string_view stated = fields.has("xi") ? kOmnidir : "";
  const auto state = [&](const char* key, std::string_view model, const std::string& value) {
    if (stated == kOmnidir && model == kFisheye && fields.has("xi"))
      fields.fail(key, value + ": allowed omnidir, as the file has xi");
    if (!stated.empty() && stated != model)
      fields.fail(key, value + ": contradicts the " + std::string(stated));
    stated = model;
  };
  for (const char* key : {"distortion_model", "model", "projection_model", "model_type", "camera_model"}) {
    if (!fields.has(key)) continue;
    const std::string name = lower_case(fields.text(key)), value = "= \"" + name.substr(0, 60) + "\"";
    if (std::string_view(key) == "camera_model" && name == "pinhole")
      continue;  // says nothing of coefficients
    const std::string_view model = model_called(name);
    if (model.empty()) fields.fail(key, value + ": allowed equidistant, fisheye, kannala_brandt, omnidir");
    state(key, model, value);
  }
  for (const char* key : {"fisheye_model", "fisheye"}) {
    if (!fields.is_number(key)) continue;
    if (fields.number(key) != 1)
      fields.fail(key, "= " + nlohmann::json(fields.number(key)).dump() +
                           ": allowed 1: the coefficients are those of a perspective lens");
    state(key, kFisheye, "= 1");
  }
  return stated;
}

// The widest circle that the model shows around its axis, in radians if the lens is a fisheye: to the image's farthest
// corner.
double farthest_corner(const PinholePlane& plane, const std::array<int, 2>& size) {
  const Vec2d low = (plane.center + Vec2d(0.5, 0.5)).cwiseQuotient(plane.focal);
  const Vec2d high = (Vec2d(size[0] - 0.5, size[1] - 0.5) - plane.center).cwiseQuotient(plane.focal);
  return low.cwiseAbs().cwiseMax(high.cwiseAbs()).norm();
}

// Four coefficients that nobody named are k1 … k4 of a fisheye, or k1, k2, p1, p2 of a perspective lens: the numbers do
// not tell, the image does. A perspective lens that reached two focal lengths from its axis would show 127 degrees,
// which none does that such coefficients are fitted to; a fisheye reaches that far at 115 degrees off axis.
void require_fisheye(const JsonFields& fields, const PinholePlane& plane, const std::array<int, 2>& size) {
  constexpr double kNoPerspectiveLens = 2;
  const double corner = farthest_corner(plane, size);
  if (corner >= kNoPerspectiveLens) return;
  char text[300];
  std::snprintf(
      text, sizeof text,
      ": names no lens model, and its image reaches %.2f focal lengths from the axis: allowed without a name "
      "from %g on, nearer a perspective lens looks the same; --model fisheye states it",
      corner, kNoPerspectiveLens);
  throw FieldFailure{{ErrorKind::usage, fields.file() + text}};
}

void require_no_skew(const JsonFields& fields) {
  for (const char* key : {"alpha", "skew"})
    if (fields.has(key) && fields.number(key) != 0)
      fields.fail(key,
                  "= " + std::to_string(fields.number(key)) + ": allowed 0, this lens model has no skew");
}

}  // namespace

SourceLens opencv_lens(const JsonFields& root, const std::string& model) {
  const std::string_view stated = stated_model(root);
  require_no_skew(root);
  if (!model.empty() && !stated.empty() && model != stated)
    throw FieldFailure{{ErrorKind::usage, "--model is \"" + model + "\", allowed " + std::string(stated) +
                                              ", which " + root.file() + " says"}};
  SourceLens out;
  out.format = LensFormat::opencv;
  out.assumed = stated.empty() && model.empty();
  const PinholePlane plane = camera_matrix(root);
  const bool omnidir = stated == kOmnidir || model == kOmnidir;
  const std::vector<double> d = coefficients(root, omnidir ? "cv::omnidir" : "cv::fisheye");
  out.image_size = image_size(root);
  if (out.assumed) require_fisheye(root, plane, out.image_size);
  if (omnidir) {
    if (!root.has("xi")) root.fail("xi", "is missing, which cv::omnidir has");
    const std::vector<double> xi =
        root.is_number("xi") ? std::vector<double>{root.number("xi")} : matrix_numbers(root, "xi");
    if (xi.size() != 1 || !(xi[0] >= 0 && xi[0] <= 100)) root.fail("xi", "is not one number from 0 to 100");
    out.model = "cv::omnidir";
    out.project = omnidirectional(plane, xi[0], {d[0], d[1], d[2], d[3]});
    return out;
  }
  out.model = "cv::fisheye";
  const std::array<double, 4> k = {d[0], d[1], d[2], d[3]};
  out.project = equidistant(plane, k);
  out.same = Lens{out.image_size, plane.focal, plane.center, k, kPi};
  return out;
}

}  // namespace lightwell::calibration
