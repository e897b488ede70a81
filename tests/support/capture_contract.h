// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "daemon/capture/capture_source.h"
#include "daemon/clock.h"
#include "tests/support/allocation_counter.h"
#include "tests/support/eventually.h"

// What every capture source keeps (daemon/capture/capture_source.h), as one suite. A source joins with one
// line,
//
//   INSTANTIATE_TYPED_TEST_SUITE_P(Aravis, CaptureContract, AravisSubject);
//
// where the subject gives the sources to test:
//
//   struct Subject {
//     std::string missing();                          // why it cannot be tested here, empty where it can
//     std::unique_ptr<CaptureSource> make();          // some 100 frames a second for at least ten seconds
//     std::unique_ptr<CaptureSource> make_silent();   // no frame, at least for a minute
//   };

namespace lightwell::test {

template <class Subject>
class CaptureContract : public testing::Test {
 protected:
  using Milliseconds = std::chrono::milliseconds;

  void SetUp() override {
    if (const std::string why = subject_.missing(); !why.empty()) GTEST_SKIP() << why;
    source_ = subject_.make();
    ASSERT_NE(source_, nullptr);
  }
  void start() { ASSERT_TRUE(source_->start()); }
  // The next frame, however long it takes to connect.
  FrameLease next() {
    FrameLease lease;
    eventually([&] { return static_cast<bool>(lease = source_->wait(Milliseconds(200))); });
    if (lease) ++delivered_;
    return lease;
  }
  static std::vector<std::byte> copy(const FrameLease& lease) {
    return {lease.bytes().begin(), lease.bytes().end()};
  }
  static bool equal(const FrameLease& lease, const std::vector<std::byte>& bytes) {
    return std::equal(lease.bytes().begin(), lease.bytes().end(), bytes.begin(), bytes.end());
  }

