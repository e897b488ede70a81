// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "firmware/port/simulator/link.h"

namespace lightwell::sync_simulator {

// A pseudo-terminal, or standard input and output.
class StreamLink final : public Link {
 public:
  // Of a pseudo-terminal, raw; its other end's path is in path(). Throws std::runtime_error.
  static std::unique_ptr<StreamLink> terminal();
  static std::unique_ptr<StreamLink> standard();
  ~StreamLink() override;

  const std::string& path() const { return path_; }
  bool move(std::deque<std::uint8_t>& from_host, std::deque<std::uint8_t>& to_host) override;

 private:
  StreamLink(int in, int out, int held, std::string path)
      : in_(in), out_(out), held_(held), path_(std::move(path)) {}

  int in_, out_;
  int held_;  // the terminal's other end, so that a host may come and go; -1: none
  std::string path_;
};

}  // namespace lightwell::sync_simulator
