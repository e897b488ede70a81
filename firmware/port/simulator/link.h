// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// The simulated board's end of the wire: a pseudo-terminal, or standard input and output.

#include <cstdint>
#include <deque>
#include <string>

namespace lightwell::sync_simulator {

class Link {
 public:
  // Of a pseudo-terminal, raw; its other end's path is in path(). Throws std::runtime_error.
  static Link terminal();
  static Link standard();
  Link(Link&& other) noexcept;
  Link& operator=(Link&&) = delete;
  ~Link();

  const std::string& path() const { return path_; }

  // Moves what can be moved without waiting. False: the host has closed standard input.
  bool move(std::deque<std::uint8_t>& from_host, std::deque<std::uint8_t>& to_host);

 private:
  Link(int in, int out, int held) : in_(in), out_(out), held_(held) {}

  int in_, out_;
  int held_;  // the terminal's other end, so that a host may come and go; -1: none
  std::string path_;
};

}  // namespace lightwell::sync_simulator
