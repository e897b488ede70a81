// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/sync/gpio_trigger.h"

#include <pthread.h>
#include <sched.h>
#include <sys/prctl.h>
#include <time.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "daemon/clock.h"

namespace lightwell {
namespace {

constexpr int kPriority = 49;                       // below the kernel's interrupt threads, which have 50
constexpr std::int64_t kLongestSleep = 50'000'000;  // until it is seen that all is over
constexpr double kForgets = 1.0 / 16;

}  // namespace

GpioTrigger::GpioTrigger(std::unique_ptr<GpioOutput> line, const TriggerPulses& pulses)
    : line_(std::move(line)), pulses_(pulses), thread_([this] { run(); }) {}

GpioTrigger::~GpioTrigger() {
  stopping_ = true;
  thread_.join();
  line_->set(false);
}

bool GpioTrigger::sleep_until(std::int64_t mono_ns) const {
  for (std::int64_t now_ns = mono_now_ns(); now_ns < mono_ns && !stopping_; now_ns = mono_now_ns()) {
    const std::int64_t until_ns = std::min(mono_ns, now_ns + kLongestSleep);
    const timespec time{until_ns / 1'000'000'000, until_ns % 1'000'000'000};
    clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &time, nullptr);
  }
  return !stopping_;
}

bool GpioTrigger::pulse(std::int64_t due_mono_ns, std::uint32_t n) {
  const std::uint32_t at = put_.load(std::memory_order_relaxed);
  const std::int64_t now_ns = mono_now_ns();
  if (at - taken_.load(std::memory_order_acquire) < kKept) {
    kept_[at % kKept] = {n, now_ns};
    put_.store(at + 1, std::memory_order_release);
  }
  const auto late_ns = static_cast<double>(now_ns - due_mono_ns);
  late_ns_ = static_cast<std::int32_t>(std::min(late_ns, 2e9));
  mean_square_ = mean_square_ + kForgets * (late_ns * late_ns - mean_square_);
  if (!line_->set(true)) return false;
  ++made_;
  sleep_until(now_ns + pulses_.pulse_ns);
  return line_->set(false);
}

void GpioTrigger::run() {
  pthread_setname_np(pthread_self(), "gpio-trigger");
  const sched_param priority{kPriority};
  real_time_ = pthread_setschedparam(pthread_self(), SCHED_FIFO, &priority) == 0;
  prctl(PR_SET_TIMERSLACK, 1UL);  // the kernel adds 50 µs to every sleep of other threads
  const std::int64_t begin_ns = mono_now_ns();
  for (std::uint64_t k = 1; sleep_until(begin_ns + pulses_.due_ns(k)); ++k) {
    // Of several that are due, the newest; the machine may have slept.
    std::uint64_t newest = k;
    const std::int64_t late_ns = mono_now_ns() - begin_ns - pulses_.due_ns(k);
    newest += static_cast<std::uint64_t>(late_ns / pulses_.period_ns());
    if (late_ns % pulses_.period_ns() > pulses_.period_ns() / 2) ++newest;
    late_ += static_cast<std::uint32_t>(newest - k);
    k = newest;
    if (!sleep_until(begin_ns + pulses_.due_ns(k))) return;
    if (pulse(begin_ns + pulses_.due_ns(k), static_cast<std::uint32_t>(k))) continue;
    failed_ = true;
    return;
  }
}

std::optional<GpioTrigger::Made> GpioTrigger::next() noexcept {
  const std::uint32_t at = taken_.load(std::memory_order_relaxed);
  if (at == put_.load(std::memory_order_acquire)) return std::nullopt;
  const Made made = kept_[at % kKept];
  taken_.store(at + 1, std::memory_order_release);
  return made;
}

GpioTrigger::View GpioTrigger::view() const noexcept {
  return {made_, late_, late_ns_, std::sqrt(mean_square_), real_time_, failed_};
}

}  // namespace lightwell
