// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/writable_output.h"

#include "interface/atomic_file.h"

namespace lightwell {

Status check_can_write(const std::filesystem::path& file) {
  std::error_code ignored;
  const auto there = std::filesystem::status(file, ignored);
  if (std::filesystem::exists(there) && !std::filesystem::is_regular_file(there) &&
      !std::filesystem::is_directory(there))
    return {};
  const auto writer = AtomicFileWriter::create(file);  // leaves nothing
  return writer ? Status() : writer.error();
}

}  // namespace lightwell
