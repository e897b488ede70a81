// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "lighting/evaluation/occluder.h"

namespace lightwell::cli {

// `lightwell evaluate`, its options checked.
struct EvaluateOptions {
  std::string environment;
  std::string lights;
  std::vector<Occluder> occluders;    // asked for beside the sphere
  std::vector<std::size_t> prefixes;  // also measured: the first n lights of each set
  double rotate_y_rad = 0;
  bool json = false;
};

// A sequence of images against a file of one set a line: exit code.
int evaluate_sequence(const EvaluateOptions& options);

}  // namespace lightwell::cli
