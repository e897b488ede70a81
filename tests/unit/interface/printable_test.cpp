// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/printable.h"

#include <gtest/gtest.h>

namespace lightwell {
namespace {

TEST(Printable, TextStaysAsItIs) {
  for (const char* text : {"", "take.mkv", "a \\ b \"c\"", "640\u00d7480 \u00b5s \u4e2d"})
    EXPECT_EQ(printable(text), text);
}

TEST(Printable, NoControlCharacterReachesTheTerminal) {
  EXPECT_EQ(printable("a\nb\rc\td"), "a\\nb\\rc\\td");
  EXPECT_EQ(printable("\x1b[2J\x7f"), "\\x1b[2J\\x7f");
  EXPECT_EQ(printable(std::string("\0", 1)), "\\x00");
  EXPECT_EQ(printable("\u009b2J"), "\\x9b2J");  // CSI as one character
  for (int code = 0; code < 256; ++code)
    for (const char made : printable(std::string(1, static_cast<char>(code))))
      EXPECT_FALSE(static_cast<unsigned char>(made) < 0x20 || made == 0x7f) << code;
}

TEST(Printable, ATruncatedCharacterAtTheEndStays) {
  EXPECT_EQ(printable("\xc2"), "\xc2");
}

}  // namespace
}  // namespace lightwell
