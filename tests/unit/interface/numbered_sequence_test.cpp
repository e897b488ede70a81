// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/numbered_sequence.h"

#include <gtest/gtest.h>

#include "interface/atomic_file.h"
#include "tests/support/temporary_folder.h"

namespace lightwell {
namespace {

class NumberedSequence : public testing::Test {
 protected:
  void touch(const std::string& name) { ASSERT_TRUE(write_file_atomically(folder_.path() / name, "")); }
  [[nodiscard]] std::string pattern(const std::string& name) const {
    return (folder_.path() / name).string();
  }
  std::vector<std::string> names(const std::string& name) {
    std::vector<std::string> found;
    const auto files = sequence_files(pattern(name));
    if (!files) return {files.error().kind == ErrorKind::bad_input ? "bad" : "other"};
    for (const auto& file : *files) found.push_back(file.filename().string());
    return found;
  }

 private:
  test::TemporaryFolder folder_;
};

using Names = std::vector<std::string>;

TEST_F(NumberedSequence, IsOrderedByNumberAndIgnoresOtherFiles) {
  for (const char* name :
       {"e8.exr", "e9.exr", "e10.exr", "e11.exr", "e.exr", "ex.exr", "e08.exr", "f9.exr", "e9.hdr"})
    touch(name);
  EXPECT_EQ(names("e%d.exr"), (Names{"e8.exr", "e9.exr", "e10.exr", "e11.exr"}));
}

TEST_F(NumberedSequence, PaddingIsTheLeastNumberOfDigits) {
  for (const char* name : {"e0099.exr", "e0100.exr", "e099.exr"}) touch(name);
  EXPECT_EQ(names("e%04d.exr"), (Names{"e0099.exr", "e0100.exr"}));
  for (const char* name : {"g98.exr", "g99.exr", "g100.exr"}) touch(name);
  EXPECT_EQ(names("g%02d.exr"), (Names{"g98.exr", "g99.exr", "g100.exr"}));
}

TEST_F(NumberedSequence, GapsAndNothingAreBadInput) {
  for (const char* name : {"e1.exr", "e3.exr"}) touch(name);
  EXPECT_EQ(names("e%d.exr"), Names{"bad"});
  EXPECT_EQ(names("absent%d.exr"), Names{"bad"});
  EXPECT_EQ(names("e%d_%d.exr"), Names{"bad"});
}

TEST_F(NumberedSequence, AFileOfTheVeryNameIsNoSequence) {
  touch("e1.exr");
  EXPECT_TRUE(is_numbered_sequence(pattern("e%d.exr")));
  touch("e%d.exr");
  EXPECT_FALSE(is_numbered_sequence(pattern("e%d.exr")));
}

TEST(IsNumberedSequence, KnowsItsTwoForms) {
  EXPECT_TRUE(is_numbered_sequence("a/e_%04d.exr"));
  EXPECT_TRUE(is_numbered_sequence("%d"));
  for (const char* text : {"env.exr", "100%.exr", "%s.exr", "%4d.exr", "%00d.exr", "%0", "%"})
    EXPECT_FALSE(is_numbered_sequence(text)) << text;
}

}  // namespace
}  // namespace lightwell
