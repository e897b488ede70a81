// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace lightwell {

// A message as a terminal may have it: names in it may come from files and from the network. Control characters (C0,
// DEL and the C1 controls in UTF-8) become \n, \r, \t or \xHH; all else stays, so one message is one line.
std::string printable(std::string_view message);

}  // namespace lightwell