  Subject subject_;
  std::unique_ptr<CaptureSource> source_;
  std::uint64_t delivered_ = 0;
};

TYPED_TEST_SUITE_P(CaptureContract);

TYPED_TEST_P(CaptureContract, SequenceAndTimesIncreaseAndLieInThePast) {
  this->start();
  FrameInfo last;
  for (int i = 0; i < 30; ++i) {
    const FrameLease lease = this->next();
    ASSERT_TRUE(lease) << this->source_->describe();
    const FrameInfo& info = lease.info();
    if (i > 0) {
      EXPECT_GT(info.sequence, last.sequence);
      EXPECT_GT(info.capture_mono_ns, last.capture_mono_ns);
      EXPECT_GT(info.received_mono_ns, last.received_mono_ns);
    }
    EXPECT_LE(info.capture_mono_ns, info.received_mono_ns);
    EXPECT_LE(info.received_mono_ns, mono_now_ns());
    EXPECT_GT(info.capture_utc_ns, 0);
    EXPECT_LE(info.capture_utc_ns, utc_now_ns());
    last = info;
  }
}

TYPED_TEST_P(CaptureContract, EveryFrameIsWholeAndOfItsFormatsSize) {
  this->start();
  for (int i = 0; i < 10; ++i) {
    const FrameLease lease = this->next();
    ASSERT_TRUE(lease) << this->source_->describe();
    EXPECT_TRUE(lease.info().complete);
    EXPECT_GT(lease.info().format.width, 0);
    EXPECT_GT(lease.info().format.height, 0);
    EXPECT_EQ(lease.bytes().size(), lease.info().format.bytes());
    EXPECT_GT(lease.info().exposure_us, 0);
  }
  EXPECT_EQ(this->source_->state(), SourceState::streaming);
  EXPECT_GT(this->source_->rate_hz(), 0);
  EXPECT_FALSE(this->source_->describe().empty());
}

TYPED_TEST_P(CaptureContract, HeldLeaseKeepsItsBytesAndDoesNotStopTheStream) {
  this->start();
  const FrameLease held = this->next();
  ASSERT_TRUE(held) << this->source_->describe();
  const auto bytes = this->copy(held);
  // Several times around the pool.
  for (int i = 0; i < 40; ++i) {
    const FrameLease lease = this->next();
    ASSERT_TRUE(lease) << i;
    ASSERT_NE(lease.bytes().data(), held.bytes().data());
    ASSERT_GT(lease.info().sequence, held.info().sequence);
  }
  EXPECT_TRUE(this->equal(held, bytes));
}

TYPED_TEST_P(CaptureContract, SlowConsumerGetsTheFreshestFrameAndTheOthersCountAsSkipped) {
  this->start();
  const std::uint64_t first = [&] {
    const FrameLease lease = this->next();
    EXPECT_TRUE(lease) << this->source_->describe();
    return lease.info().sequence;
  }();
  const CaptureCounters before = this->source_->counters();
  // More frames than the pool has buffers arrive meanwhile.
  constexpr std::uint64_t kMissed = 30;
  ASSERT_TRUE(eventually([&] { return this->source_->counters().received >= before.received + kMissed; }));
  const FrameLease lease = this->next();
  ASSERT_TRUE(lease);
  EXPECT_GE(lease.info().sequence, first + kMissed);
  EXPECT_GE(this->source_->counters().skipped, before.skipped + kMissed - 1);
}

TYPED_TEST_P(CaptureContract, CountersAddUp) {
  this->start();
  for (int i = 0; i < 20; ++i) {
    ASSERT_TRUE(this->next());
    if (i % 5 != 0) continue;
    const std::uint64_t received = this->source_->counters().received;
    ASSERT_TRUE(eventually([&] { return this->source_->counters().received > received + 2; }));
  }
  this->source_->stop();
  const CaptureCounters c = this->source_->counters();
  EXPECT_EQ(c.received, this->delivered_ + c.skipped);
  EXPECT_EQ(c.reconnects, 0U);
}

TYPED_TEST_P(CaptureContract, WaitIsEmptyAndEndsWhereNothingArrives) {
  this->source_ = this->subject_.make_silent();
  ASSERT_NE(this->source_, nullptr);
  this->start();
  EXPECT_FALSE(this->source_->wait(std::chrono::milliseconds(0)));
  for (int i = 0; i < 5; ++i) EXPECT_FALSE(this->source_->wait(std::chrono::milliseconds(20)));
  EXPECT_EQ(this->source_->counters().received, 0U);
}

TYPED_TEST_P(CaptureContract, StopsTwiceBeforeAndAfterStartAndWaitsEmptyThen) {
  this->source_->stop();
  this->start();
  ASSERT_TRUE(this->next()) << this->source_->describe();
  this->source_->stop();
  this->source_->stop();
  EXPECT_FALSE(this->source_->wait(std::chrono::milliseconds(1)));
  EXPECT_NE(this->source_->state(), SourceState::streaming);
}

TYPED_TEST_P(CaptureContract, LeasesOutliveStop) {
  this->start();
  FrameLease first = this->next();
  FrameLease second = this->next();
  ASSERT_TRUE(first && second) << this->source_->describe();
  const auto first_bytes = this->copy(first), second_bytes = this->copy(second);
  this->source_->stop();
  EXPECT_TRUE(this->equal(first, first_bytes));
  EXPECT_TRUE(this->equal(second, second_bytes));
  first = FrameLease();
  EXPECT_TRUE(this->equal(second, second_bytes));
}

TYPED_TEST_P(CaptureContract, WaitAndTheEndOfALeaseAllocateNothing) {
  this->start();
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(this->next()) << this->source_->describe();
  std::uint64_t allocations = 0;
  for (int taken = 0; taken < 100;) {
    const AllocationCounter counter;
    if (const FrameLease lease = this->source_->wait(std::chrono::milliseconds(200))) ++taken;
    allocations += counter.count();
    ASSERT_NE(this->source_->state(), SourceState::ended);
  }
  EXPECT_EQ(allocations, 0U);
}

REGISTER_TYPED_TEST_SUITE_P(CaptureContract, SequenceAndTimesIncreaseAndLieInThePast,
                            EveryFrameIsWholeAndOfItsFormatsSize,
                            HeldLeaseKeepsItsBytesAndDoesNotStopTheStream,
                            SlowConsumerGetsTheFreshestFrameAndTheOthersCountAsSkipped, CountersAddUp,
                            WaitIsEmptyAndEndsWhereNothingArrives,
                            StopsTwiceBeforeAndAfterStartAndWaitsEmptyThen, LeasesOutliveStop,
                            WaitAndTheEndOfALeaseAllocateNothing);

}  // namespace lightwell::test
