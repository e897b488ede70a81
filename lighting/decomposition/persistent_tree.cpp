// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/decomposition/persistent_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lighting/decomposition/error_kernel.h"

namespace lightwell {
namespace {

constexpr double kRegroupBelow = 0.7;  // of the cost before
constexpr double kUrgent = 1.5;        // times what comes before it

constexpr std::size_t kRegroupedAFrame = 64;  // groups that are looked at

}  // namespace

PersistentTree::PersistentTree(int lights) : count_(lights) {
  const auto n = static_cast<std::size_t>(lights);
  nodes_.resize(2 * n - 1);
  leaves_.resize(n);
  order_.reserve(n);
  scratch_.reserve(n);
  stack_.reserve(3 * n);
  placed_.resize(2 * n - 1);
  shown_by_.resize(2 * n - 1);
  slot_.resize(n);
  entries_.reserve(n);
  entry_costs_.assign(n, 0);
}

PersistentTree::Mean PersistentTree::mean_of(const Node& a, const Node& b) {
  Mean mean{a.power + b.power, a.moment + b.moment, a.power >= b.power ? a.direction : b.direction};
  const double length = mean.moment.norm();
  // What has no mean direction keeps the stronger part's.
  if (length > 1e-6 * mean.power && mean.power > 0) mean.direction = mean.moment / length;
  return mean;
}

// wᵀ k w between the lights of two groups.
double PersistentTree::between(const Node& a, const Node& b) const noexcept {
  double total = 0;
  for (int p = a.first; p < a.last; ++p) {
    const int i = leaves_[static_cast<std::size_t>(p)];
    const double* row =
        lights_.kernel + static_cast<std::size_t>(i) * static_cast<std::size_t>(lights_.stride);
    double part = 0;
    for (int q = b.first; q < b.last; ++q) {
      const auto j = static_cast<std::size_t>(leaves_[static_cast<std::size_t>(q)]);
      part += row[j] * lights_.powers[j];
    }
    total += part * lights_.powers[static_cast<std::size_t>(i)];
  }
  return total;
}

double PersistentTree::seen_from(const Vec3d& place, const Node& group) const noexcept {
  double total = 0;
  for (int p = group.first; p < group.last; ++p) {
    const auto i = static_cast<std::size_t>(leaves_[static_cast<std::size_t>(p)]);
    if (lights_.powers[i] > 0) total += lights_.powers[i] * error_kernel(place, lights_.directions[i]);
  }
  return total;
}

// ½ δᵀ k δ of δ = (one light at the mean) − the lights of both.
double PersistentTree::cost_together(const Node& a, const Node& b, double between_them) const noexcept {
  const Mean mean = mean_of(a, b);
  if (!(mean.power > 0)) return 0;
  const double at_mean = mean.power * mean.power * error_kernel(mean.direction, mean.direction) / 2;
  const double seen = mean.power * (seen_from(mean.direction, a) + seen_from(mean.direction, b));
  return std::max(0.0, at_mean - seen + (a.own + b.own) / 2 + between_them);
}

void PersistentTree::set_lights(const Lights& lights) noexcept {
  lights_ = lights;
  for (int i = 0; i < count_; ++i) {
    const auto k = static_cast<std::size_t>(i);
    Node& light = nodes_[k];
    light.power = lights.powers[k];
    light.direction = lights.directions[k];
    light.moment = light.power * light.direction;
    light.own = light.power * light.power * lights.kernel[k * static_cast<std::size_t>(lights.stride) + k];
    light.cost = light.urgency = 0;
  }
}

// Parts first.
void PersistentTree::sum(int n) noexcept {
  Node& group = node(n);
  const Node& a = node(group.child[0]);
  const Node& b = node(group.child[1]);
  const Mean mean = mean_of(a, b);
  const double cross = between(a, b);
  group.power = mean.power;
  group.moment = mean.moment;
  group.direction = mean.direction;
  group.own = a.own + b.own + 2 * cross;
  group.cost = cost_together(a, b, cross);
  group.urgency = std::max({group.cost - a.cost - b.cost, a.urgency, b.urgency});
}

void PersistentTree::build(const Lights& lights) {
  for (Node& n : nodes_) n.parent = n.child[0] = n.child[1] = -1;
  set_lights(lights);
  // While groups are joined their lights do not stand side by side: what lies between two groups is kept in a table.
  const auto size = nodes_.size();
  std::vector<std::vector<int>> members(size);
  std::vector<double> table(size * size, 0);
  const auto cross = [&](int a, int b) -> double& {
    return table[static_cast<std::size_t>(a) * size + static_cast<std::size_t>(b)];
  };
  std::vector<int> alive;
  for (int i = 0; i < count_; ++i) {
    members[static_cast<std::size_t>(i)] = {i};
    alive.push_back(i);
    for (int j = 0; j < count_; ++j)
      cross(i, j) = lights.powers[static_cast<std::size_t>(i)] * lights.powers[static_cast<std::size_t>(j)] *
                    lights.kernel[static_cast<std::size_t>(i) * static_cast<std::size_t>(lights.stride) +
                                  static_cast<std::size_t>(j)];
  }
  const auto cost = [&](int a, int b) {
    const Mean mean = mean_of(node(a), node(b));
    if (!(mean.power > 0)) return 0.0;
    double seen = 0;
    for (const int group : {a, b})
      for (const int i : members[static_cast<std::size_t>(group)])
        seen += lights.powers[static_cast<std::size_t>(i)] *
                error_kernel(mean.direction, lights.directions[static_cast<std::size_t>(i)]);
    return mean.power * mean.power * error_kernel(mean.direction, mean.direction) / 2 - mean.power * seen +
           (node(a).own + node(b).own) / 2 + cross(a, b) - node(a).cost - node(b).cost;
  };
  std::vector<std::pair<double, int>> nearest(size);
  const auto find = [&](int a) {
    std::pair<double, int> best{std::numeric_limits<double>::infinity(), -1};
    for (const int b : alive)
      if (b != a) best = std::min(best, {cost(a, b), b});
    nearest[static_cast<std::size_t>(a)] = best;
  };
  for (const int a : alive) find(a);
  order_.clear();
  for (int made = count_; made < 2 * count_ - 1; ++made) {
    int a = alive.front();
    for (const int i : alive)
      if (nearest[static_cast<std::size_t>(i)].first < nearest[static_cast<std::size_t>(a)].first) a = i;
    const double grows = nearest[static_cast<std::size_t>(a)].first;
    int b = nearest[static_cast<std::size_t>(a)].second;
    if (node(b).power > node(a).power) std::swap(a, b);
    Node& group = node(made);
    group.child[0] = a;
    group.child[1] = b;
    node(a).parent = node(b).parent = made;
    const Mean mean = mean_of(node(a), node(b));
    group.power = mean.power;
    group.moment = mean.moment;
    group.direction = mean.direction;
    group.own = node(a).own + node(b).own + 2 * cross(a, b);
    group.cost = std::max(0.0, grows + node(a).cost + node(b).cost);
    auto& all = members[static_cast<std::size_t>(made)];
    all = members[static_cast<std::size_t>(a)];
    all.insert(all.end(), members[static_cast<std::size_t>(b)].begin(),
               members[static_cast<std::size_t>(b)].end());
    std::erase_if(alive, [&](int i) { return i == a || i == b; });
    for (const int i : alive) cross(i, made) = cross(made, i) = cross(a, i) + cross(b, i);
    order_.push_back(made);
    alive.push_back(made);
    find(made);
    for (const int i : alive) {
      auto& near = nearest[static_cast<std::size_t>(i)];
      if (i == made) continue;
      if (near.second == a || near.second == b)
        find(i);
      else
        near = std::min(near, {cost(i, made), made});
    }
  }
  root_ = 2 * count_ - 2;
  std::reverse(order_.begin(), order_.end());
  gather_leaves();
  for (std::size_t k = order_.size(); k-- > 0;) sum(order_[k]);
  // By urgency alone at first, with no regard to what was before.
  std::stable_sort(order_.begin(), order_.end(),
                   [&](int a, int b) { return node(a).urgency > node(b).urgency; });
  put_parents_first();
  write_entries();
}

void PersistentTree::gather_leaves() noexcept {
  stack_.clear();
  stack_.push_back(root_);
  int next = 0;
  while (!stack_.empty()) {
    const int n = stack_.back();
    stack_.pop_back();
    if (n < 0) {  // all of this group's lights have been gathered
      node(~n).last = next;
      continue;
    }
    Node& group = node(n);
    group.first = next;
    if (is_light(n)) {
      leaves_[static_cast<std::size_t>(next++)] = n;
      group.last = next;
      continue;
    }
    stack_.push_back(~n);
    stack_.push_back(group.child[1]);
    stack_.push_back(group.child[0]);
  }
}

void PersistentTree::replace_child(int parent, int old_child, int new_child) noexcept {
  Node& p = node(parent);
  p.child[p.child[0] == old_child ? 0 : 1] = new_child;
  node(new_child).parent = parent;
}

// A light leaves its group and makes one with its nearest neighbour.
void PersistentTree::reattach(int light) noexcept {
  const int group = node(light).parent;
  if (group < 0) return;
  Node& g = node(group);
  const int other = g.child[g.child[0] == light ? 1 : 0];
  if (group == root_) {
    if (is_light(other)) return;  // two lights in all
    root_ = other;
    node(other).parent = -1;
  } else {
    replace_child(g.parent, group, other);
  }
  int best = -1;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < count_; ++i) {
    const double distance = (node(light).direction - node(i).direction).squaredNorm();
    if (i == light || !(distance < least)) continue;
    least = distance;
    best = i;
  }
  const int above = node(best).parent;
  if (above >= 0) {
    replace_child(above, best, group);
  } else {
    root_ = group;
    g.parent = -1;
  }
  g.child[0] = best;
  g.child[1] = light;
  node(best).parent = node(light).parent = group;
}

