// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// The process that owns libcamera, on a machine that may have no camera; with one: tests/hardware.
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <memory>

#include "daemon/capture/capture_source.h"
#include "daemon/capture/libcamera_process.h"
#include "tests/support/eventually.h"

namespace lightwell::test {
namespace {

using namespace std::chrono_literals;

class LibcameraProcesses : public testing::Test {
 protected:
  void SetUp() override {
    if (::access(libcamera_program().c_str(), X_OK) != 0) GTEST_SKIP() << "a build without libcamera";
  }
};

TEST_F(LibcameraProcesses, CameraThatIsNotThereIsNoDeviceInWords) {
  const auto source = std::move(make_capture_source("libcamera:nobody", {})).value();
  ASSERT_TRUE(source->start());
  EXPECT_TRUE(eventually([&] { return source->describe().find("libcamera sees") != std::string::npos; }))
      << source->describe();
  EXPECT_EQ(source->state(), SourceState::no_device);
  EXPECT_FALSE(source->wait(10ms));
  source->stop();
}

TEST_F(LibcameraProcesses, ProcessWithNothingToDoSaysHowItEnded) {
  LibcameraProcess process;
  ASSERT_TRUE(process.start("no JSON"));
  char byte = 0;
  EXPECT_EQ(::read(process.socket(), &byte, 1), 0);  // it hangs up
  EXPECT_EQ(process.how_it_ended(), "ended with status 1");
  process.end(0ms);
  EXPECT_EQ(process.socket(), -1);
}

}  // namespace
}  // namespace lightwell::test
