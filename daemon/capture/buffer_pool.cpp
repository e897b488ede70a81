// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/capture/buffer_pool.h"

#include <sys/mman.h>
#include <unistd.h>

namespace lightwell {

std::unique_ptr<BufferPool> BufferPool::create(std::size_t buffer_bytes, std::size_t count) {
  const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  const std::size_t stride = (buffer_bytes + page - 1) / page * page;
  if (stride == 0 || count == 0) return nullptr;
  void* base = ::mmap(nullptr, stride * count, PROT_READ | PROT_WRITE,
                      MAP_PRIVATE | MAP_ANONYMOUS | MAP_POPULATE, -1, 0);
  if (base == MAP_FAILED) return nullptr;
  return std::unique_ptr<BufferPool>(
      new BufferPool(static_cast<std::byte*>(base), buffer_bytes, stride, count));
}

BufferPool::~BufferPool() {
  ::munmap(base_, stride_ * count_);
}

}  // namespace lightwell
