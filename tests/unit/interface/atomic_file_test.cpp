// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/atomic_file.h"

#include <gtest/gtest.h>

#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <thread>

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

TEST(AtomicFile, ALinkStaysALinkAndItsFileIsReplaced) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "real.json";
  const auto link = folder.path() / "link.json";
  ASSERT_TRUE(write_file_atomically(file, "old"));
  std::filesystem::create_symlink(file, link);
  ASSERT_TRUE(write_file_atomically(link, "new"));
  EXPECT_TRUE(std::filesystem::is_symlink(link));
  EXPECT_EQ(read_text_file(file).value(), "new");
}

TEST(AtomicFile, APipeStaysAPipeAndGetsTheContent) {
  const TemporaryFolder folder;
  const auto pipe = folder.path() / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  std::string read;
  std::thread reader([&] { read = read_text_file(pipe).value(); });
  const Status status = write_file_atomically(pipe, "through");
  reader.join();
  EXPECT_TRUE(status);
  EXPECT_EQ(read, "through");
  EXPECT_TRUE(std::filesystem::is_fifo(pipe));
}

TEST(AtomicFile, AFullDeviceIsAFailureAndStaysADevice) {
  const TemporaryFolder folder;
  const auto link = folder.path() / "full";  // through a link: a failing test leaves the device alone
  std::filesystem::create_symlink("/dev/full", link);
  if (!std::filesystem::is_character_file(link)) GTEST_SKIP() << "no /dev/full here";
  const Status status = write_file_atomically(link, "x");
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().kind, ErrorKind::failed);
  EXPECT_TRUE(std::filesystem::is_symlink(link));
}

TEST(AtomicFile, AFolderIsAFailureAndNothingIsLeftBesideIt) {
  const TemporaryFolder folder;
  const auto inner = folder.path() / "inner";
  std::filesystem::create_directory(inner);
  const Status status = write_file_atomically(inner, "x");
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().kind, ErrorKind::failed);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

}  // namespace
}  // namespace lightwell
