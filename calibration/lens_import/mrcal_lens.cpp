// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "calibration/lens_import/source_formats.h"

namespace lightwell::calibration {
namespace {

// Numbers of the plane come first in every model: fx, fy, cx, cy.
struct Intrinsics {
  PinholePlane plane;
  std::vector<double> more;
};

Intrinsics intrinsics_of(const JsonFields& root, std::size_t more, const std::string& model) {
  const std::vector<double> v = root.number_list("intrinsics");
  if (v.size() != 4 + more)
    root.fail("intrinsics", "has " + std::to_string(v.size()) + " numbers: allowed " +
                                std::to_string(4 + more) + ", those of " + model);
  return {pinhole_plane(root, "intrinsics", v[0], v[1], v[2], v[3]), {v.begin() + 4, v.end()}};
}

// LENSMODEL_OPENCV4, 5, 8, 12: as many coefficients.
std::optional<std::size_t> opencv_coefficients(const std::string& model) {
  for (const std::size_t n : {4u, 5u, 8u, 12u})
    if (model == "LENSMODEL_OPENCV" + std::to_string(n)) return n;
  return {};
}

Projection splined(const JsonFields& root, const std::string& model) {
  SplinedStereographic s;
  int end = 0;
  const int read =
      std::sscanf(model.c_str(), "LENSMODEL_SPLINED_STEREOGRAPHIC_order=%d_Nx=%d_Ny=%d_fov_x_deg=%lf%n",
                  &s.order, &s.nx, &s.ny, &s.fov_x_deg, &end);
  constexpr int kMost = 1000;
  if (read != 4 || static_cast<std::size_t>(end) != model.size() || (s.order != 2 && s.order != 3) ||
      s.nx < 2 + s.order || s.ny < 2 + s.order || s.nx > kMost || s.ny > kMost ||
      !(s.fov_x_deg > 0 && s.fov_x_deg < 360))
    root.fail("lensmodel",
              "= \"" + model +
                  "\": allowed order=2 or 3, Nx and Ny from 2 + order to 1000, fov_x_deg above 0, below 360");
  const auto count = 2 * static_cast<std::size_t>(s.nx) * static_cast<std::size_t>(s.ny);
  Intrinsics in = intrinsics_of(root, count, model);
  s.plane = in.plane;
  s.control = std::move(in.more);
  return splined_stereographic(std::move(s));
}

Projection projection_of(const JsonFields& root, const std::string& model) {
  if (const auto n = opencv_coefficients(model)) {
    const Intrinsics in = intrinsics_of(root, *n, model);
    PlaneDistortion k{};
    std::copy(in.more.begin(), in.more.end(), k.begin());
    return perspective(in.plane, k);
  }
  if (model == "LENSMODEL_PINHOLE") return perspective(intrinsics_of(root, 0, model).plane, {});
  if (model == "LENSMODEL_STEREOGRAPHIC") return stereographic(intrinsics_of(root, 0, model).plane);
  if (model == "LENSMODEL_CAHVOR") {
    const Intrinsics in = intrinsics_of(root, 5, model);
    return cahvor(in.plane, {in.more[0], in.more[1], in.more[2], in.more[3], in.more[4]});
  }
  if (model.rfind("LENSMODEL_SPLINED_STEREOGRAPHIC", 0) == 0) return splined(root, model);
  root.fail("lensmodel",
            "= \"" + model.substr(0, 60) +
                "\": allowed LENSMODEL_ PINHOLE, STEREOGRAPHIC, OPENCV4, OPENCV5, OPENCV8, OPENCV12, "
                "CAHVOR, SPLINED_STEREOGRAPHIC");
}

}  // namespace

SourceLens mrcal_lens(const JsonFields& root) {
  SourceLens out;
  out.format = LensFormat::mrcal;
  out.model = root.text("lensmodel");
  std::array<double, 2> size{};
  root.numbers("imagersize", size);
  out.image_size = {image_side(root, "imagersize[0]", size[0]), image_side(root, "imagersize[1]", size[1])};
  out.project = projection_of(root, out.model);
  if (root.has("valid_intrinsics_region") && root.holds_lists("valid_intrinsics_region"))
    for (const std::vector<double>& corner : root.lists("valid_intrinsics_region")) {
      if (corner.size() != 2) root.fail("valid_intrinsics_region", "has a corner that is not [u, v]");
      out.valid_region.emplace_back(corner[0], corner[1]);
    }
  return out;
}

}  // namespace lightwell::calibration
