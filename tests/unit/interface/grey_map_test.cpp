// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/grey_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "interface/atomic_file.h"
#include "tests/support/temporary_folder.h"

namespace lightwell::test {
namespace {

using testing::HasSubstr;

class GreyMapTest : public testing::Test {
 protected:
  Result<GreyMap> read(const std::string& bytes) {
    EXPECT_TRUE(write_file_atomically(file_, bytes));
    return read_grey_map(file_);
  }
  void expect_bad(const std::string& bytes, const std::string& words) {
    const auto map = read(bytes);
    ASSERT_FALSE(map) << words;
    EXPECT_EQ(map.error().kind, ErrorKind::bad_input);
    EXPECT_THAT(map.error().message, HasSubstr("frame.pgm: " + words));
  }
  TemporaryFolder folder_;
  std::filesystem::path file_ = folder_.path() / "frame.pgm";
};

TEST_F(GreyMapTest, SamplesAreAsCamerasSendThem) {
  const auto small = read("P5 # a frame\n3 1 # wide\n255\nabc");
  ASSERT_TRUE(small) << small.error().message;
  EXPECT_TRUE(is_grey_map(file_));
  EXPECT_EQ(small->width, 3);
  EXPECT_EQ(small->bytes_a_sample, 1);
  EXPECT_EQ(small->samples, (std::vector{std::byte{'a'}, std::byte{'b'}, std::byte{'c'}}));
  const auto wide = read("P5\n1 2\n4095\n\x01\x02\x03\x04 and more, which does not count");
  ASSERT_TRUE(wide) << wide.error().message;
  EXPECT_EQ(wide->bytes_a_sample, 2);
  EXPECT_EQ(wide->samples, (std::vector{std::byte{2}, std::byte{1}, std::byte{4}, std::byte{3}}));
}

TEST_F(GreyMapTest, RefusesWhatIsNone) {
  expect_bad("P6\n1 1\n255\nabc", "does not begin with P5");
  EXPECT_FALSE(is_grey_map(file_));
  expect_bad("P5", "width, height or greatest value is no number");
  expect_bad("P5\n1 x\n255\na", "width, height or greatest value is no number");
  expect_bad("P5\n0 1\n255\na", "is 0x1, allowed: 1x1 to 16384x16384");
  expect_bad("P5\n-3 1\n255\na", "is -3x1");
  expect_bad("P5\n99999999999 1\n255\na", "width, height or greatest value is no number");
  expect_bad("P5\n1 1\n65536\naa", "greatest value is 65536, allowed: 1 to 65535");
  expect_bad("P5\n1 1\n255", "ends inside the header");
  expect_bad("P5\n2 2\n255\nabc", "has 3 bytes of samples, allowed: 4");
  EXPECT_FALSE(is_grey_map(folder_.path() / "none.pgm"));
}

}  // namespace
}  // namespace lightwell::test
