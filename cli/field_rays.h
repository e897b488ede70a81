// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "field/field_builder.h"

namespace lightwell::cli {

// Lines on rays that contradict each other: one that names the worst probes, one where rays that pass together differ.
std::vector<std::string> remarks_on_rays(const ProbeTake& take, const FieldBuild& build);
// How many probes are doubted, and the worst of them with name, place and share of rays.
nlohmann::ordered_json rays_json(const ProbeTake& take, const FieldBuild& build);

}  // namespace lightwell::cli
