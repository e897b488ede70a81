// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

namespace lightwell {

// True where the bytes are one well-formed CBOR item and nothing behind it, nested no deeper than this: arrays, maps, tags
// and strings of no given length count one each. Needs no more stack than the depth allows and no memory for what lengths
// promise, so that what passes can be given to a reader that recurs.
// source: RFC 8949, sections 3 and 5.3.1, appendix C
bool is_shallow_cbor(std::span<const std::uint8_t> bytes, std::size_t most_depth);

}  // namespace lightwell
