// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/instruction_set.h"

namespace lightwell {

#if defined(__x86_64__)
bool processor_has(InstructionSet set) noexcept {
  switch (set) {
    case InstructionSet::sse41:
      return __builtin_cpu_supports("sse4.1") != 0;
    case InstructionSet::avx2:
      return __builtin_cpu_supports("avx2") != 0;
    case InstructionSet::fma:
      return __builtin_cpu_supports("fma") != 0;
  }
  return false;
}
#else
bool processor_has(InstructionSet) noexcept {
  return false;
}
#endif

}  // namespace lightwell
