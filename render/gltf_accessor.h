// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lighting/result.h"

namespace tinygltf {
class Model;
}

namespace lightwell::render {

// Values of one accessor as float, count × components; normalised integers become [0,1] or [−1,1],
// sparse elements stand where they belong.
// what: names the accessor in errors, "mesh 0 POSITION". bad_input: index out of range, wrong number of
// components, reaching past its buffer, not finite.
Result<std::vector<float>> read_floats(const tinygltf::Model& model, int accessor, int components,
                                       const std::string& what);
// The same for indices of 8, 16 and 32 bits; every one is below vertex_count.
Result<std::vector<std::uint32_t>> read_indices(const tinygltf::Model& model, int accessor,
                                                std::size_t vertex_count, const std::string& what);

}  // namespace lightwell::render