// What cancels in costs, and says nothing.
double PersistentTree::rounding() const noexcept {
  const double all = node(root_).power;
  return 1e-12 * all * all;
}

// Of (a, (c, d)) the part (a, c) or (a, d) is made instead of (c, d) where it costs far less. Some groups a frame.
void PersistentTree::regroup() noexcept {
  for (std::size_t k = 0; k < std::min(kRegroupedAFrame, order_.size()); ++k) {
    const int n = order_[next_regroup_++ % order_.size()];
    for (int side = 0; side < 2; ++side) {
      const int a = node(n).child[side];
      const int b = node(n).child[1 - side];
      if (is_light(b)) continue;
      Node& inner = node(b);
      double least = kRegroupBelow * inner.cost - rounding();
      int stays = -1;
      for (int part = 0; part < 2; ++part) {  // inner.child[part] goes with a, the other stays outside
        const Node& goes = node(inner.child[part]);
        const double cost = cost_together(node(a), goes, between(node(a), goes));
        if (cost < least) {
          least = cost;
          stays = 1 - part;
        }
      }
      if (stays < 0) continue;
      const int out = inner.child[stays];
      node(n).child[side] = out;
      inner.child[stays] = a;
      node(out).parent = n;
      node(a).parent = b;
      gather_leaves();
      sum(b);
      sum(n);
      break;
    }
  }
}

