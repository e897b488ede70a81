// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>
#include <string>

#include "interface/printable.h"

namespace lightwell::render {

// A line for a person, on stderr.
inline void say(const std::string& line) {
  std::fprintf(stderr, "lightwell-render: %s\n", printable(line).c_str());
}

}  // namespace lightwell::render
