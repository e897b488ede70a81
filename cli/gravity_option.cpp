// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/gravity_option.h"

#include <sstream>

#include "interface/option_range.h"
#include "lighting/orientation.h"

namespace lightwell::cli {

Result<Vec3d> zenith_of_option(const std::string& text) {
  const Error refused = usage("--gravity: value '" + text + "', allowed three numbers X,Y,Z");
  std::istringstream parts(text);
  std::string part;
  Vec3d reading;
  Eigen::Index count = 0;
  for (; std::getline(parts, part, ','); ++count) {
    const auto number = option_range::parse<double>(part);
    if (!number || count == 3) return refused;
    reading[count] = *number;
  }
  if (count != 3 || text.back() == ',') return refused;
  auto zenith = zenith_from_accelerometer(reading);
  if (!zenith) return usage("--gravity: value '" + text + "': " + zenith.error().message);
  return zenith;
}

}  // namespace lightwell::cli
