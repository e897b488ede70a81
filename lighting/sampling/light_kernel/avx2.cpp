// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// Built with -mavx2 (lighting/CMakeLists.txt), run where the machine has it.
#include "lighting/sampling/light_kernel/kernel.h"
#if defined(__x86_64__) && defined(__AVX2__)
#include <immintrin.h>

// The kernels' text stands behind their declarations.
#include "lighting/sampling/light_kernel/kernels.inl"

namespace lightwell::light_kernel {

extern const Kernels kAvx2Kernels;
const Kernels kAvx2Kernels = {
    weigh_ring, blend, target, locate, directions, filter, filter_within_range, settle_directions};

}  // namespace lightwell::light_kernel
#endif
