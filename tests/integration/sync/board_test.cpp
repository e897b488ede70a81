// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <thread>

#include "daemon/clock.h"
#include "daemon/sync/exposure_stamper.h"
#include "daemon/sync/sync_board.h"
#include "firmware/core/board.h"
#include "tests/support/eventually.h"

namespace lightwell {
namespace {

using std::chrono::milliseconds;
using test::eventually;

constexpr std::uint32_t kTickHz = 84'000'000;
constexpr double kDrift = 40e-6;  // of the board's crystal
constexpr std::int64_t kExposureNs = 4'000'000;
constexpr std::int64_t kCameraDelayNs = 120'000;  // from trigger to strobe

// The firmware's core on a thread, in real time, with a camera that answers each trigger, and the link to its host.
class Hardware {
 public:
  explicit Hardware(bool camera_answers = true) : camera_answers_(camera_answers) {
    facts_.tick_hz = kTickHz;
    facts_.capabilities = SYNC_CAN_TRIGGER | SYNC_CAN_STROBE;
    facts_.serial[0] = 0xabcd;
    facts_.sample_hz = 5000;
    facts_.highest_code = 4095;
    board_init(&board_, &facts_, counter(mono_now_ns()));
    thread_ = std::thread([this] { run(); });
  }
  ~Hardware() {
    over_ = true;
    thread_.join();
  }
  Hardware(const Hardware&) = delete;
  Hardware& operator=(const Hardware&) = delete;

  Result<std::unique_ptr<SyncLink>> open() {
    return std::unique_ptr<SyncLink>(std::make_unique<Link>(*this));
  }
  // When the camera truly exposed for a trigger, middle, by the host's clock.
  std::map<std::uint32_t, std::int64_t> exposures() {
    const std::scoped_lock lock(mutex_);
    return exposures_;
  }

 private:
  class Link final : public SyncLink {
   public:
    explicit Link(Hardware& hardware) : hardware_(hardware) {}
    Result<std::size_t> read(std::span<std::uint8_t> buffer, milliseconds timeout) override {
      for (auto waited = milliseconds(0);; waited += milliseconds(1)) {
        if (const std::size_t size = hardware_.take(buffer); size > 0 || waited >= timeout) return size;
        std::this_thread::sleep_for(milliseconds(1));
      }
    }
    Status write(std::span<const std::uint8_t> bytes) override {
      const std::scoped_lock lock(hardware_.mutex_);
      hardware_.to_board_.insert(hardware_.to_board_.end(), bytes.begin(), bytes.end());
      return {};
    }

   private:
    Hardware& hardware_;
  };

  // Ticks since the start: 84 MHz and a little more.
  [[nodiscard]] double ticks(std::int64_t mono_ns) const {
    return static_cast<double>(mono_ns - start_ns_) * 1e-9 * kTickHz * (1 + kDrift);
  }
  [[nodiscard]] std::uint32_t counter(std::int64_t mono_ns) const {
    return static_cast<std::uint32_t>(static_cast<std::uint64_t>(ticks(mono_ns)));
  }
  // Of a counter near now.
  [[nodiscard]] std::int64_t mono_of(std::uint32_t at, std::int64_t now_ns) const {
    const auto since = static_cast<std::int32_t>(at - counter(now_ns));
    return now_ns + std::llround(since / (1 + kDrift) * 1e9 / kTickHz);
  }

  std::size_t take(std::span<std::uint8_t> buffer) {
    const std::scoped_lock lock(mutex_);
    const std::size_t size = std::min(buffer.size(), to_host_.size());
    for (std::size_t i = 0; i < size; ++i) {
      buffer[i] = to_host_.front();
      to_host_.pop_front();
    }
    return size;
  }

  void run() {
    while (!over_) {
      {
        const std::scoped_lock lock(mutex_);
        step(mono_now_ns());
      }
      std::this_thread::sleep_for(std::chrono::microseconds(200));
    }
  }

  // Edges come when they are due, as the hardware's timer would make and stamp them.
  void step(std::int64_t now_ns) {
    board_poll(&board_, counter(now_ns));
    for (; !to_board_.empty(); to_board_.pop_front())
      board_byte(&board_, 0, to_board_.front(), counter(now_ns));
    if (board_forgets_pulses(&board_)) pulses_.clear();
    for (std::uint32_t rise = 0, fall = 0; board_take_pulse(&board_, &rise, &fall);)
      pulses_.push_back({rise, mono_of(rise, now_ns)});
    while (!pulses_.empty() && pulses_.front().mono_ns <= now_ns) {
      board_pulse_done(&board_, true);
      const std::int64_t begin = pulses_.front().mono_ns + kCameraDelayNs;
      if (camera_answers_) edges_.push_back({begin, false}), edges_.push_back({begin + kExposureNs, true});
      exposures_.emplace(triggers_++, begin + kExposureNs / 2);
      pulses_.pop_front();
    }
    while (!edges_.empty() && edges_.front().mono_ns <= now_ns) {
      board_edge(&board_, edges_.front().falls ? BOARD_STROBE_FALL : BOARD_STROBE_RISE,
                 counter(edges_.front().mono_ns));
      edges_.pop_front();
    }
    for (std::uint8_t byte = 0; outbox_take(&board_.out, &byte);) to_host_.push_back(byte);
  }

