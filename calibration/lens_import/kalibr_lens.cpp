// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <string>
#include <vector>

#include "calibration/lens_import/source_formats.h"

namespace lightwell::calibration {
namespace {

using nlohmann::json;

// The camera's key, of those that the file holds.
std::string chosen_camera(const json& root, const std::string& file, const std::string& camera) {
  std::vector<std::string> all;
  std::string list;
  for (const auto& [key, value] : root.items()) {
    if (!value.is_object() || !value.contains("camera_model")) continue;
    all.push_back(key);
    list += (list.empty() ? "" : ", ") + key;
  }
  if (all.empty())
    throw FieldFailure{
        {ErrorKind::bad_input, file + ": holds no camera: allowed cam0, cam1 .. with camera_model"}};
  if (camera.empty() && all.size() > 1)
    throw FieldFailure{{ErrorKind::usage, file + ": holds " + list + ": --camera says which"}};
  if (camera.empty()) return all[0];
  if (std::find(all.begin(), all.end(), camera) == all.end())
    throw FieldFailure{
        {ErrorKind::usage, "--camera is \"" + camera + "\", allowed " + list + ", the cameras of " + file}};
  return camera;
}

void require_count(const JsonFields& camera, const char* key, std::size_t count, std::size_t allowed,
                   const std::string& of) {
  if (count != allowed)
    camera.fail(key, "has " + std::to_string(count) + " numbers: allowed " + std::to_string(allowed) +
                         ", those of " + of);
}

void require_range(const JsonFields& camera, const std::string& key, double value, double from, double to) {
  if (!(value >= from && value <= to))
    camera.fail(key, "= " + json(value).dump() + ": allowed " + json(from).dump() + " to " + json(to).dump());
}

// What follows the projection onto the plane.
struct Distortion {
  std::string model;  // none, radtan, equidistant, fov
  std::vector<double> numbers;
};

Distortion distortion_of(const JsonFields& camera) {
  Distortion d;
  d.model = camera.has("distortion_model") ? camera.text("distortion_model") : "none";
  if (d.model == "equi") d.model = "equidistant";
  if (camera.has("distortion_coeffs")) d.numbers = camera.number_list("distortion_coeffs");
  const std::pair<const char*, std::size_t> known[] = {
      {"none", 0}, {"radtan", 4}, {"equidistant", 4}, {"fov", 1}};
  for (const auto& [model, count] : known)
    if (d.model == model) {
      require_count(camera, "distortion_coeffs", d.numbers.size(), count, d.model);
      return d;
    }
  camera.fail("distortion_model", "= \"" + d.model + "\": allowed none, radtan, equidistant, fov");
}

PlaneDistortion plane_distortion(const JsonFields& camera, const Distortion& d) {
  if (d.model == "none") return {};
  if (d.model != "radtan")
    camera.fail("distortion_model", "= \"" + d.model + "\": allowed none, radtan with this camera_model");
  return {d.numbers[0], d.numbers[1], d.numbers[2], d.numbers[3]};
}

}  // namespace

SourceLens kalibr_lens(const json& root, const std::string& file, const std::string& camera_name) {
  (void)JsonFields(root, file);  // an object
  const std::string key = chosen_camera(root, file, camera_name);
  const JsonFields camera(root.at(key), file, key);
  SourceLens out;
  out.format = LensFormat::kalibr;
  const std::string model = camera.text("camera_model");
  const Distortion d = distortion_of(camera);
  out.model = model + "-" + d.model;
  std::array<double, 2> size{};
  camera.numbers("resolution", size);
  out.image_size = {image_side(camera, "resolution[0]", size[0]),
                    image_side(camera, "resolution[1]", size[1])};
  const std::pair<const char*, std::size_t> own[] = {{"pinhole", 0}, {"omni", 1}, {"eucm", 2}, {"ds", 2}};
  const auto found =
      std::find_if(std::begin(own), std::end(own), [&](const auto& o) { return model == o.first; });
  if (found == std::end(own))
    camera.fail("camera_model", "= \"" + model + "\": allowed pinhole, omni, eucm, ds");
  const std::vector<double> v = camera.number_list("intrinsics");
  require_count(camera, "intrinsics", v.size(), 4 + found->second, model);
  const double* p = v.data() + found->second;
  const PinholePlane plane = pinhole_plane(camera, "intrinsics", p[0], p[1], p[2], p[3]);
  if (model == "pinhole") {
    if (d.model == "equidistant") {
      const std::array<double, 4> k = {d.numbers[0], d.numbers[1], d.numbers[2], d.numbers[3]};
      out.project = equidistant(plane, k);
      out.same = Lens{out.image_size, plane.focal, plane.center, k, kPi};
    } else if (d.model == "fov") {
      require_range(camera, "distortion_coeffs[0]", d.numbers[0], 1e-3, 3.1);
      out.project = field_of_view(plane, d.numbers[0]);
    } else {
      out.project = perspective(plane, plane_distortion(camera, d));
    }
    return out;
  }
  const PlaneDistortion plane_d = plane_distortion(camera, d);
  if (model == "omni") {
    require_range(camera, "intrinsics[0]", v[0], 0, 100);
    out.project = omnidirectional(plane, v[0], plane_d);
    return out;
  }
  if (d.model != "none") camera.fail("distortion_model", "= \"" + d.model + "\": allowed none with " + model);
  const bool eucm = model == "eucm";
  require_range(camera, "intrinsics[" + std::to_string(eucm ? 0 : 1) + "]", v[eucm ? 0 : 1], 0, 1);
  require_range(camera, "intrinsics[" + std::to_string(eucm ? 1 : 0) + "]", v[eucm ? 1 : 0], eucm ? 1e-6 : -1,
                eucm ? 100 : 1);
  out.project = eucm ? enhanced_unified(plane, v[0], v[1]) : double_sphere(plane, v[0], v[1]);
  return out;
}

}  // namespace lightwell::calibration
