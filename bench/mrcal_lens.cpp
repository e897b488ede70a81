// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <dlfcn.h>
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>

extern "C" {  // its headers are for C
#include <mrcal/mrcal.h>
}

#include "bench/lens_peers.h"

namespace lightwell::bench {
namespace {

// Loaded when it is asked for: a peer must not become a library that every command loads.
struct Mrcal {
  decltype(&mrcal_lensmodel_from_name) lensmodel_from_name = nullptr;
  decltype(&mrcal_lensmodel_num_params) lensmodel_num_params = nullptr;
  decltype(&mrcal_optimize) optimize = nullptr;
  decltype(&mrcal_project) project = nullptr;
  bool loaded = false;

  static const Mrcal& get() {
    static const Mrcal library;
    return library;
  }

 private:
  Mrcal() {
    void* library = dlopen("libmrcal.so.2", RTLD_NOW);  // the ABI of the header that this is compiled with
    if (library == nullptr) return;
    const auto find = [library](auto& function, const char* name) {
      function = reinterpret_cast<std::decay_t<decltype(function)>>(dlsym(library, name));
      return function != nullptr;
    };
    loaded = find(lensmodel_from_name, "mrcal_lensmodel_from_name") &&
             find(lensmodel_num_params, "mrcal_lensmodel_num_params") && find(optimize, "mrcal_optimize") &&
             find(project, "mrcal_project");
  }
};

// The grid that the targets' points lie on: point (column, row) at pitch · (column, row).
struct Grid {
  double pitch_mm = 0;
  int columns = 0, rows = 0;
};

Grid grid_of(const calibration::TargetViews& views) {
  Grid grid;
  double largest_x = 0, largest_y = 0;
  for (const auto& view : views.views)
    for (const auto& p : view.points) {
      largest_x = std::max(largest_x, p.target_mm.x());
      largest_y = std::max(largest_y, p.target_mm.y());
      if (p.target_mm.x() > 0 && (grid.pitch_mm == 0 || p.target_mm.x() < grid.pitch_mm))
        grid.pitch_mm = p.target_mm.x();
    }
  grid.columns = static_cast<int>(std::lround(largest_x / grid.pitch_mm)) + 1;
  grid.rows = static_cast<int>(std::lround(largest_y / grid.pitch_mm)) + 1;
  return grid;
}

mrcal_point3_t point(const Vec3d& v) {
  mrcal_point3_t out;
  out.x = v.x(), out.y = v.y(), out.z = v.z();
  return out;
}
Vec3d vector(const mrcal_point3_t& p) {
  return {p.x, p.y, p.z};
}

// mrcal tells of each outlier on stderr.
class QuietErrors {
 public:
  QuietErrors() : kept_(dup(STDERR_FILENO)) {
    std::fflush(stderr);
    const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
    if (nowhere >= 0) {
      dup2(nowhere, STDERR_FILENO);
      close(nowhere);
    }
  }
  ~QuietErrors() {
    std::fflush(stderr);
    if (kept_ < 0) return;
    dup2(kept_, STDERR_FILENO);
    close(kept_);
  }
  QuietErrors(const QuietErrors&) = delete;
  QuietErrors& operator=(const QuietErrors&) = delete;

