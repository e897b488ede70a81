// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// The libcamera source on vimc, whose picture is colour bars through a simulated image processor.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "daemon/capture/capture_source.h"
#include "daemon/capture/list_libcamera.h"
#include "tests/support/eventually.h"
#include "tests/support/resident_memory.h"

namespace lightwell::test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

class LibcameraOnVimc : public testing::Test {
 protected:
  void SetUp() override {
    static const auto cameras = list_libcamera();  // once: to look takes an emulated machine a second
    if (cameras.empty())
      GTEST_SKIP() << "libcamera sees no camera: run in the virtual machine, in a build with libcamera";
    camera_ = cameras.front();
  }
  static CaptureOptions small() {
    CaptureOptions options;
    options.width = 192;  // vimc scales by three and wants multiples of six
    options.height = 120;
    options.exposure_us = 1000;
    return options;
  }
  void begin(const std::string& id, const CaptureOptions& options) {
    source_.reset();
    auto made = make_capture_source("libcamera:" + id, options);
    ASSERT_TRUE(made.ok()) << made.error().message;
    source_ = std::move(made).value();
    ASSERT_TRUE(source_->start());
  }
  FrameLease next() {
    FrameLease lease;
    eventually([&] { return static_cast<bool>(lease = source_->wait(200ms)); });
    return lease;
  }
  bool says(const std::string& words) {
    return eventually([&] { return source_->describe().find(words) != std::string::npos; });
  }

  LibcameraDescription camera_;
  std::unique_ptr<CaptureSource> source_;
};

TEST_F(LibcameraOnVimc, ColourStreamIsTheMosaicOfItsBars) {
  begin(camera_.id, small());
  const FrameLease lease = next();
  ASSERT_TRUE(lease) << source_->describe();
  ASSERT_EQ(lease.info().format, (FrameFormat{192, 120, PixelFormat::bayer_rg8}));
  // Bars are even from top to bottom: a column repeats itself two rows on, and bars differ from one another.
  const auto at = [&](int x, int y) { return lease.bytes()[static_cast<std::size_t>(y * 192 + x)]; };
  int equal = 0, different = 0;
  for (int x = 0; x < 192; ++x) {
    equal += at(x, 10) == at(x, 12) ? 1 : 0;
    if (x >= 2) different += at(x, 10) != at(x - 2, 10) ? 1 : 0;
  }
  EXPECT_GT(equal, 170);    // but for the edges of bars, where the processor interpolates
  EXPECT_GE(different, 6);  // eight bars
  EXPECT_TRUE(says("a processed stream")) << source_->describe();
  std::printf("%s\n", source_->describe().c_str());
}

TEST_F(LibcameraOnVimc, MissingCameraIsNoDeviceAndNamesThoseThereAre) {
  begin("nobody", small());
  EXPECT_TRUE(says("libcamera sees " + camera_.id)) << source_->describe();
  EXPECT_EQ(source_->state(), SourceState::no_device);
}

TEST_F(LibcameraOnVimc, CameraInUseSaysSoAndIsTakenWhenItIsFree) {
  begin(camera_.id, small());
  ASSERT_TRUE(next());
  auto other = std::move(source_);
  begin(camera_.id, small());
  EXPECT_TRUE(says("another program is using it")) << source_->describe();
  other->stop();
  EXPECT_TRUE(next()) << source_->describe();
}

TEST_F(LibcameraOnVimc, WhatTheCameraLacksIsOneLine) {
  CaptureOptions options = small();
  options.pixel_format = "Mono12";
  begin(camera_.id, options);
  EXPECT_TRUE(says("pixel_format Mono12 is not offered; it offers")) << source_->describe();
  EXPECT_EQ(source_->state(), SourceState::wrong_format);
  options = small();
  options.controls = "Nonsense=1";
  begin(camera_.id, options);
  EXPECT_TRUE(says("control \"Nonsense=1\": Name=value is expected")) << source_->describe();
  options = small();
  options.controls = "Brightness=7.5";
  begin(camera_.id, options);
  EXPECT_TRUE(says("control Brightness=7.5: the camera allows")) << source_->describe();
  options.controls = "Brightness=0.5";
  begin(camera_.id, options);
  EXPECT_TRUE(next()) << source_->describe();
}

