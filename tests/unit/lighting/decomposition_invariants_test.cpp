// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/decomposition_invariants.h"

#include <array>

namespace lightwell::test {
namespace {

// A row a method; what each number means stands with MethodClaims. The last three were measured here and are held
// with a margin, for another compiler's rounding decides otherwise between equally near places: of their excess
// over 1 about a half, at least .1.
// clang-format off
constexpr std::array kClaims = {
    //           method               place  rotation  resolution  prefix
    MethodClaims{Method::best,          0.05,  1.3,      1.27,       1.6},
    MethodClaims{Method::standard,      4,     1.14,     1.6,        1.1},
    MethodClaims{Method::havran,        4,     1.13,     1.3,        1.1},
    MethodClaims{Method::structured,    0.05,  1.25,     1.7,        1.1},
    MethodClaims{Method::kollig_keller, 0.05,  1.18,     1.17,       1.5},
    MethodClaims{Method::penrose,       4,     4,        2,          1.1},
    MethodClaims{Method::median_cut,    0.05,  1.1,      1.25,       1.1},
    MethodClaims{Method::uniform,       27,    2,        1.35,       1.1},
};
// clang-format on

constexpr bool every_method_is_claimed() {
  for (const Method method : kMethods) {
    std::size_t rows = 0;
    for (const MethodClaims& claims : kClaims) rows += claims.method == method ? 1 : 0;
    if (rows != 1) return false;
  }
  return true;
}
static_assert(every_method_is_claimed());

INSTANTIATE_TEST_SUITE_P(Decompose, DecompositionInvariants, testing::ValuesIn(kClaims),
                         [](const auto& claims) {
                           std::string text(name(claims.param.method));
                           std::replace(text.begin(), text.end(), '-', '_');
                           return text;
                         });

}  // namespace
}  // namespace lightwell::test
