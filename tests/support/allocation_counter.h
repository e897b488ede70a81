// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace lightwell::test {

// Counts what the calling thread allocates from here on, through new, malloc and their kin, in every library.
// Compile allocation_counter.cpp into the test program: it takes the place of malloc there.
class AllocationCounter {
 public:
  AllocationCounter() : start_(of_this_thread()) {}
  [[nodiscard]] std::uint64_t count() const { return of_this_thread() - start_; }

 private:
  static std::uint64_t of_this_thread();
  std::uint64_t start_;
};

}  // namespace lightwell::test