// Divisions in the order they had, each behind the one it is part of.
void PersistentTree::put_parents_first() noexcept {
  scratch_.clear();
  std::fill(placed_.begin(), placed_.end(), char{0});
  std::fill(placed_.begin(), placed_.begin() + count_, char{1});
  enum : char { waiting = 0, done = 1, late = 2 };
  for (const int first : order_) {
    stack_.clear();
    stack_.push_back(first);
    while (!stack_.empty()) {
      const int n = stack_.back();
      stack_.pop_back();
      const Node& group = node(n);
      if (placed_[static_cast<std::size_t>(n)] == done) continue;
      if (group.parent >= 0 && placed_[static_cast<std::size_t>(group.parent)] != done) {
        placed_[static_cast<std::size_t>(n)] = late;
        continue;
      }
      placed_[static_cast<std::size_t>(n)] = done;
      scratch_.push_back(n);
      for (const int part : {group.child[1], group.child[0]})
        if (placed_[static_cast<std::size_t>(part)] == late) stack_.push_back(part);
    }
  }
  order_.swap(scratch_);
}

void PersistentTree::rank() noexcept {
  const auto urgency = [&](std::size_t k) { return nodes_[static_cast<std::size_t>(order_[k])].urgency; };
  for (std::size_t first = 1; first < order_.size(); ++first)
    for (std::size_t k = first; k > 0; --k) {
      if (nodes_[static_cast<std::size_t>(order_[k])].parent == order_[k - 1]) break;
      if (!(urgency(k) > kUrgent * urgency(k - 1) + rounding())) break;
      std::swap(order_[k], order_[k - 1]);
    }
}

void PersistentTree::write_entries() noexcept {
  for (int i = 0; i < count_; ++i) shown_by_[static_cast<std::size_t>(i)] = i;
  for (std::size_t k = order_.size(); k-- > 0;) {
    const int n = order_[k];
    shown_by_[static_cast<std::size_t>(n)] =
        shown_by_[static_cast<std::size_t>(nodes_[static_cast<std::size_t>(n)].child[0])];
  }
  entries_.clear();
  const int first = shown_by_[static_cast<std::size_t>(root_)];
  entries_.push_back({first, -1});
  slot_[static_cast<std::size_t>(first)] = 0;
  for (const int n : order_) {
    const Node& group = node(n);
    const int stands = shown_by_[static_cast<std::size_t>(group.child[0])];
    const int added = shown_by_[static_cast<std::size_t>(group.child[1])];
    slot_[static_cast<std::size_t>(added)] = static_cast<int>(entries_.size());
    entry_costs_[entries_.size()] = group.cost - nodes_[static_cast<std::size_t>(group.child[0])].cost -
                                    nodes_[static_cast<std::size_t>(group.child[1])].cost;
    entries_.push_back({added, slot_[static_cast<std::size_t>(stands)]});
  }
}

void PersistentTree::follow(const Lights& lights, std::span<const int> moved) noexcept {
  set_lights(lights);
  if (count_ > 1) {
    for (const int light : moved) reattach(light);
    if (!moved.empty()) put_parents_first();
    gather_leaves();
    for (std::size_t k = order_.size(); k-- > 0;) sum(order_[k]);
    regroup();
    put_parents_first();
    gather_leaves();
    for (std::size_t k = order_.size(); k-- > 0;) sum(order_[k]);
    rank();
  }
  write_entries();
}

}  // namespace lightwell
