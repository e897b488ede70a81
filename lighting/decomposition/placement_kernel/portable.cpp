// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// For every machine: SSE2 on x86-64, NEON on arm64.
#include "lighting/decomposition/placement_kernel/kernel.h"
// The kernels' text stands behind their declarations.
#include "lighting/decomposition/placement_kernel/kernels.inl"

namespace lightwell::placement_kernel {

const Kernels kPortableKernels = {add_ring,    potentials, potential, gradient,      nearest,
                                  add_moments, multiply,   add_outer, best_to_leave, multiply_rows};

}  // namespace lightwell::placement_kernel