TEST_F(LibcameraOnVimc, CameraLostAndBackIsFoundAgain) {
  begin(camera_.id, small());
  const FrameLease held = next();
  ASSERT_TRUE(held);
  const std::vector<std::byte> bytes(held.bytes().begin(), held.bytes().end());
  std::ofstream("/sys/bus/platform/drivers/vimc/unbind") << "vimc.0" << std::flush;
  EXPECT_TRUE(eventually([&] {
    static_cast<void>(source_->wait(0ms));
    return source_->state() == SourceState::no_device;
  })) << source_->describe();
  std::ofstream("/sys/bus/platform/drivers/vimc/bind") << "vimc.0" << std::flush;
  const auto back = std::chrono::steady_clock::now();
  EXPECT_TRUE(next()) << source_->describe();
  std::printf("frames %ld ms after the camera was back\n",
              static_cast<long>(std::chrono::duration_cast<std::chrono::milliseconds>(
                                    std::chrono::steady_clock::now() - back)
                                    .count()));
  EXPECT_EQ(source_->counters().reconnects, 1U);
  EXPECT_TRUE(std::equal(bytes.begin(), bytes.end(), held.bytes().begin(), held.bytes().end()));
}

// Of the processes this one has started, those that own libcamera.
std::vector<pid_t> libcamera_processes() {
  std::vector<pid_t> list;
  for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
    std::string line;
    std::getline(std::ifstream(entry.path() / "stat"), line);
    int parent = 0;
    char state = 0;
    const std::size_t end = line.rfind(')');
    if (end == std::string::npos || line.find("(lightwell-libca") == std::string::npos) continue;
    if (std::sscanf(&line[end], ") %c %d", &state, &parent) == 2 && parent == ::getpid() && state != 'Z')
      list.push_back(std::stoi(entry.path().filename().string()));
  }
  return list;
}

TEST_F(LibcameraOnVimc, ProcessThatDiesIsStartedAgain) {
  begin(camera_.id, small());
  const FrameLease held = next();
  ASSERT_TRUE(held);
  const std::vector<std::byte> bytes(held.bytes().begin(), held.bytes().end());
  ASSERT_EQ(libcamera_processes().size(), 1U);
  ::kill(libcamera_processes().front(), SIGABRT);
  EXPECT_TRUE(says("libcamera's process ended by signal 6")) << source_->describe();
  EXPECT_TRUE(eventually([&] { return source_->wait(100ms) && source_->counters().reconnects == 1; }))
      << source_->describe();
  EXPECT_TRUE(std::equal(bytes.begin(), bytes.end(), held.bytes().begin(), held.bytes().end()));
  source_->stop();
  EXPECT_TRUE(eventually([] { return libcamera_processes().empty(); }));
}

TEST_F(LibcameraOnVimc, LossesLeaveNothingBehind) {
  begin(camera_.id, small());
  ASSERT_TRUE(next());
  const auto lose_and_find = [&] {
    std::ofstream("/sys/bus/platform/drivers/vimc/unbind") << "vimc.0" << std::flush;
    EXPECT_TRUE(eventually([&] {
      static_cast<void>(source_->wait(0ms));
      return source_->state() == SourceState::no_device;
    })) << source_->describe();
    std::ofstream("/sys/bus/platform/drivers/vimc/bind") << "vimc.0" << std::flush;
    EXPECT_TRUE(next()) << source_->describe();
  };
  const auto descriptors = [] {
    return std::distance(std::filesystem::directory_iterator("/proc/self/fd"),
                         std::filesystem::directory_iterator());
  };
  lose_and_find();  // what is made once is made
  const double before = resident_bytes();
  const auto open_before = descriptors();
  for (int i = 0; i < 3; ++i) {
    lose_and_find();
    std::printf("%.2f MB more after %d losses\n", (resident_bytes() - before) * 1e-6, i + 1);
  }
  EXPECT_LT(resident_bytes() - before, 2e6);  // a manager left behind would be megabytes, each time
  EXPECT_EQ(descriptors(), open_before);
  EXPECT_EQ(libcamera_processes().size(), 1U);
}

}  // namespace
}  // namespace lightwell::test
