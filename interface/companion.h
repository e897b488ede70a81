// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string_view>

namespace lightwell {

// A program or module that this program starts or loads: beside it where it was built, else where packages have it,
// ../libexec/lightwell/ from it. The first of these where neither holds it.
std::filesystem::path companion(std::string_view name);

}  // namespace lightwell
