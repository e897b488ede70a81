// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/field_kernel/kernel.h"
#include "lighting/instruction_set.h"

namespace lightwell::field_kernel {

#if defined(__x86_64__)
extern const Kernels kAvx2Kernels;

const Kernels* avx2_kernels() {
  return processor_has(InstructionSet::avx2) ? &kAvx2Kernels : nullptr;
}
#else
const Kernels* avx2_kernels() {
  return nullptr;
}
#endif

const Kernels& kernels() {
  static const Kernels& best = avx2_kernels() ? *avx2_kernels() : kPortableKernels;
  return best;
}

}  // namespace lightwell::field_kernel
