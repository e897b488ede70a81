// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// The simulated board's end of the wire.

#include <cstdint>
#include <deque>

namespace lightwell::sync_simulator {

class Link {
 public:
  Link() = default;
  virtual ~Link() = default;
  Link(const Link&) = delete;
  Link& operator=(const Link&) = delete;

  // Moves what can be moved without waiting. False: there will be no host any more. May throw std::runtime_error.
  virtual bool move(std::deque<std::uint8_t>& from_host, std::deque<std::uint8_t>& to_host) = 0;
};

}  // namespace lightwell::sync_simulator
