// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/atomic_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

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

Status check_output_name(const std::filesystem::path& file) {
  if (file.empty()) return Error{ErrorKind::usage, "output '': allowed the name of a file"};
  if (file != "-") return {};
  return Error{ErrorKind::usage,
               "output '-': standard output is /dev/stdout, and a file of this name is ./-"};
}

AtomicFileWriter::AtomicFileWriter(std::filesystem::path file, std::string temporary, int fd)
    : file_(std::move(file)), temporary_(std::move(temporary)), fd_(fd) {}

AtomicFileWriter::AtomicFileWriter(AtomicFileWriter&& other) noexcept
    : file_(std::move(other.file_)),
      temporary_(std::move(other.temporary_)),
      fd_(std::exchange(other.fd_, -1)) {}

AtomicFileWriter::~AtomicFileWriter() {
  if (fd_ < 0) return;
  ::close(fd_);
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

Result<AtomicFileWriter> AtomicFileWriter::create(const std::filesystem::path& file) {
  if (Status named = check_output_name(file); !named) return named.error();
  struct stat info {};
  const bool exists = ::stat(file.c_str(), &info) == 0;
  if (exists && S_ISDIR(info.st_mode)) {
    errno = EISDIR;
    return failure(file, "cannot write");
  }
  if (exists && !S_ISREG(info.st_mode)) {  // a device or pipe stays what it is: a rename would replace it
    const int fd = ::open(file.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY);
    if (fd < 0) return failure(file, "cannot write");
    return AtomicFileWriter(file, {}, fd);
  }
  std::error_code ignored;  // behind a link the file is replaced, not the link
  std::filesystem::path target = exists ? std::filesystem::canonical(file, ignored) : file;
  if (target.empty()) target = file;
  std::string temporary = target.string() + ".XXXXXX";
  const int fd = ::mkostemp(temporary.data(), O_CLOEXEC);
  if (fd < 0) return failure(file, "cannot write");
  return AtomicFileWriter(std::move(target), std::move(temporary), fd);
}

Status AtomicFileWriter::append(std::string_view content) {
  if (!write_all(fd_, content)) return failure(file_, "cannot write");
  return {};
}

Status AtomicFileWriter::commit() {
  if (temporary_.empty()) {  // a device or pipe has it already
    if (::close(std::exchange(fd_, -1)) != 0) return failure(file_, "cannot write");
    return {};
  }
  if (::fchmod(fd_, 0644) != 0 || ::fsync(fd_) != 0) return failure(file_, "cannot write");
  if (::rename(temporary_.c_str(), file_.c_str()) != 0) return failure(file_, "cannot write");
  ::close(std::exchange(fd_, -1));  // what was synced is safe whatever close says
  return {};
}

Status write_file_atomically(const std::filesystem::path& file, std::string_view content) {
  auto writer = AtomicFileWriter::create(file);
  if (!writer) return writer.error();
  if (Status status = writer->append(content); !status) return status;
  return writer->commit();
}

Result<std::string> read_text_file(const std::filesystem::path& file, std::size_t limit_bytes) {
  const auto bad = [&](const std::string& what) {
    return Error{ErrorKind::bad_input, file.string() + ": " + what};
  };
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
