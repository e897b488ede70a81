// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "lighting/response.h"

namespace lightwell::radiometer {

// Radiance of any code, whole or not, by straight lines between entries: for models whose fixed pattern is neither a
// factor (logarithmic) nor a term (linear) of the radiance.
class FineTable {
 public:
  // Codes first_code … last_code. As many entries a code (a power of two, up to 64) as keep the error in the middle of
  // every line below 1e-4 of its radiance, or of one code's light where that is more; 2^20 entries at most.
  FineTable(const Response& response, double first_code, double last_code);

  // code: clamped to the table
  [[nodiscard]] float radiance(float code) const noexcept {
    const float at = std::clamp((code - first_) * per_code_, 0.0f, last_);
    const auto entry = static_cast<std::size_t>(at);
    const float part = at - static_cast<float>(entry);
    return table_[entry] + part * (table_[entry + 1] - table_[entry]);
  }

  [[nodiscard]] std::size_t entries() const { return table_.size(); }

 private:
  float first_ = 0, per_code_ = 1, last_ = 0;
  std::vector<float> table_;
};

}  // namespace lightwell::radiometer
