// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/capture/simulated_source.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <condition_variable>
#include <ctime>
#include <filesystem>
#include <limits>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "daemon/capture/buffer_pool.h"
#include "daemon/clock.h"
#include "daemon/simulator/frame_generator.h"
#include "daemon/simulator/probe_setup.h"

namespace lightwell {
namespace {

using Clock = std::chrono::steady_clock;  // CLOCK_MONOTONIC

std::int64_t ns_of(Clock::time_point t) {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(t.time_since_epoch()).count();
}

Result<simulator::ProbeSetup> set_up(const std::string& name, const CaptureOptions& options) {
  simulator::ProbeOptions wanted;
  if (simulator::names_scenario(name)) {
    wanted.scenario = name;
  } else if (name.find_first_of("./") != std::string::npos) {
    wanted.environments = {name};
  } else {
    std::string allowed;
    for (const std::string_view s : simulator::scenario_names()) allowed += std::string(s) + ", ";
    return Error{ErrorKind::usage, "source simulated:" + name + ": allowed " + allowed + "or an image file"};
  }
  if (options.width > 0) wanted.width = options.width;
  if (options.height > 0) wanted.height = options.height;
  if (!options.pixel_format.empty()) wanted.pixel_format = options.pixel_format;
  if (options.rate_hz > 0) wanted.rate_hz = options.rate_hz;
  wanted.exposure_us = options.exposure_us;
  return simulator::set_up_probe(wanted);
}

// One thread makes a frame for every period into a free buffer and leaves it, freshest only, for wait to
// take.
class SimulatedSource final : public CaptureSource {
 public:
  SimulatedSource(std::string name, simulator::ProbeSetup setup, int buffers,
                  std::unique_ptr<BufferPool> pool)
      : name_(std::move(name)), setup_(std::move(setup)), pool_(std::move(pool)) {
    for (std::size_t i = 0; i < static_cast<std::size_t>(buffers); ++i) {
      slots_.push_back({this, i});
      free_.push_back(i);
    }
  }
  ~SimulatedSource() override { SimulatedSource::stop(); }

  Status start() override {
    const std::lock_guard lock(mutex_);
    if (thread_.joinable()) return {};
    running_ = true;
    state_ = SourceState::opening;
    thread_ = std::thread([this] { run(); });
    return {};
  }

  FrameLease wait(std::chrono::milliseconds timeout) noexcept override {
    std::unique_lock lock(mutex_);
    arrived_.wait_for(lock, timeout, [this] { return ready_.has_value() || !running_; });
    if (!ready_) return {};
    const auto [info, slot] = *ready_;
    ready_.reset();
    return {info, pool_->buffer(slot), &SimulatedSource::give_back, this, &slots_[slot]};
  }

  void stop() noexcept override {
    {
      const std::lock_guard lock(mutex_);
      running_ = false;
      state_ = SourceState::no_device;
    }
    arrived_.notify_all();
    tick_.notify_all();
    if (thread_.joinable()) thread_.join();
    const std::lock_guard lock(mutex_);
    drop_ready();
  }

  ExposureChange set_exposure_us(double exposure_us) override {
    if (exposure_us > 0 && exposure_us <= 1e6 / setup_.rate_hz)
      exposure_us_ = exposure_us;  // else as a camera refuses
    return ExposureChange::asked;
  }

  [[nodiscard]] SourceState state() const noexcept override {
    const std::lock_guard lock(mutex_);
    return state_;
  }
  [[nodiscard]] std::string describe() const override {
    const FrameFormat& f = setup_.model.format;
    return "simulated probe in this process: " + name_ + ", " + std::to_string(f.width) + "x" +
           std::to_string(f.height) + " " + std::string(lightwell::name(f.pixel_format));
  }
  [[nodiscard]] CaptureCounters counters() const noexcept override {
    const std::lock_guard lock(mutex_);
    return counters_;
  }
  [[nodiscard]] double rate_hz() const noexcept override { return setup_.rate_hz; }

 private:
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  struct Slot {
    SimulatedSource* source;
    std::size_t index;
  };

  static void give_back(void* context, void* token) noexcept {
    auto* self = static_cast<SimulatedSource*>(context);
    const std::lock_guard lock(self->mutex_);
    self->free_.push_back(static_cast<Slot*>(token)->index);  // never beyond its first size: no allocation
  }

