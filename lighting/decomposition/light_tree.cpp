// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/decomposition/light_tree.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <queue>
#include <span>
#include <utility>

namespace lightwell {
namespace {

class LightTree {
 public:
  explicit LightTree(const std::vector<DirectionalLight>& lights) : lights_(lights), order_(lights.size()) {
    double total = 0;
    for (const DirectionalLight& light : lights) total += luminance(light.illuminance.cast<double>().eval());
    for (std::size_t i = 0; i < lights.size(); ++i) {
      order_[i] = static_cast<std::uint32_t>(i);
      direction_.push_back(lights[i].direction.cast<double>());
      weight_.push_back(total > 0 ? luminance(lights[i].illuminance.cast<double>().eval()) / total : 0);
    }
    projection_.resize(lights.size());
  }

  std::vector<DirectionalLight> ordered() {
    std::priority_queue<Group> groups;
    const auto show = [&](Group group, std::int32_t parent) {
      group.slot = result_.size();
      append(group.shown_by, parent);
      groups.push(group);
    };
    if (!lights_.empty()) show(measured(0, lights_.size()), -1);
    while (!groups.empty()) {
      const Group group = groups.top();
      groups.pop();
      if (!(group.spread > kNoSpread)) {
        append_rest(group);
        continue;
      }
      const std::size_t middle = divide(group);
      Group first = measured(group.begin, middle);
      Group second = measured(middle, group.end);
      // The half with the light that shows the group keeps its place.
      if (second.shown_by == group.shown_by) std::swap(first, second);
      first.slot = group.slot;
      groups.push(first);
      show(second, static_cast<std::int32_t>(group.slot));
    }
    return result_;
  }

 private:
  // Of directions' rounding, in shares of the total power.
  static constexpr double kNoSpread = 1e-13;

  struct Group {
    std::size_t begin = 0, end = 0;  // in order_
    std::size_t slot = 0;            // of the light that shows it
    std::uint32_t shown_by = 0;
    double spread = 0;  // Σ weight × squared distance from the mean
    Vec3d mean = Vec3d::Zero();
    bool operator<(const Group& other) const {  // the queue has the largest on top
      return spread != other.spread ? spread < other.spread : slot > other.slot;
    }
  };

  [[nodiscard]] std::span<std::uint32_t> members(const Group& g) {
    return std::span(order_).subspan(g.begin, g.end - g.begin);
  }

  [[nodiscard]] Group measured(std::size_t begin, std::size_t end) {
    Group g;
    g.begin = begin;
    g.end = end;
    g.shown_by = order_[begin];
    double weight = 0;
    for (const std::uint32_t i : members(g)) {
      weight += weight_[i];
      g.mean += weight_[i] * direction_[i];
      const double less = weight_[g.shown_by];
      if (weight_[i] > less || (weight_[i] == less && i < g.shown_by)) g.shown_by = i;
    }
    if (weight > 0) g.mean /= weight;
    for (const std::uint32_t i : members(g)) g.spread += weight_[i] * (direction_[i] - g.mean).squaredNorm();
    return g;
  }

  [[nodiscard]] Vec3d longest_axis(const Group& g) {
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    for (const std::uint32_t i : members(g)) {
      const Vec3d off = direction_[i] - g.mean;
      covariance += weight_[i] * off * off.transpose();
    }
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
    solver.computeDirect(covariance / g.spread);
    return solver.eigenvectors().col(2);
  }

  // Sorts the group along its longest axis; where to divide it: most weight × squared distance between the means.
  std::size_t divide(const Group& g) {
    const Vec3d axis = longest_axis(g);
    double weight = 0;
    for (const std::uint32_t i : members(g)) {
      projection_[i] = axis.dot(direction_[i] - g.mean);
      weight += weight_[i];
    }
    const auto sorted = members(g);
    std::sort(sorted.begin(), sorted.end(), [&](std::uint32_t a, std::uint32_t b) {
      return projection_[a] != projection_[b] ? projection_[a] < projection_[b] : a < b;
    });
    double before = 0;
    double moment = 0;  // Σ weight × projection; all of the group's is 0
    double most = -1;
    std::size_t best = 1;
    for (std::size_t k = 1; k < sorted.size(); ++k) {
      before += weight_[sorted[k - 1]];
      moment += weight_[sorted[k - 1]] * projection_[sorted[k - 1]];
      const double after = weight - before;
      const double between = before > 0 && after > 0 ? moment * moment * weight / (before * after) : 0;
      if (between > most) {
        most = between;
        best = k;
      }
    }
    return g.begin + best;
  }

  void append(std::uint32_t light, std::int32_t parent) {
    result_.push_back(lights_[light]);
    result_.back().parent = parent;
  }

  void append_rest(const Group& g) {
    for (const std::uint32_t i : members(g))
      if (i != g.shown_by) append(i, static_cast<std::int32_t>(g.slot));
  }

  const std::vector<DirectionalLight>& lights_;
  std::vector<std::uint32_t> order_;
  std::vector<Vec3d> direction_;
  std::vector<double> weight_;
  std::vector<double> projection_;
  std::vector<DirectionalLight> result_;
};

}  // namespace

std::vector<DirectionalLight> as_tree(const std::vector<DirectionalLight>& lights) {
  return LightTree(lights).ordered();
}

}  // namespace lightwell
