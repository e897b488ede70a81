// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cmath>
#include <limits>

#include "daemon/pipeline/pipeline.h"

namespace lightwell {

// Gives frames of a camera that knows no temperature the one of the board's sensor on it.
class TemperatureStamper final : public FrameStamper {
 public:
  // NaN: not known. Any thread.
  void set(float temperature_c) noexcept { temperature_c_.store(temperature_c, std::memory_order_relaxed); }
  bool stamp(FrameInfo& info) noexcept override {
    const float temperature_c = temperature_c_.load(std::memory_order_relaxed);
    if (!used_.load(std::memory_order_relaxed) || std::isnan(temperature_c) ||
        !std::isnan(info.temperature_c))
      return false;
    info.temperature_c = temperature_c;
    return true;
  }
  // Off: a take has the temperature of its day, or none.
  void use(bool on) noexcept { used_.store(on, std::memory_order_relaxed); }

 private:
  std::atomic<float> temperature_c_{std::numeric_limits<float>::quiet_NaN()};
  std::atomic<bool> used_{true};
};

}  // namespace lightwell
