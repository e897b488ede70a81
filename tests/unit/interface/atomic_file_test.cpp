// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/atomic_file.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "tests/support/temporary_folder.h"

namespace lightwell {
namespace {

using test::TemporaryFolder;

TEST(AtomicFile, ReadsBackWhatWasWrittenAndLeavesNothingElse) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "a.json";
  ASSERT_TRUE(write_file_atomically(file, "first"));
  ASSERT_TRUE(write_file_atomically(file, "second"));
  EXPECT_EQ(read_text_file(file).value(), "second");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

TEST(AtomicFile, MissingFolderIsAFailureThatNamesTheFile) {
  const Status status = write_file_atomically("/nonexistent/x.json", "x");
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().kind, ErrorKind::failed);
  EXPECT_NE(status.error().message.find("/nonexistent/x.json"), std::string::npos);
}

TEST(AtomicFile, MissingFileAndDirectoryAreBadInput) {
  EXPECT_EQ(read_text_file("/nonexistent").error().kind, ErrorKind::bad_input);
  EXPECT_EQ(read_text_file("/").error().kind, ErrorKind::bad_input);
}

TEST(AtomicFile, RefusesAFileBeyondTheLimit) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_file_atomically(folder.path() / "big", std::string(100, 'x')));
  EXPECT_EQ(read_text_file(folder.path() / "big", 99).error().kind, ErrorKind::bad_input);
}

TEST(AtomicFileWriter, NothingStandsUnderTheNameBeforeCommitAndNothingIsLeftWithoutIt) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "a.jsonl";
  {
    auto writer = AtomicFileWriter::create(file).value();
    ASSERT_TRUE(writer.append("one\n"));
    EXPECT_FALSE(std::filesystem::exists(file));
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  auto writer = AtomicFileWriter::create(file).value();
  ASSERT_TRUE(writer.append("one\n"));
  ASSERT_TRUE(writer.append("two\n"));
  ASSERT_TRUE(writer.commit());
  EXPECT_EQ(read_text_file(file).value(), "one\ntwo\n");
}

}  // namespace
}  // namespace lightwell
