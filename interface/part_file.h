// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "lighting/result.h"

namespace lightwell {

// A hidden name beside `out` for an output that takes long to write; it becomes `out` only when it is whole,
// and goes away where it never is. For files small enough to hold in memory: write_file_atomically.
class PartFile {
 public:
  explicit PartFile(const std::filesystem::path& out);
  ~PartFile();  // removes what was not kept
  PartFile(const PartFile&) = delete;
  PartFile& operator=(const PartFile&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return part_; }
  // The error as the caller should see it: with out's name where it has the hidden one.
  [[nodiscard]] Error about_out(Error error) const;
  // It stays under its hidden name.
  void leave() { part_.clear(); }
  // Fails where `out` exists, unless overwrite.
  Status keep(bool overwrite = false);

 private:
  std::filesystem::path out_;
  std::filesystem::path part_;
};

}  // namespace lightwell
