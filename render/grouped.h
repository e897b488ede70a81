// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

namespace lightwell::render {

// Values grouped by a key below keys: those of key k are values[starts[k]] to values[starts[k + 1]], in their order.
template <class Value>
struct Groups {
  std::vector<std::size_t> starts;
  std::vector<Value> values;

  // each(put) calls put(key, value) for every pair, the same ones each of the two times it is called.
  template <class Each>
  Groups(std::size_t keys, const Each& each) : starts(keys + 1, 0) {
    each([&](std::size_t key, const Value&) { ++starts[key + 1]; });
    std::partial_sum(starts.begin(), starts.end(), starts.begin());
    values.resize(starts.back());
    std::vector<std::size_t> next(starts.begin(), starts.end() - 1);
    each([&](std::size_t key, const Value& value) { values[next[key]++] = value; });
  }
  [[nodiscard]] std::span<const Value> of(std::size_t key) const {
    return std::span(values).subspan(starts[key], starts[key + 1] - starts[key]);
  }
  void sort() {
    for (std::size_t k = 0; k + 1 < starts.size(); ++k)
      std::sort(values.begin() + static_cast<std::ptrdiff_t>(starts[k]),
                values.begin() + static_cast<std::ptrdiff_t>(starts[k + 1]));
  }
};

}  // namespace lightwell::render
