// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "daemon/capture/v4l2_source.h"
#include "tests/support/eventually.h"
#include "tests/support/fake_v4l2.h"

namespace lightwell::test {

// A V4L2 source on the fake driver.
class V4l2SourceTest : public testing::Test {
 protected:
  void begin(FakeV4l2Model model = {}, const CaptureOptions& options = {}) {
    source_.reset();  // before its device
    device_ = std::make_unique<FakeV4l2>(std::move(model));
    source_ = make_v4l2_source(FakeV4l2::kPath, options, *device_);
    ASSERT_TRUE(source_->start());
  }
  void begin(const CaptureOptions& options) { begin(FakeV4l2Model(), options); }
  // The stream is up: a frame can be delivered.
  bool deliver(std::uint32_t flags = 0, std::uint32_t lost = 0, std::ptrdiff_t bytes = -1) {
    return eventually([&] { return device_->deliver(flags, lost, bytes); });
  }
  FrameLease next() {
    FrameLease lease;
    eventually([&] { return static_cast<bool>(lease = source_->wait(std::chrono::milliseconds(100))); });
    return lease;
  }
  bool state_becomes(SourceState state) {
    return eventually([&] { return source_->state() == state; });
  }
  bool says(const std::string& words) {
    return eventually([&] { return source_->describe().find(words) != std::string::npos; });
  }
  // The words with which the source refuses to begin.
  std::string refusal(SourceState state) {
    EXPECT_TRUE(eventually([&] { return source_->describe().starts_with(FakeV4l2::kPath); }));
    EXPECT_EQ(source_->state(), state) << source_->describe();
    return source_->describe();
  }

  std::unique_ptr<FakeV4l2> device_;
  std::unique_ptr<CaptureSource> source_;
};

}  // namespace lightwell::test
