// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/atomic_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace lightwell {
namespace {

Error failure(const std::filesystem::path& file, const char* what) {
  return {ErrorKind::failed, file.string() + ": " + what + ": " + std::strerror(errno)};
}

bool write_all(int fd, std::string_view content) {
  while (!content.empty()) {
    const ssize_t n = ::write(fd, content.data(), content.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    content.remove_prefix(static_cast<std::size_t>(n));
  }
  return true;
}

}  // namespace

Status write_file_atomically(const std::filesystem::path& file, std::string_view content) {
  std::string temporary = file.string() + ".XXXXXX";
  const int fd = ::mkostemp(temporary.data(), O_CLOEXEC);
  if (fd < 0) return failure(file, "cannot write");
  const bool written = write_all(fd, content) && ::fchmod(fd, 0644) == 0 && ::fsync(fd) == 0;
  const int write_errno = errno;
  const bool closed = ::close(fd) == 0;
  if (written && closed && ::rename(temporary.c_str(), file.c_str()) == 0) return {};
  if (!written) errno = write_errno;
  const Error error = failure(file, "cannot write");
  ::unlink(temporary.c_str());
  return error;
}

Result<std::string> read_text_file(const std::filesystem::path& file, std::size_t limit_bytes) {
  const auto bad = [&](const std::string& what) { return Error{ErrorKind::bad_input, file.string() + ": " + what}; };
  const int fd = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) return bad(std::string("cannot read: ") + std::strerror(errno));
  std::string text;
  std::string why;
  struct stat info {};
  if (::fstat(fd, &info) == 0 && S_ISDIR(info.st_mode)) {
    why = "is a directory, expected a file";
  } else {
    char buffer[65536];
    for (;;) {
      const ssize_t n = ::read(fd, buffer, sizeof buffer);
      if (n < 0 && errno == EINTR) continue;
      if (n < 0) why = std::string("cannot read: ") + std::strerror(errno);
      if (n <= 0) break;
      text.append(buffer, static_cast<std::size_t>(n));
      if (text.size() > limit_bytes) {
        why = "is larger than " + std::to_string(limit_bytes) + " bytes";
        break;
      }
    }
  }
  ::close(fd);
  if (!why.empty()) return bad(why);
  return text;
}

}  // namespace lightwell
