// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/decomposition/split_tree.h"

#include <cmath>
#include <cstddef>
#include <limits>

namespace lightwell {
namespace {

// A light or a merge of two nodes.
struct Node {
  Vec3d moment;  // Σ luminance · direction
  Vec3d direction;
  double weight;      // luminance
  std::size_t first;  // children, the stronger first; of a light: itself
  std::size_t second;
};

class SplitTree {
 public:
  explicit SplitTree(const std::vector<DirectionalLight>& lights) : lights_(lights) {
    double total = 0;
    for (const auto& light : lights) total += static_cast<double>(luminance(light.illuminance));
    for (std::size_t i = 0; i < lights.size(); ++i) {
      const Vec3d direction = lights[i].direction.cast<double>();
      const double weight = total > 0 ? static_cast<double>(luminance(lights[i].illuminance)) / total : 0;
      nodes_.push_back({weight * direction, direction, weight, i, i});
      alive_.push_back(i);
    }
    nearest_.assign(2 * lights.size(), {});
    for (const std::size_t i : alive_) find_nearest(i);
    while (alive_.size() > 1) merge_cheapest();
  }

  [[nodiscard]] std::vector<DirectionalLight> order() const {
    std::vector<DirectionalLight> ordered;
    if (nodes_.empty()) return ordered;
    // slot[node]: place in the order of the light that stands for the node
    std::vector<std::size_t> slot(nodes_.size(), 0);
    const std::size_t leaves = lights_.size();
    const auto append = [&](std::size_t node, std::int32_t parent) {
      std::size_t leaf = node;
      while (leaf >= leaves) leaf = nodes_[leaf].first;
      slot[node] = ordered.size();
      ordered.push_back(lights_[leaf]);
      ordered.back().parent = parent;
    };
    append(nodes_.size() - 1, -1);
    for (std::size_t node = nodes_.size(); node-- > leaves;) {
      slot[nodes_[node].first] = slot[node];
      append(nodes_[node].second, static_cast<std::int32_t>(slot[node]));
    }
    return ordered;
  }

 private:
  struct Nearest {
    std::size_t node = 0;
    double cost = std::numeric_limits<double>::infinity();
  };

  [[nodiscard]] double cost(std::size_t a, std::size_t b) const {
    return nodes_[a].weight * nodes_[b].weight * (nodes_[a].direction - nodes_[b].direction).norm();
  }

  void find_nearest(std::size_t i) {
    Nearest best;
    for (const std::size_t j : alive_)
      if (j != i && cost(i, j) < best.cost) best = {j, cost(i, j)};
    nearest_[i] = best;
  }

  void merge_cheapest() {
    std::size_t a = alive_.front();
    for (const std::size_t i : alive_)
      if (nearest_[i].cost < nearest_[a].cost) a = i;
    std::size_t b = nearest_[a].node;
    if (nodes_[b].weight > nodes_[a].weight || (nodes_[b].weight == nodes_[a].weight && b < a))
      std::swap(a, b);
    Node node{nodes_[a].moment + nodes_[b].moment, nodes_[a].direction, nodes_[a].weight + nodes_[b].weight,
              a, b};
    const double length = node.moment.norm();
    if (length > 1e-6 * node.weight) node.direction = node.moment / length;
    const std::size_t merged = nodes_.size();
    nodes_.push_back(node);
    std::erase_if(alive_, [&](std::size_t i) { return i == a || i == b; });
    alive_.push_back(merged);
    find_nearest(merged);
    for (const std::size_t i : alive_) {
      if (i == merged) continue;
      if (nearest_[i].node == a || nearest_[i].node == b) {
        find_nearest(i);
      } else if (cost(i, merged) < nearest_[i].cost) {
        nearest_[i] = {merged, cost(i, merged)};
      }
    }
  }

  const std::vector<DirectionalLight>& lights_;
  std::vector<Node> nodes_;
  std::vector<std::size_t> alive_;
  std::vector<Nearest> nearest_;
};

}  // namespace

std::vector<DirectionalLight> progressive_order(const std::vector<DirectionalLight>& lights) {
  return SplitTree(lights).order();
}

}  // namespace lightwell
