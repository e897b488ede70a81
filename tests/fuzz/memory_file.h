// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "lighting/result.h"

namespace lightwell::fuzz {

// Bytes as a file that readers open by its name, in memory alone.
class MemoryFile {
 public:
  explicit MemoryFile(std::span<const std::uint8_t> bytes) : fd_(::memfd_create("fuzz", MFD_CLOEXEC)) {
    verify_bug(fd_ >= 0 && ::write(fd_, bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size()),
               "no file in memory");
  }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  ~MemoryFile() { ::close(fd_); }
  [[nodiscard]] std::filesystem::path path() const { return "/proc/self/fd/" + std::to_string(fd_); }

 private:
  int fd_;
};

// What every refusal is: one line that names the file.
inline void expect_one_line(const Error& error, const std::string& file) {
  verify_bug(error.message.find(file) != std::string::npos, "a refusal without the file's name");
  verify_bug(error.message.size() < 2000, "a refusal that nobody reads to its end");
}

}  // namespace lightwell::fuzz
