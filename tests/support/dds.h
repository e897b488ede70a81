// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <unistd.h>

#include "interface/dds_domain.h"

namespace lightwell::test {

// A loopback domain of its own a process, so that tests beside each other do not hear each other.
inline DdsOptions own_domain() {
  return {.domain = 100 + static_cast<int>(::getpid() % 100), .interface = "lo"};
}

}  // namespace lightwell::test
