// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// Built with -mavx2 -mfma (lighting/CMakeLists.txt), run where the machine has them.
#include "lighting/decomposition/placement_kernel/kernel.h"
#if defined(__x86_64__) && defined(__AVX2__)
#include <immintrin.h>

#define LIGHTWELL_AVX2_KERNELS

// The kernels' text stands behind their declarations.
#include "lighting/decomposition/placement_kernel/kernels.inl"

namespace lightwell::placement_kernel {

extern const Kernels kAvx2Kernels;
const Kernels kAvx2Kernels = {add_ring,    potentials, potential, gradient,      nearest,
                              add_moments, multiply,   add_outer, best_to_leave, multiply_rows};

}  // namespace lightwell::placement_kernel
#endif
