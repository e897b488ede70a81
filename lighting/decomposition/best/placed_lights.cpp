// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/decomposition/best/placed_lights.h"

namespace lightwell {

PlacedLights::PlacedLights(int count)
    : directions_(static_cast<std::size_t>(count), Vec3d::UnitY()),
      moments_(static_cast<std::size_t>(count), MomentVector::Zero()),
      ids_(static_cast<std::size_t>(count), 0),
      points_(count) {
  points_.count = count;
}

void PlacedLights::set(int i, const Vec3d& d) noexcept {
  const auto k = static_cast<std::size_t>(i);
  directions_[k] = d.cast<float>().cast<double>();  // what the float kernels see
  moments_[k] = lambertian_moments(directions_[k]);
  ids_[k] = next_id_++;
  points_.x[k] = static_cast<float>(d.x());
  points_.y[k] = static_cast<float>(d.y());
  points_.z[k] = static_cast<float>(d.z());
  points_.ground[k] = static_cast<float>(ground_share(d.y()));
}

placement_kernel::Points PlacedLights::points() const {
  auto points = points_.points();
  points.count = count();
  return points;
}

int PlacedLights::nearest_to(const Vec3d& d) const noexcept {
  int nearest = 0;
  for (int i = 1; i < count(); ++i)
    if ((direction(i) - d).squaredNorm() < (direction(nearest) - d).squaredNorm()) nearest = i;
  return nearest;
}

void PlacedLights::potentials(const Atoms& of, const MomentMatrix& of_moments, int first, int last,
                              ChannelRows& to) const noexcept {
  auto at = points_.points();
  at.x += first, at.y += first, at.z += first, at.s += first;
  at.count = last - first;
  const std::array<double*, 3> rows{to[0].data() + first, to[1].data() + first, to[2].data() + first};
  placement_kernel::kernels().potentials(of.points(), of.weights().data(), kernel_shares(), at, rows.data());
  for (int i = first; i < last; ++i) {
    const Eigen::RowVector3d smooth = moment_weight() * moments(i).transpose() * of_moments;
    for (std::size_t c = 0; c < 3; ++c)
      to[c][static_cast<std::size_t>(i)] += smooth[static_cast<Eigen::Index>(c)];
  }
}

}  // namespace lightwell