  void run() {
    // Making the lasting layers takes a while; until then the state is `opening`.
    simulator::FrameGenerator generator(setup_.scene, setup_.model);
    const auto period =
        std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1 / setup_.rate_hz));
    // After a stop, scene and sequence go on where they were.
    const std::uint64_t begin = expected_;
    const Clock::time_point first = Clock::now() + period;
    for (std::uint64_t tick = begin;; ++tick) {
      const Clock::time_point due = first + period * static_cast<std::int64_t>(tick - begin);
      // A frame that would come a whole period too late is lost, as on a camera; so is one without a free
      // buffer.
      const std::size_t slot = Clock::now() > due + period ? kNone : take_free();
      FrameInfo info;
      if (slot != kNone) info = make(generator, tick, due, slot);
      if (!wait_until(due)) {
        if (slot != kNone) put_free(slot);
        return;
      }
      if (slot != kNone) publish(info, slot);
    }
  }

  FrameInfo make(simulator::FrameGenerator& generator, std::uint64_t tick, Clock::time_point due,
                 std::size_t slot) {
    const double end_s = (static_cast<double>(tick) + 1) / setup_.rate_hz;
    const FrameFormat& format = setup_.model.format;
    const double exposure_us = exposure_us_;
    FrameInfo info;
    info.probe_position_m =
        generator.render(end_s, exposure_us, tick, format.pixel_format, pool_->buffer(slot)).position_m;
    info.format = format;
    info.sequence = tick;
    info.capture_mono_ns = ns_of(due) - std::llround(exposure_us * 500);
    info.exposure_us = exposure_us;
    info.temperature_c = std::numeric_limits<float>::quiet_NaN();
    return info;
  }

  std::size_t take_free() {
    const std::lock_guard lock(mutex_);
    if (free_.empty()) return kNone;
    const std::size_t slot = free_.back();
    free_.pop_back();
    return slot;
  }
  void put_free(std::size_t slot) {
    const std::lock_guard lock(mutex_);
    free_.push_back(slot);
  }

  void drop_ready() {
    if (!ready_) return;
    free_.push_back(ready_->second);
    ++counters_.skipped;
    ready_.reset();
  }

  bool wait_until(Clock::time_point due) {
    std::unique_lock lock(mutex_);
    return !tick_.wait_until(lock, due, [this] { return !running_; });
  }

  void publish(FrameInfo info, std::size_t slot) {
    {
      const std::lock_guard lock(mutex_);
      if (state_ == SourceState::opening) state_ = SourceState::streaming;
      info.received_mono_ns = ns_of(Clock::now());
      info.capture_utc_ns = utc_now_ns() - (info.received_mono_ns - info.capture_mono_ns);
      drop_ready();
      ++counters_.received;
      if (info.sequence > expected_) counters_.lost += info.sequence - expected_;
      expected_ = info.sequence + 1;
      ready_ = {info, slot};
    }
    arrived_.notify_one();
  }

  const std::string name_;
  const simulator::ProbeSetup setup_;
  std::atomic<double> exposure_us_{setup_.exposure_us};
  const std::unique_ptr<BufferPool> pool_;
  std::vector<Slot> slots_;

  mutable std::mutex mutex_;
  std::condition_variable arrived_, tick_;
  bool running_ = false;
  SourceState state_ = SourceState::no_device;
  CaptureCounters counters_;
  std::uint64_t expected_ = 0;  // written by the thread alone, while it runs
  std::vector<std::size_t> free_;
  std::optional<std::pair<FrameInfo, std::size_t>> ready_;
  std::thread thread_;
};

}  // namespace

Result<std::unique_ptr<CaptureSource>> make_simulated_source(const std::string& name,
                                                             const CaptureOptions& options) {
  auto setup = set_up(name, options);
  if (!setup) return setup.error();
  const int buffers = std::max(options.buffers, 4);  // one made, one ready, two leased
  auto pool = BufferPool::create(setup->model.format.bytes(), static_cast<std::size_t>(buffers));
  if (!pool)
    return Error{ErrorKind::failed, "source simulated:" + name + ": not enough memory for its buffers"};
  return std::unique_ptr<CaptureSource>(
      std::make_unique<SimulatedSource>(name, *std::move(setup), buffers, std::move(pool)));
}

Result<FrameFormat> simulated_format(const std::string& name, const CaptureOptions& options) {
  const auto setup = set_up(name, options);
  if (!setup) return setup.error();
  return setup->model.format;
}

Result<Calibration> simulated_calibration(const std::string& name, const CaptureOptions& options) {
  const auto setup = set_up(name, options);
  if (!setup) return setup.error();
  return setup->model.calibration;
}

}  // namespace lightwell
