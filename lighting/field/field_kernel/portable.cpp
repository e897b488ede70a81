// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/field_kernel/kernel.h"

// The kernels' text stands behind their declarations.
#include "lighting/field/field_kernel/kernels.inl"

namespace lightwell::field_kernel {

const Kernels kPortableKernels = {within,      square_distance,    fit,
                                  interpolate, interpolate_across, add_products};

}  // namespace lightwell::field_kernel
