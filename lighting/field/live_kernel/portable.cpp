// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// For every machine: SSE2 on x86-64, NEON on arm64.
#include "lighting/field/live_kernel/kernel.h"
// The kernels' text stands behind their declarations.
#include "lighting/field/live_kernel/kernels.inl"

namespace lightwell::live_kernel {

const Kernels kPortableKernels = {interpolate, look_up, project};

}  // namespace lightwell::live_kernel
