// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// A board in its world: the firmware's own loop on a port whose hardware is the world. One a process.

#include <array>
#include <cstdint>
#include <deque>
#include <vector>

#include "firmware/core/flash.h"
#include "firmware/port/simulator/world.h"

namespace lightwell::sync_simulator {

class Simulator {
 public:
  static constexpr std::size_t kLinkBytes = 64;  // what a UART's or endpoint's buffer takes
  static constexpr std::uint32_t kFlashRegion = 65536;

  explicit Simulator(const WorldOptions& options);
  ~Simulator();
  Simulator(const Simulator&) = delete;
  Simulator& operator=(const Simulator&) = delete;

  const board_facts& facts() const { return facts_; }

  World world;
  std::deque<std::uint8_t> from_host, to_host;
  bool lit = false;

 private:
  std::array<std::vector<std::uint8_t>, FLASH_REGIONS> flash_;
  flash driver_{};
  update_verifier verifier_{};
  board_facts facts_{};
};

}  // namespace lightwell::sync_simulator
