// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/pipeline/pipeline.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <cstring>
#include <deque>
#include <limits>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "daemon/clock.h"
#include "tests/support/eventually.h"

namespace lightwell {
namespace {

using std::chrono::milliseconds;
using test::eventually;

constexpr FrameFormat kFormat{64, 64, PixelFormat::mono12};

Calibration calibration_for(int size) {
  Calibration calibration;
  calibration.response.model = LogResponse{1000, 150, 0};
  calibration.lens.image_size = {size, size};
  calibration.lens.center = {(size - 1) / 2.0, (size - 1) / 2.0};
  calibration.lens.focal = {size / 2 / (kPi / 2), size / 2 / (kPi / 2)};
  calibration.id = "0123456789abcdef";
  return calibration;
}

FramePathOptions small_options() {
  FramePathOptions options;
  options.radiometer.grid = {10, 40, kPi / 2};
  options.lights.count = 30;
  options.lights.clusters = 10;
  return options;
}

// Gives the frames it is handed, in order; the test decides when.
class HandFedSource final : public CaptureSource {
 public:
  Status start() override { return {}; }
  // Between the two, wait does not return.
  void hold() {
    held_ = true;
    while (!waiting_) std::this_thread::yield();
  }
  void go_on() { held_ = false; }
  FrameLease wait(milliseconds timeout) noexcept override {
    while (held_) {
      waiting_ = true;
      std::this_thread::yield();
    }
    waiting_ = false;
    const std::int64_t end_ns = mono_now_ns() + timeout.count() * 1'000'000;
    do {
      const std::scoped_lock lock(mutex_);
      if (!frames_.empty()) {
        auto* frame = frames_.front();
        frames_.pop_front();
        return {frame->info, frame->codes,
                [](void*, void* token) noexcept { static_cast<Frame*>(token)->free = true; }, this, frame};
      }
      std::this_thread::yield();
    } while (mono_now_ns() < end_ns);
    return {};
  }
  void stop() noexcept override {
    while (dead) std::this_thread::yield();
    stopped = true;
  }
  [[nodiscard]] SourceState state() const noexcept override { return SourceState::streaming; }
  [[nodiscard]] std::string describe() const override { return "hand-fed"; }
  [[nodiscard]] CaptureCounters counters() const noexcept override { return {}; }
  [[nodiscard]] double rate_hz() const noexcept override { return 60; }

  struct Frame {
    FrameInfo info;
    std::vector<std::byte> codes;
    std::atomic<bool> free{false};
  };
  Frame* give(const FrameFormat& format, std::uint16_t code, double exposure_us = 10000) {
    auto frame = std::make_unique<Frame>();
    frame->codes.resize(format.bytes());
    for (std::size_t i = 0; i + 1 < frame->codes.size(); i += 2) std::memcpy(&frame->codes[i], &code, 2);
    frame->info.format = format;
    frame->info.sequence = ++sequence_;
    frame->info.exposure_us = exposure_us;
    frame->info.capture_mono_ns = frame->info.received_mono_ns = mono_now_ns();
    const std::scoped_lock lock(mutex_);
    owned_.push_back(std::move(frame));
    frames_.push_back(owned_.back().get());
    return owned_.back().get();
  }
  std::atomic<bool> stopped{false};
  std::atomic<bool> dead{false};  // stop does not return until it is false

 private:
  std::atomic<bool> held_{false}, waiting_{false};
  std::mutex mutex_;
  std::deque<Frame*> frames_;
  std::vector<std::unique_ptr<Frame>> owned_;
  std::uint64_t sequence_ = 0;
};

struct CountingSink final : FrameSink {
  void offer(const FrameInfo& info, std::span<const std::byte>) noexcept override {
    last_sequence = info.sequence;
  }
  std::atomic<std::uint64_t> last_sequence{0};
};

class PipelineTest : public testing::Test {
 protected:
  std::shared_ptr<FramePath> path(int size, const char* method = "live") {
    FramePathOptions options = small_options();
    options.method = method;
    return std::make_shared<FramePath>(calibration_for(size), options, snapshots_);
  }
  SnapshotChannel::Lease published(std::uint64_t after) {
    return snapshots_.wait_newer(after, std::chrono::seconds(20));
  }

