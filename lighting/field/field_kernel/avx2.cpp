// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// Built with -mavx2 (lighting/CMakeLists.txt), run where the machine has it.
#include "lighting/field/field_kernel/kernel.h"
#if defined(__x86_64__) && defined(__AVX2__)

// The kernels' text stands behind their declarations.
#include "lighting/field/field_kernel/kernels.inl"

namespace lightwell::field_kernel {

extern const Kernels kAvx2Kernels;
const Kernels kAvx2Kernels = {within, square_distance, fit, interpolate, interpolate_across, add_products};

}  // namespace lightwell::field_kernel
#endif
