// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// Built with -mavx2 -mfma (lighting/CMakeLists.txt), run where the machine has them.
#include "lighting/field/live_kernel/kernel.h"
#if defined(__x86_64__) && defined(__AVX2__)
#define LIGHTWELL_AVX2_KERNELS

// The kernels' text stands behind their declarations.
#include "lighting/field/live_kernel/kernels.inl"

namespace lightwell::live_kernel {

extern const Kernels kAvx2Kernels;
const Kernels kAvx2Kernels = {interpolate, look_up, project};

}  // namespace lightwell::live_kernel
#endif