  SnapshotChannel snapshots_{FramePath::prototype(small_options())};
  CountingSink sink_;
  std::shared_ptr<HandFedSource> source_ = std::make_shared<HandFedSource>();
  Pipeline pipeline_{&sink_};
};

TEST_F(PipelineTest, AUniformSceneBecomesLightsOfItsWholeIlluminance) {
  ASSERT_TRUE(pipeline_.start(source_, path(64)));
  source_->give(kFormat, 1691);  // exp(691/150) = 100.1 cd/m²
  const auto snapshot = published(0);
  ASSERT_TRUE(snapshot);
  const double radiance = std::exp(691.0 / 150);
  // The hemisphere's 2π sr; 5e-4 is the kernel's stated error, the rest float sums.
  EXPECT_NEAR(snapshot->measured_illuminance[0], radiance * 2 * kPi, 1e-3 * radiance * 2 * kPi);
  Rgb sum = Rgb::Zero();
  for (const DirectionalLight& light : snapshot->lights) sum += light.illuminance;
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(sum[c], snapshot->total_illuminance[c], 1e-4 * sum[c]);
  EXPECT_EQ(snapshot->sequence, 1u);
  EXPECT_STREQ(snapshot->calibration_id.data(), "0123456789abcdef");
  EXPECT_LE(snapshot->lights.size(), 10u);
  EXPECT_LE(snapshot->received_mono_ns, snapshot->publish_mono_ns);
}

TEST_F(PipelineTest, TheSinkSeesEveryFrameAndBuffersGoBack) {
  ASSERT_TRUE(pipeline_.start(source_, path(64)));
  for (std::uint64_t i = 1; i <= 20; ++i) {
    const auto* frame = source_->give(kFormat, 1500);
    ASSERT_TRUE(published(i - 1));
    EXPECT_TRUE(eventually([&] { return frame->free.load(); }));
    EXPECT_EQ(sink_.last_sequence, i);
  }
}

TEST_F(PipelineTest, FramesOfAnotherSizeAreSaidAndSurvived) {
  ASSERT_TRUE(pipeline_.start(source_, path(64)));
  source_->give({32, 32, PixelFormat::mono12}, 1500);
  EXPECT_TRUE(eventually([&] { return !pipeline_.view().mismatch.empty(); }));
  EXPECT_NE(pipeline_.view().mismatch.find("32"), std::string::npos) << pipeline_.view().mismatch;
  EXPECT_TRUE(eventually([&] { return pipeline_.view().dropped == 1; }));
  source_->give(kFormat, 1500);
  ASSERT_TRUE(published(0));
  EXPECT_TRUE(eventually([&] { return pipeline_.view().mismatch.empty(); }));
}

TEST_F(PipelineTest, ReplacementGoesOnCountingAndStopsTheOldSource) {
  ASSERT_TRUE(pipeline_.start(source_, path(64)));
  source_->give(kFormat, 1500);
  EXPECT_EQ(published(0)->method, "live");
  auto second = std::make_shared<HandFedSource>();
  ASSERT_TRUE(pipeline_.replace(second, path(32, "other")));
  second->give({32, 32, PixelFormat::mono12}, 1500);
  const auto snapshot = published(1);
  ASSERT_TRUE(snapshot);
  EXPECT_EQ(snapshot->number, 2u);
  EXPECT_EQ(snapshot->method, "other");
  EXPECT_TRUE(eventually([&] { return source_->stopped.load(); }));
}

TEST_F(PipelineTest, AReloadMakesItsTablesBeforeAFrameNeedsThem) {
  ASSERT_TRUE(pipeline_.start(source_, path(64)));
  source_->give(kFormat, 1500);
  ASSERT_TRUE(published(0));
  source_->hold();  // no frame comes
  const auto next = path(64, "other");
  EXPECT_FALSE(next->prepared_for(kFormat, 60));
  ASSERT_TRUE(pipeline_.replace(nullptr, next));
  EXPECT_TRUE(next->prepared_for(kFormat, 60));
  source_->go_on();
  source_->give(kFormat, 1500);  // still met by the wait that was held
  ASSERT_TRUE(published(1));
  source_->give(kFormat, 1500);
  const auto snapshot = published(2);
  ASSERT_TRUE(snapshot);
  EXPECT_EQ(snapshot->method, "other");
}

TEST_F(PipelineTest, StoppingStopsASourceThatWasNeverTakenUp) {
  ASSERT_TRUE(pipeline_.start(source_, path(64)));
  auto second = std::make_shared<HandFedSource>();
  source_->hold();
  ASSERT_TRUE(pipeline_.replace(second, path(64)));
  std::thread stopper([&] { pipeline_.stop(); });
  std::this_thread::sleep_for(
      milliseconds(50));  // the frame path ends with its wait; either way both must stop
  source_->go_on();
  stopper.join();
  EXPECT_TRUE(source_->stopped);
  EXPECT_TRUE(second->stopped);
}

TEST_F(PipelineTest, ADeadSourceThatIsReplacedHoldsUpNothing) {
  ASSERT_TRUE(pipeline_.start(source_, path(64)));
  source_->give(kFormat, 1500);
  ASSERT_TRUE(published(0));
  source_->dead = true;
  auto second = std::make_shared<HandFedSource>();
  ASSERT_TRUE(pipeline_.replace(second, path(64)));
  for (std::uint64_t i = 1; i <= 3; ++i) {
    second->give(kFormat, 1500);
    EXPECT_TRUE(published(i));
  }
  const std::uint64_t before = pipeline_.heartbeat();
  EXPECT_TRUE(eventually([&] { return pipeline_.heartbeat() > before + 2; }));
  EXPECT_FALSE(source_->stopped);
  source_->dead = false;
  pipeline_.stop();  // waits for the source that was replaced
  EXPECT_TRUE(source_->stopped);
  EXPECT_TRUE(second->stopped);
}

TEST_F(PipelineTest, AFrameWithoutAnExposureIsSaidAndSurvived) {
  ASSERT_TRUE(pipeline_.start(source_, path(64)));
  std::uint64_t given = 0;
  for (const double exposure_us : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    source_->give(kFormat, 1500, exposure_us);
    ++given;
    EXPECT_TRUE(eventually([&] { return pipeline_.view().dropped == given; })) << exposure_us;
    EXPECT_NE(pipeline_.view().mismatch.find("exposure_us"), std::string::npos) << exposure_us;
  }
  EXPECT_EQ(pipeline_.view().path->published(), 0u);
  source_->give(kFormat, 1500);
  ASSERT_TRUE(published(0));
  EXPECT_TRUE(eventually([&] { return pipeline_.view().mismatch.empty(); }));
}

// Two reloads in a row: the second keeps the source that the first has begun.
TEST_F(PipelineTest, AReplacementThatStillWaitsKeepsItsSource) {
  ASSERT_TRUE(pipeline_.start(source_, path(64)));
  auto second = std::make_shared<HandFedSource>();
  second->give({32, 32, PixelFormat::mono12}, 1500);
  source_->hold();  // the frame path is inside of wait, so that both replacements find it there
  ASSERT_TRUE(pipeline_.replace(second, path(64)));
  ASSERT_TRUE(pipeline_.replace(nullptr, path(32)));
  source_->go_on();
  ASSERT_TRUE(published(0));
  EXPECT_TRUE(eventually([&] { return source_->stopped.load(); }));
  EXPECT_EQ(pipeline_.view().source, second);
}

TEST_F(PipelineTest, HeartbeatTurnsWithoutFrames) {
  ASSERT_TRUE(pipeline_.start(source_, path(64)));
  const std::uint64_t before = pipeline_.heartbeat();
  EXPECT_TRUE(eventually([&] { return pipeline_.heartbeat() > before + 2; }));
}

}  // namespace
}  // namespace lightwell
