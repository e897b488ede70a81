// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <optional>
#include <string>

namespace lightwell::render {

// Says on stderr whether live light comes: a line a change of state, never a line a frame.
class LiveNews {
 public:
  // what: as "light"
  LiveNews(std::string what, int domain) : what_(std::move(what)), domain_(domain) {}
  // age: since the last came; empty before the first. from: whose it is, in words.
  void tell(std::optional<std::chrono::nanoseconds> age, bool arrived, const std::string& from);

 private:
  enum class State { unknown, waiting, flowing, stopped };
  std::string what_;
  int domain_;
  State told_ = State::unknown;
};

}  // namespace lightwell::render
