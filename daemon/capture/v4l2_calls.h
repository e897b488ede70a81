// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

namespace lightwell {

// What the V4L2 source asks of the kernel, and nothing else: the place where a test puts a device that fails
// on demand. Nothing here allocates; calls are made from one thread at a time for each descriptor.
class V4l2Calls {
 public:
  struct Ready {
    bool frame = false;   // a buffer can be dequeued
    bool event = false;   // an event can
    bool broken = false;  // the driver has given up this stream, or the device is gone
    bool woken = false;   // the other descriptor is readable
  };

  virtual ~V4l2Calls() = default;
  // For reading and writing, never blocking: a descriptor, or −errno.
  virtual int open(const char* path) noexcept = 0;
  virtual void close(int fd) noexcept = 0;
  // 0 or −errno; begun again where a signal interrupts it.
  virtual int ioctl(int fd, unsigned long request, void* argument) noexcept = 0;
  // Shared, readable and writable; nullptr where the kernel refuses.
  virtual void* map(int fd, std::size_t bytes, std::int64_t offset) noexcept = 0;
  virtual void unmap(void* at, std::size_t bytes) noexcept = 0;
  // Until one of them is ready or the time is over.
  virtual Ready wait(int fd, int wake_fd, int timeout_ms) noexcept = 0;
};

// The kernel's own.
V4l2Calls& system_v4l2_calls();

}  // namespace lightwell
