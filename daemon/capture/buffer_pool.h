// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <span>

namespace lightwell {

// Equal, page-aligned buffers in one mapping, paged in at once so that no frame pays for it.
class BufferPool {
 public:
  // nullptr where there is not enough memory
  static std::unique_ptr<BufferPool> create(std::size_t buffer_bytes, std::size_t count);
  ~BufferPool();
  BufferPool(const BufferPool&) = delete;
  BufferPool& operator=(const BufferPool&) = delete;

  [[nodiscard]] std::size_t count() const noexcept { return count_; }
  [[nodiscard]] std::span<std::byte> buffer(std::size_t i) const noexcept {
    return {base_ + i * stride_, buffer_bytes_};
  }

 private:
  BufferPool(std::byte* base, std::size_t buffer_bytes, std::size_t stride, std::size_t count)
      : base_(base), buffer_bytes_(buffer_bytes), stride_(stride), count_(count) {}

  std::byte* base_;
  std::size_t buffer_bytes_, stride_, count_;
};

}  // namespace lightwell
