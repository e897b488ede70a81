// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// `lightwell devices` where there are some.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "daemon/capture/list_libcamera.h"
#include "tests/support/child_process.h"

namespace lightwell::test {
namespace {

using testing::HasSubstr;

TEST(DevicesCommand, ListsCamerasWithFormatsSizesRatesAndControls) {
  if (!std::filesystem::exists("/dev/video10"))
    GTEST_SKIP() << "there is no /dev/video10: run in the virtual machine";
  const ProcessResult result =
      run_process(LIGHTWELL_BIN_DIR "/lightwell", {"devices", "--json", "--timeout", "0.1"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto devices = nlohmann::json::parse(result.out).at("devices");
  const auto at = std::find_if(devices.begin(), devices.end(),
                               [](const auto& d) { return d.at("source") == "v4l2:/dev/video10"; });
  ASSERT_NE(at, devices.end()) << result.out;
  EXPECT_EQ(at->at("driver"), "vivid");
  const auto& formats = at->at("formats");
  const auto grey =
      std::find_if(formats.begin(), formats.end(), [](const auto& f) { return f.at("fourcc") == "Y16"; });
  ASSERT_NE(grey, formats.end());
  EXPECT_EQ(grey->at("pixel_format"), "Mono16");
  EXPECT_GT(grey->at("sizes").size(), 1U);
  EXPECT_GT(grey->at("sizes")[0].at("rate_range_hz")[1].get<double>(), 0);
  const auto& controls = at->at("controls");
  const auto gain =
      std::find_if(controls.begin(), controls.end(), [](const auto& c) { return c.at("name") == "gain"; });
  ASSERT_NE(gain, controls.end());
  EXPECT_EQ(gain->at("range"), nlohmann::json::array({0, 255}));
  for (const auto& camera : list_libcamera())
    EXPECT_TRUE(std::any_of(devices.begin(), devices.end(),
                            [&](const auto& d) { return d.at("source") == "libcamera:" + camera.id; }));

  const ProcessResult words = run_process(LIGHTWELL_BIN_DIR "/lightwell", {"devices", "--timeout", "0.1"});
  EXPECT_EQ(words.exit_code, 0);
  EXPECT_THAT(words.out, HasSubstr("v4l2:/dev/video10  vivid, driver vivid"));
  EXPECT_THAT(words.out, HasSubstr("format Y16, read as Mono16: 320×180 at"));
  EXPECT_THAT(words.out, HasSubstr("control gain = "));
}

}  // namespace
}  // namespace lightwell::test
