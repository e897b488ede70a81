// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "lighting/result.h"

namespace lightwell {

enum class Verdict { ok, warn, fail };  // warn: works, but not as well as it could
const char* name(Verdict verdict);

// One thing that was looked at.
struct Finding {
  std::string name;  // "receive buffer"
  Verdict verdict = Verdict::ok;
  std::string message;  // what was found
  std::string fix;      // what to do; empty where all is well
};

struct DiagnosisOptions {
  std::size_t frame_bytes = 0;                   // 0: of the largest camera found, or 1024² of 16 bit
  std::string http = "127.0.0.1:8650";           // where the daemon should be
  std::filesystem::path record_directory = ".";  // where takes should go
};

// Looks at everything Lightwell needs of a machine: cameras, network, daemon, rendering, disk, rights,
// processor, clock. Takes up to some seconds; changes nothing. usage: http is not ADDRESS:PORT
Result<std::vector<Finding>> diagnose(const DiagnosisOptions& options);

}  // namespace lightwell
