// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include <filesystem>
#include <string>
#include <string_view>

#include "lighting/result.h"

namespace lightwell {

// usage where an output is called "-", which other programs take for standard output: every writer of ours refuses
// it and names /dev/stdout, which works where a file is written in one go.
Status check_output_name(const std::filesystem::path& file);

// Writes a file whole or not at all: temporary file beside it, fsync, rename. Kind failed with the reason and
// path. A link is followed; into a device or pipe (/dev/stdout) it is written straight, nothing is renamed.
Status write_file_atomically(const std::filesystem::path& file, std::string_view content);

// The same for a file that grows piece by piece (a light set a line): nothing stands under its name before
// commit, and nothing of it is left where commit is not reached.
class AtomicFileWriter {
 public:
  static Result<AtomicFileWriter> create(const std::filesystem::path& file);
  AtomicFileWriter(AtomicFileWriter&& other) noexcept;
  AtomicFileWriter& operator=(AtomicFileWriter&&) = delete;
  ~AtomicFileWriter();

  Status append(std::string_view content);
  Status commit();

 private:
  AtomicFileWriter(std::filesystem::path file, std::string temporary, int fd);
  std::filesystem::path file_;
  std::string temporary_;  // empty: a device or pipe
  int fd_;                 // -1: closed, or moved from
};

// Whole file as text; bad_input for missing, directory, unreadable, larger than limit_bytes.
Result<std::string> read_text_file(const std::filesystem::path& file, std::size_t limit_bytes = 256u << 20);

}  // namespace lightwell
