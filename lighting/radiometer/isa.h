// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace lightwell {

// Instruction sets the frame kernel is built for; which of them run here is known at run time only.
// simd128: SSE4.1. avx2: AVX2. neon: arm64.
enum class Isa { scalar, simd128, avx2, neon };

}  // namespace lightwell
