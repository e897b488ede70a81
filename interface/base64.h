// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lightwell {

// RFC 4648, section 4, with padding. Decoding refuses anything that encoding cannot have written: other
// letters, white space, wrong length, missing padding, bits set beyond the end.
std::string base64_encode(std::span<const std::byte> bytes);
std::optional<std::vector<std::byte>> base64_decode(std::string_view text);

}  // namespace lightwell
