// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/instruction_set.h"
#include "lighting/radiometer.h"
#include "lighting/radiometer/kernel.h"

namespace lightwell {
namespace radiometer {

extern const Kernels kScalarKernels;
#if defined(__x86_64__)
extern const Kernels kSimd128Kernels;
extern const Kernels kAvx2Kernels;
#elif defined(__aarch64__)
extern const Kernels kNeonKernels;
#endif

const Kernels* kernels(Isa isa) {
  switch (isa) {
    case Isa::scalar:
      return &kScalarKernels;
#if defined(__x86_64__)
    case Isa::simd128:
      return processor_has(InstructionSet::sse41) ? &kSimd128Kernels : nullptr;
    case Isa::avx2:
      return processor_has(InstructionSet::avx2) ? &kAvx2Kernels : nullptr;
#elif defined(__aarch64__)
    case Isa::neon:  // every arm64 processor has it
      return &kNeonKernels;
#endif
    default:
      return nullptr;
  }
}

}  // namespace radiometer

std::string_view name(Isa isa) {
  switch (isa) {
    case Isa::scalar:
      return "scalar";
    case Isa::simd128:
      return "simd128";
    case Isa::avx2:
      return "avx2";
    case Isa::neon:
      return "neon";
  }
  return "unknown";
}

std::vector<Isa> available_isas() {
  std::vector<Isa> found;
  for (const Isa isa : {Isa::avx2, Isa::neon, Isa::simd128, Isa::scalar})
    if (radiometer::kernels(isa) != nullptr) found.push_back(isa);
  return found;
}

}  // namespace lightwell
