// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fcntl.h>
#include <unistd.h>

#include <cstdlib>

namespace lightwell::test {

// Of this process, bytes; allocates nothing. 0 where the system does not say.
inline double resident_bytes() {
  char text[128] = {};
  const int fd = ::open("/proc/self/statm", O_RDONLY | O_CLOEXEC);
  if (fd < 0) return 0;
  const ssize_t n = ::read(fd, text, sizeof text - 1);
  ::close(fd);
  if (n <= 0) return 0;
  char* rest = nullptr;
  std::strtol(text, &rest, 10);  // proc(5): total size, then resident, in pages
  return static_cast<double>(std::strtol(rest, nullptr, 10)) * static_cast<double>(::sysconf(_SC_PAGESIZE));
}

}  // namespace lightwell::test
