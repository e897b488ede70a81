// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/options.h"

#include <gtest/gtest.h>

#include <array>

namespace lightwell::render {
namespace {

Parsed parse(const char* option, const char* value) {
  const std::array<const char*, 7> argv{
      "lightwell-render", "--scene", "a.gltf", "--environment", "a.exr", option, value};
  return parse_options(static_cast<int>(argv.size()), argv.data());
}

TEST(Options, NotANumberIsOutOfEveryRange) {
  EXPECT_EQ(parse("--spin", "nan").exit_code, 2);
  EXPECT_EQ(parse("--seconds", "nan").exit_code, 2);
}

TEST(Options, TheEndsOfTheSpinAreAllowedAndNothingBeyond) {
  for (const char* value : {"-360", "0", "360"}) EXPECT_TRUE(parse("--spin", value).options) << value;
  for (const char* value : {"-361", "361", "inf"}) EXPECT_EQ(parse("--spin", value).exit_code, 2) << value;
}

}  // namespace
}  // namespace lightwell::render
