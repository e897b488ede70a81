// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/part_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>
#include <system_error>

namespace lightwell {

PartFile::PartFile(const std::filesystem::path& out)
    : out_(out),
      part_(out.parent_path() /
            ("." + out.filename().string() + "." + std::to_string(::getpid()) + ".part")) {}

PartFile::~PartFile() {
  std::error_code ignored;
  if (!part_.empty()) std::filesystem::remove(part_, ignored);
}

Error PartFile::about_out(Error error) const {
  if (const auto at = error.message.find(part_.string()); at != std::string::npos)
    error.message.replace(at, part_.string().size(), out_.string());
  return error;
}

Status PartFile::keep(bool overwrite) {
  const auto failure = [this](const char* why) {
    return Error{ErrorKind::failed, out_.string() + ": cannot write: " + why};
  };
  int code = ::renameat2(AT_FDCWD, part_.c_str(), AT_FDCWD, out_.c_str(), overwrite ? 0 : RENAME_NOREPLACE);
  if (code != 0 && (errno == EINVAL || errno == ENOSYS)) {  // a file system that cannot refuse to replace
    if (std::error_code ignored; !overwrite && std::filesystem::exists(out_, ignored))
      return failure(std::strerror(EEXIST));
    code = ::rename(part_.c_str(), out_.c_str());
  }
  if (code != 0) return failure(std::strerror(errno));
  part_.clear();
  return {};
}

}  // namespace lightwell
