// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/frame_name.h"

#include <gtest/gtest.h>

namespace lightwell {
namespace {

TEST(FrameName, NumbersFramesAsPrintfDoes) {
  EXPECT_EQ(FrameName::parse("a/f_%04d.exr")->file(7), "a/f_0007.exr");
  EXPECT_EQ(FrameName::parse("f%d.png")->file(12), "f12.png");
  EXPECT_EQ(FrameName::parse("f%02d.png")->file(12345), "f12345.png");
  EXPECT_EQ(FrameName::parse("f%04d.png")->format, FrameName::Format::png);
}

TEST(FrameName, WithoutANumberEveryFrameHasTheSameName) {
  const auto name = FrameName::parse("relit.exr");
  EXPECT_FALSE(name->numbered);
  EXPECT_EQ(name->file(3), "relit.exr");
}

TEST(FrameName, RefusesWhatItWouldNotExpand) {
  for (const char* pattern :
       {"f.jpg", "f", "f_%s.exr", "f_%4d.exr", "f_%04d_%d.exr", "f_%.exr", "f_%0123d.exr", "%"}) {
    const auto name = FrameName::parse(pattern);
    ASSERT_FALSE(name.ok()) << pattern;
    EXPECT_EQ(name.error().kind, ErrorKind::usage);
  }
}

}  // namespace
}  // namespace lightwell
