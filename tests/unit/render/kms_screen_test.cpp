// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/kms_screen.h"

#include <gtest/gtest.h>

#include <fstream>

#include "render/kms_output.h"
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
  expect_refused(folder.path(), "no mode setting");
}

TEST(KmsScreen, OfSeveralDevicesEachIsSaid) {
  const test::TemporaryFolder folder;
  for (const char* name : {"card10", "card2", "renderD128"})
    std::ofstream(folder.path() / name) << "no device";
  expect_refused(folder.path(), "card2");
  expect_refused(folder.path(), "card10");
  const auto devices = graphics_devices(folder.path());
  ASSERT_EQ(devices.size(), 2u);
  EXPECT_EQ(devices[0].filename(), "card2");
}

drmModeModeInfo mode(std::uint16_t width, std::uint32_t type = 0) {
  drmModeModeInfo info{};
  info.hdisplay = width;
  info.type = type;
  return info;
}

// Two controllers; an unconnected screen, and one that the second controller alone can drive.
KmsTable two_screens() {
  KmsTable table;
  table.controllers = {41, 42};
  table.connectors = {{71, false, {mode(640)}, {0b11}},
                      {72, true, {mode(4096), mode(1920, DRM_MODE_TYPE_PREFERRED), mode(800)}, {0, 0b10}}};
  return table;
}

TEST(KmsOutput, IsTheFirstConnectedScreenInItsPreferredMode) {
  const auto output = choose_output(two_screens());
  ASSERT_TRUE(output.ok()) << output.error().message;
  EXPECT_EQ(output->connector, 72u);
  EXPECT_EQ(output->controller, 42u);
  EXPECT_EQ(output->mode.hdisplay, 1920);
}

TEST(KmsOutput, WithoutAPreferredModeTheKernelsFirstIsTaken) {
  KmsTable table = two_screens();
  table.connectors[1].modes[1].type = DRM_MODE_TYPE_DRIVER;
  EXPECT_EQ(choose_output(table)->mode.hdisplay, 4096);
}

TEST(KmsOutput, AScreenThatCannotBeDrivenIsPassedBy) {
  KmsTable table = two_screens();
  table.connectors.insert(table.connectors.begin(), {{69, true, {}, {0b01}}, {70, true, {mode(320)}, {}}});
  EXPECT_EQ(choose_output(table)->connector, 72u);
}

TEST(KmsOutput, SaysWhyThereIsNone) {
  const auto refused = [](const KmsTable& table, const std::string& why) {
    const auto output = choose_output(table);
    ASSERT_FALSE(output.ok());
    EXPECT_EQ(output.error().kind, ErrorKind::failed);
    EXPECT_NE(output.error().message.find(why), std::string::npos) << output.error().message;
  };
  refused({}, "none is connected");
  KmsTable table = two_screens();
  table.connectors[1].connected = false;
  refused(table, "none is connected");
  table = two_screens();
  table.connectors[1].modes.clear();
  refused(table, "no mode");
  table = two_screens();
  table.connectors[1].encoder_controllers = {0b100};  // a third controller, which is not there
  refused(table, "no display controller");
  table.controllers.clear();
  refused(table, "no display controller");
}

TEST(KmsScreen, ShowsPicturesOnARealScreen) {
  const auto screen = KmsScreen::open();
  if (!screen.ok()) GTEST_SKIP() << screen.error().message;
  EXPECT_GT((*screen)->size().first, 0);
  for (int i = 0; i < 3; ++i) EXPECT_TRUE((*screen)->show());
}

}  // namespace
}  // namespace lightwell::render
