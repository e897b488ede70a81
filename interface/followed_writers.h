// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <string_view>

namespace lightwell {

// Of several writers that publish under one name, one is followed and never mixed with another: the first that is heard,
// until it is gone or silent for `patience`.
class FollowedWriters {
 public:
  using Time = std::chrono::steady_clock::time_point;
  explicit FollowedWriters(std::chrono::milliseconds patience) : patience_(patience) {}

  // Whether what came from this writer counts. is_there: whether a writer is still on the wire.
  bool follows(std::string_view name, std::uint64_t writer, Time now,
               const std::function<bool(std::uint64_t)>& is_there);
  // Names under which a second one was heard while the first was followed.
  [[nodiscard]] const std::set<std::string, std::less<>>& contested() const { return contested_; }

 private:
  static constexpr std::size_t kMostNames = 256;  // of strangers, who may have any number
  struct Followed {
    std::uint64_t writer = 0;
    Time heard;
  };
  std::chrono::milliseconds patience_;
  std::map<std::string, Followed, std::less<>> followed_;
  std::set<std::string, std::less<>> contested_;
};

}  // namespace lightwell
