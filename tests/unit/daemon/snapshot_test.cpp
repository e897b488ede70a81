// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/pipeline/snapshot.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <thread>
#include <vector>

#include "daemon/pipeline/latency.h"

namespace lightwell {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

Snapshot prototype() {
  Snapshot snapshot;
  snapshot.map = PolarMap::make({3, 4}, 1);
  snapshot.lights.reserve(8);
  return snapshot;
}

void publish(SnapshotChannel& channel, std::uint64_t number) {
  Snapshot& snapshot = channel.begin_write();
  snapshot.number = number;
  snapshot.sequence = number * 10;
  channel.end_write();
}

TEST(SnapshotChannel, NothingPublishedGivesAnEmptyLease) {
  SnapshotChannel channel(prototype());
  EXPECT_FALSE(channel.wait_newer(0, milliseconds(0)));
}

TEST(SnapshotChannel, ReaderGetsTheNewestAndOnlyIfNewer) {
  SnapshotChannel channel(prototype());
  publish(channel, 1);
  publish(channel, 2);
  EXPECT_EQ(channel.wait_newer(0, milliseconds(0))->number, 2u);
  EXPECT_FALSE(channel.wait_newer(2, milliseconds(0)));
}

TEST(SnapshotChannel, AHeldSnapshotIsNeverWrittenTo) {
  SnapshotChannel channel(prototype());
  publish(channel, 1);
  std::vector<SnapshotChannel::Lease> held;
  for (std::uint64_t n = 1; n <= SnapshotChannel::kMaxReaders; ++n) {
    held.push_back(channel.wait_newer(0, milliseconds(0)));
    publish(channel, n + 1);
  }
  for (std::uint64_t n = 100; n < 200; ++n) publish(channel, n);
  for (std::size_t i = 0; i < held.size(); ++i) EXPECT_EQ(held[i]->number, i + 1);
}

TEST(SnapshotChannel, CloseWakesAWaitingReader) {
  SnapshotChannel channel(prototype());
  std::thread reader([&] { EXPECT_FALSE(channel.wait_newer(0, seconds(60))); });
  channel.close();
  reader.join();
}

TEST(SnapshotChannel, ConcurrentReadersSeeWholeSnapshotsInOrder) {
  SnapshotChannel channel(prototype());
  constexpr std::uint64_t kLast = 20000;
  std::vector<std::thread> readers;
  for (std::size_t i = 0; i < SnapshotChannel::kMaxReaders; ++i)
    readers.emplace_back([&] {
      std::uint64_t last = 0;
      while (last < kLast) {
        const auto lease = channel.wait_newer(last, seconds(60));
        ASSERT_TRUE(lease);
        ASSERT_GT(lease->number, last);
        ASSERT_EQ(lease->sequence, lease->number * 10);
        last = lease->number;
      }
    });
  for (std::uint64_t n = 1; n <= kLast; ++n) publish(channel, n);
  for (std::thread& reader : readers) reader.join();
}

TEST(LatencyWindow, QuantilesAreNearestRankOverTheLastValues) {
  LatencyWindow window;
  EXPECT_TRUE(std::isnan(window.quantiles().p50));
  window.add(7);
  EXPECT_EQ(window.quantiles().p99, 7);
  for (int i = 0; i < 5000; ++i) window.add(1e6);
  for (int i = 1; i <= 1000; ++i) window.add(i);
  EXPECT_EQ(window.quantiles().p50, 500);
  EXPECT_EQ(window.quantiles().p99, 990);
}

}  // namespace
}  // namespace lightwell
