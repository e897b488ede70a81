// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/kms_screen.h"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/temporary_folder.h"

namespace lightwell::render {
namespace {

void expect_refused(const std::filesystem::path& folder, const std::string& named) {
  const auto screen = KmsScreen::open(folder);
  ASSERT_FALSE(screen.ok());
  EXPECT_EQ(screen.error().kind, ErrorKind::failed);
  EXPECT_NE(screen.error().message.find(named), std::string::npos) << screen.error().message;
  EXPECT_EQ(screen.error().message.find('\n'), std::string::npos);
}

TEST(KmsScreen, AMachineWithoutGraphicsDevicesIsOneLine) {
  const test::TemporaryFolder folder;
  expect_refused(folder.path(), "no graphics device");
  expect_refused(folder.path() / "missing", "missing");
}

TEST(KmsScreen, AFileThatIsNoDeviceIsOneLineThatNamesIt) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path() / "card0") << "no device";
  expect_refused(folder.path(), "card0");
}

TEST(KmsScreen, ShowsPicturesOnARealScreen) {
  const auto screen = KmsScreen::open();
  if (!screen.ok()) GTEST_SKIP() << screen.error().message;
  EXPECT_GT((*screen)->size().first, 0);
  for (int i = 0; i < 3; ++i) EXPECT_TRUE((*screen)->show());
}

}  // namespace
}  // namespace lightwell::render
