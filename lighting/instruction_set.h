// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace lightwell {

// What kernels are built for beside the portable code. Every arm64 processor has NEON: nothing to ask.
enum class InstructionSet { sse41, avx2, fma };

// Whether this processor has it. Never on other families than x86-64.
bool processor_has(InstructionSet set) noexcept;

}  // namespace lightwell
