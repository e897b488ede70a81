// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// For every machine: SSE2 on x86-64, NEON on arm64.
#include "lighting/sampling/light_kernel/kernel.h"
// The kernels' text stands behind their declarations.
#include "lighting/sampling/light_kernel/kernels.inl"

namespace lightwell::light_kernel {

const Kernels kPortableKernels = {
    weigh_ring, blend, target, locate, directions, filter, filter_within_range, settle_directions};

}  // namespace lightwell::light_kernel
