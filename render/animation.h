// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace lightwell::render {

enum class Interpolation { step, linear, cubic_spline };

// Keys of one property of one node over time.
struct Track {
  enum class Property { translation, rotation, scale, weights };
  std::size_t node = 0;  // index into Rig::nodes
  Property property = Property::translation;
  Interpolation interpolation = Interpolation::linear;
  std::vector<float> times_s;  // rising
  std::size_t width = 3;       // numbers a value: 3; 4, a quaternion x y z w; or as many as there are weights
  std::vector<float> values;   // a value a key; cubic spline: in-tangent, value, out-tangent
};

// The property at a time. Before the first key and after the last it is theirs; a rotation is a unit quaternion.
// value: track.width numbers    source: glTF 2.0, appendix C (linear rotations: the shorter great arc)
void sample(const Track& track, double time_s, std::span<float> value);

// Where a time stands in an animation that begins again at its end; 0 where it has no length.
double looped(double time_s, double length_s);

}  // namespace lightwell::render