 private:
  int kept_;
};

// Every corner of every view's grid: pixel and weight, negative where the view does not show it.
std::vector<mrcal_point3_t> observations(const calibration::TargetViews& views, const Grid& grid) {
  const auto a_view = static_cast<std::size_t>(grid.columns * grid.rows);
  std::vector<mrcal_point3_t> out(a_view * views.views.size(), point({0, 0, -1}));
  for (std::size_t v = 0; v < views.views.size(); ++v)
    for (const auto& p : views.views[v].points) {
      const auto column = std::lround(p.target_mm.x() / grid.pitch_mm);
      const auto row = std::lround(p.target_mm.y() / grid.pitch_mm);
      out[a_view * v + static_cast<std::size_t>(row * grid.columns + column)] =
          point({p.pixel.x(), p.pixel.y(), 1});
    }
  return out;
}

}  // namespace

SolvedLens solve_mrcal(const calibration::TargetViews& views, const MrcalStart& start,
                       const std::string& model, bool bend_board) {
  SolvedLens out;
  const Mrcal& mrcal = Mrcal::get();
  if (!mrcal.loaded) {
    out.refused = "libmrcal.so.2 is not installed";
    return out;
  }
  mrcal_lensmodel_t lens_model;
  if (!mrcal.lensmodel_from_name(&lens_model, model.c_str())) {
    out.refused = "unknown model " + model;
    return out;
  }
  const bool splined = lens_model.type == MRCAL_LENSMODEL_SPLINED_STEREOGRAPHIC;
  const auto parameters = static_cast<std::size_t>(mrcal.lensmodel_num_params(&lens_model));
  const auto intrinsics = std::make_shared<std::vector<double>>(parameters, 0.0);
  const std::array<double, 4> core = {start.lens.focal.x(), start.lens.focal.y(), start.lens.center.x(),
                                      start.lens.center.y()};
  std::copy(core.begin(), core.end(), intrinsics->begin());

  const Grid grid = grid_of(views);
  std::vector<mrcal_point3_t> pool = observations(views, grid);
  std::vector<mrcal_pose_t> frames;
  std::vector<mrcal_observation_board_t> boards;
  for (const calibration::TargetPose& pose : start.poses) {
    boards.push_back({{0, -1}, static_cast<int>(frames.size())});
    frames.push_back({point(pose.rotation), point(pose.translation_mm)});
  }
  mrcal_problem_selections_t solve{};
  solve.do_optimize_intrinsics_core =
      !splined;  // a spline's core only duplicates what its control points say
  solve.do_optimize_intrinsics_distortions = true;
  solve.do_optimize_frames = true;
  solve.do_optimize_calobject_warp = bend_board;
  solve.do_apply_regularization = true;
  solve.do_apply_outlier_rejection = true;
  const mrcal_problem_constants_t constants{};
  mrcal_calobject_warp_t warp{};
  const QuietErrors quiet;
  const mrcal_stats_t stats =
      mrcal.optimize(nullptr, 0, nullptr, 0, intrinsics->data(), nullptr, frames.data(), nullptr, &warp, 1, 0,
                     static_cast<int>(frames.size()), 0, 0, boards.data(), nullptr,
                     static_cast<int>(boards.size()), 0, pool.data(), &lens_model, views.image_size.data(),
                     solve, &constants, grid.pitch_mm, grid.columns, grid.rows, false, false);
  if (!(stats.rms_reproj_error__pixels >= 0)) {
    out.refused = "mrcal_optimize failed";
    return out;
  }
  // Its board bends by x2 (1 − x²) + y2 (1 − y²), x and y from −1 to 1 over the board.
  out.place = [warp, grid](const Vec3d& nominal) {
    const double x = 2 * nominal.x() / (grid.pitch_mm * (grid.columns - 1)) - 1;
    const double y = 2 * nominal.y() / (grid.pitch_mm * (grid.rows - 1)) - 1;
    return Vec3d(nominal.x(), nominal.y(), nominal.z() + warp.x2 * (1 - x * x) + warp.y2 * (1 - y * y));
  };
  for (const mrcal_pose_t& frame : frames) out.poses.push_back({vector(frame.r), vector(frame.t)});
  out.project = [intrinsics, lens_model](const Vec3d& direction) {
    const mrcal_point3_t p = point(direction);
    mrcal_point2_t q;
    Mrcal::get().project(&q, nullptr, nullptr, &p, 1, &lens_model, intrinsics->data());
    return Vec2d(q.x, q.y);
  };
  return out;
}

}  // namespace lightwell::bench
