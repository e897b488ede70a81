// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace lightwell::bench {

// Text as an element's content in SVG: & < > as entities.
std::string escaped(const std::string& text);

}  // namespace lightwell::bench
