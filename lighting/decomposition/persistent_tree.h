// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "lighting/light_set.h"
#include "lighting/vector.h"

namespace lightwell {

// The hierarchy by which a reader folds lights into fewer, kept from frame to frame: a hierarchy made anew would group
// the same lights otherwise after the least change, and every prefix would flicker. A group costs what the error
// (error_kernel.h) grows by one light at its mean direction standing for all of its lights; groups are joined where
// that grows least. From then on only what must be is changed: a light that came to another place joins its new
// neighbour; a group is divided otherwise where that costs much less than before; the order of divisions changes where
// one has become much more urgent than the one before it. After build nothing is allocated.
class PersistentTree {
 public:
  explicit PersistentTree(int lights);

  // What the lights are now. powers: luminance, ≥ 0; kernel: error_kernel between them, rows of stride
  struct Lights {
    std::span<const Vec3d> directions;
    std::span<const double> powers;
    const double* kernel;
    int stride;
  };
  void build(const Lights& lights);
  // moved: lights that came to another place since the last call.
  void follow(const Lights& lights, std::span<const int> moved) noexcept;

  struct Entry {
    int light;
    std::int32_t parent;  // index of an earlier entry; −1: the first
  };
  // Progressive: from one light for all, one more for each division.
  [[nodiscard]] std::span<const Entry> order() const { return entries_; }
  // Growth of the error's quadratic form by every division that is left out: what the first n lights cost beyond all of
  // them is the sum from entry n on. [light count]; 0 for the first
  [[nodiscard]] std::span<const double> costs() const { return entry_costs_; }

 private:
  struct Node {
    int parent = -1;
    int child[2] = {-1, -1};
    int first = 0, last = 0;  // its lights in leaves_
    double power = 0;
    Vec3d moment = Vec3d::Zero();
    Vec3d direction = Vec3d::UnitY();
    double own = 0;      // wᵀ k w of its lights among themselves
    double cost = 0;     // of one light standing for all
    double urgency = 0;  // what dividing it saves, or one of its parts, whichever is more
  };
  // Of a group that is thought of: one light at the mean for all.
  struct Mean {
    double power;
    Vec3d moment, direction;
  };

  [[nodiscard]] bool is_light(int n) const { return n < count_; }
  [[nodiscard]] Node& node(int n) { return nodes_[static_cast<std::size_t>(n)]; }
  [[nodiscard]] const Node& node(int n) const { return nodes_[static_cast<std::size_t>(n)]; }
  [[nodiscard]] static Mean mean_of(const Node& a, const Node& b);
  [[nodiscard]] double between(const Node& a, const Node& b) const noexcept;
  [[nodiscard]] double seen_from(const Vec3d& place, const Node& group) const noexcept;
  [[nodiscard]] double cost_together(const Node& a, const Node& b, double between_them) const noexcept;
  void set_lights(const Lights& lights) noexcept;
  void sum(int n) noexcept;
  void gather_leaves() noexcept;
  void reattach(int light) noexcept;
  void replace_child(int parent, int old_child, int new_child) noexcept;
  [[nodiscard]] double rounding() const noexcept;
  void regroup() noexcept;
  void rank() noexcept;
  void put_parents_first() noexcept;
  void write_entries() noexcept;

  int count_;
  int root_ = 0;
  Lights lights_{};          // while a call lasts
  std::vector<int> leaves_;  // lights, those of a group side by side
  std::size_t next_regroup_ = 0;
  std::vector<Node> nodes_;  // lights, then divisions
  std::vector<int> order_;   // divisions, parents before their parts
  std::vector<int> scratch_, stack_;
  std::vector<char> placed_;
  std::vector<int> shown_by_;  // the light that stands for a node
  std::vector<int> slot_;      // of a light among the entries
  std::vector<Entry> entries_;
  std::vector<double> entry_costs_;
};

}  // namespace lightwell