  struct Pulse {
    std::uint32_t rise;
    std::int64_t mono_ns;
  };
  struct Edge {
    std::int64_t mono_ns;
    bool falls;
  };
  bool camera_answers_;
  board_facts facts_{};
  board board_{};
  std::int64_t start_ns_ = mono_now_ns();
  std::mutex mutex_;
  std::deque<std::uint8_t> to_host_, to_board_;
  std::deque<Pulse> pulses_;
  std::deque<Edge> edges_;
  std::map<std::uint32_t, std::int64_t> exposures_;
  std::uint32_t triggers_ = 0;
  std::atomic<bool> over_{false};
  std::thread thread_;
};

class SyncBoardAndFirmware : public ::testing::Test {
 protected:
  static BoardOptions options(Hardware& hardware) {
    BoardOptions options;
    options.open = [&] { return hardware.open(); };
    options.trigger = BoardOptions::Trigger{};
    options.trigger->rate_numerator = 50;
    return options;
  }
  StrobeRing strobes_;
  TimecodeStamper timecodes_;
};

TEST_F(SyncBoardAndFirmware, TheBoardTriggersAsToldAndItsStrobesAreTheExposuresByTheHostsClock) {
  Hardware hardware;
  SyncBoard board(options(hardware), strobes_, timecodes_);
  ASSERT_TRUE(eventually([&] { return board.view().status && board.view().status->strobes > 100; }));
  const BoardView view = board.view();
  EXPECT_EQ(view.state, BoardState::connected);
  EXPECT_EQ(view.hello->serial[0], 0xabcdu);
  EXPECT_EQ(view.configuration->rate_numerator, 50u);
  EXPECT_EQ(view.status->stray_strobes, 0u);
  EXPECT_TRUE(view.refused.empty()) << view.refused;
  // The bound goes up and down: fast exchanges come, and recede into the past.
  const std::int64_t begin_ns = mono_now_ns();
  double bound_us = view.clock_bound_us;
  for (int i = 0; i < 120; ++i) {
    std::this_thread::sleep_for(milliseconds(10));
    bound_us = std::max(bound_us, board.view().clock_bound_us);
  }
  const auto exposures = hardware.exposures();
  const std::int64_t end_ns = mono_now_ns();
  int compared = 0;
  for (std::int64_t at_ns = end_ns; at_ns > end_ns - 1'000'000'000; at_ns -= 20'000'000) {
    const auto strobe = strobes_.newest_before(at_ns);
    if (!strobe || strobe->begin_mono_ns < begin_ns || exposures.count(strobe->trigger) == 0) continue;
    const std::int64_t off = strobe->middle_mono_ns() - exposures.at(strobe->trigger);
    // 500 ppm for the fifth of a second between fits is what the slope may be off as well.
    EXPECT_LE(std::abs(static_cast<double>(off)) * 1e-3, bound_us + 100) << strobe->trigger;
    ++compared;
  }
  EXPECT_GT(compared, 30);
}

TEST_F(SyncBoardAndFirmware, FramesOfACameraAreStampedWithTheirExposure) {
  Hardware hardware;
  SyncBoard board(options(hardware), strobes_, timecodes_);
  ExposureStamper stamper(strobes_);
  ASSERT_TRUE(eventually([&] { return !strobes_.empty(); }));
  int stamped = 0;
  std::uint32_t last = 0;
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(10);
  // A frame is whole in memory 8 ms after its exposure.
  while (stamped < 50 && std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(milliseconds(2));
    const auto exposures = hardware.exposures();
    const std::int64_t now_ns = mono_now_ns();
    for (const auto& [n, middle_ns] : exposures) {
      const std::int64_t received_ns = middle_ns + kExposureNs / 2 + 8'000'000;
      if (n <= last || received_ns > now_ns) continue;
      last = n;
      FrameInfo info;
      info.sequence = n;
      info.received_mono_ns = received_ns;
      info.capture_mono_ns = received_ns - 10'000'000;
      if (!stamper.stamp(info)) continue;
      ++stamped;
      // A millisecond: this thread may be held up, and the map is young; another exposure is 20 ms away.
      EXPECT_NEAR(static_cast<double>(info.capture_mono_ns - middle_ns) * 1e-6, 0, 1) << n;
    }
  }
  EXPECT_GE(stamped, 50);
}

TEST_F(SyncBoardAndFirmware, ACameraThatDoesNotAnswerIsCounted) {
  Hardware hardware(false);
  SyncBoard board(options(hardware), strobes_, timecodes_);
  EXPECT_TRUE(
      eventually([&] { return board.view().status && board.view().status->unanswered_triggers > 20; }));
  EXPECT_TRUE(strobes_.empty());
}

TEST_F(SyncBoardAndFirmware, WhatTheFirmwareRefusesIsNamedWithItsLimits) {
  Hardware hardware;
  BoardOptions wrong = options(hardware);
  wrong.trigger->rate_numerator = 100'000;
  SyncBoard board(wrong, strobes_, timecodes_);
  ASSERT_TRUE(eventually([&] { return !board.view().refused.empty(); }));
  EXPECT_NE(board.view().refused.find("rate"), std::string::npos) << board.view().refused;
  EXPECT_NE(board.view().refused.find("allowed"), std::string::npos) << board.view().refused;
}

}  // namespace
}  // namespace lightwell
