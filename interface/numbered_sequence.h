// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lighting/result.h"

namespace lightwell {

// "env_%04d.exr": one %d or %0Nd in the file's name stands for the frame's number, zero-padded to N digits.
// A file that has the very name is that file and no sequence.
bool is_numbered_sequence(const std::string& pattern);

// The files of a sequence in order of number, from the smallest there is.
// bad_input: none, a number missing between two frames, more than one number in the pattern, one in the
// folder's name
Result<std::vector<std::filesystem::path>> sequence_files(const std::string& pattern);

}  // namespace lightwell
