// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/publish/publisher.h"

#include <spdlog/spdlog.h>

#include <algorithm>

#include "daemon/publish/messages.h"

namespace lightwell {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto kStopCheck =
    100ms;  // how long a thread may wait for a snapshot before it looks whether to stop
constexpr auto kRepeatLights = 1s;
constexpr auto kStatusInterval = 1s;

}  // namespace

Result<std::unique_ptr<Publisher>> Publisher::start(const PublisherOptions& options,
                                                    SnapshotChannel& snapshots,
                                                    const DaemonControl& control) {
  auto domain = DdsDomain::open(options.dds);
  if (!domain) return domain.error();
  std::unique_ptr<Publisher> made(new Publisher(options, snapshots, control));
  auto lights = LightWriter::create(*domain, options.probe);
  if (!lights) return lights.error();
  auto fits = FitWriter::create(*domain, options.probe);
  if (!fits) return fits.error();
  auto environments = EnvironmentWriter::create(*domain, options.probe);
  if (!environments) return environments.error();
  auto status = StatusWriter::create(*domain, options.probe);
  if (!status) return status.error();
  made->lights_ = std::move(lights).value();
  made->fits_ = std::move(fits).value();
  made->environments_ = std::move(environments).value();
  made->status_ = std::move(status).value();
  made->lights_thread_ = std::thread([self = made.get()] { self->run_lights(); });
  made->maps_thread_ = std::thread([self = made.get()] { self->run_maps_and_status(); });
  return made;
}

Publisher::~Publisher() {
  {
    const std::scoped_lock lock(mutex_);
    stopping_ = true;
  }
  stop_wanted_.notify_all();
  if (lights_thread_.joinable()) lights_thread_.join();
  if (maps_thread_.joinable()) maps_thread_.join();
}

PublisherCounters Publisher::counters() const {
  return {lights_sent_.load(), fits_sent_.load(), environments_sent_.load(), dropped_.load()};
}

void Publisher::send(const FitSnapshot& fit) {
  fill_message(fit, fit_message_);
  count(fits_->write(fit_message_), &fits_sent_);
}

bool Publisher::pause(std::chrono::nanoseconds time) {
  std::unique_lock lock(mutex_);
  return stop_wanted_.wait_for(lock, time, [this] { return stopping_; });
}

void Publisher::count(const Status& sent, std::atomic<std::uint64_t>* counter) {
  if (sent.ok()) {
    if (counter != nullptr) ++*counter;
  } else if (dropped_++ == 0) {
    spdlog::warn("{} (further ones are counted, not logged)", sent.error().message);
  }
}

void Publisher::run_lights() {
  LightFrame message;
  auto sent_at = Clock::now();
  while (!pause(0s)) {
    const std::uint64_t last = message.header.number;
    const auto asked_at = Clock::now();
    if (const auto lease = snapshots_.wait_newer(last, kStopCheck)) fill_message(*lease, message);
    if (message.header.number != last) {
      sent_at = Clock::now();
      count(lights_->write(message), &lights_sent_);
      continue;
    }
    if (last != 0 && Clock::now() - sent_at >= kRepeatLights) {
      sent_at = Clock::now();
      count(lights_->write(message), nullptr);
    }
    // A closed channel answers at once.
    if (Clock::now() - asked_at < kStopCheck / 2 && pause(kStopCheck)) return;
  }
}

void Publisher::run_maps_and_status() {
  const bool maps = options_.environment_hz > 0;
  const auto interval = std::chrono::duration_cast<Clock::duration>(
      std::chrono::duration<double>(maps ? 1 / options_.environment_hz : 1));
  EnvironmentFrame message;
  auto next_map = Clock::now();
  auto next_status = next_map;
  for (;;) {
    const auto now = Clock::now();
    if (now >= next_status) {
      next_status = now + kStatusInterval;
      count(status_->write(status_message(control_.status())), nullptr);
    }
    if (maps && now >= next_map) {
      next_map = now + interval;
      const std::uint64_t last = message.header.number;
      if (const auto lease = snapshots_.wait_newer(last, 0ms)) fill_message(*lease, message);
      if (message.header.number != last) count(environments_->write(message), &environments_sent_);
    }
    const auto next = maps ? std::min(next_map, next_status) : next_status;
    if (pause(std::max<Clock::duration>(next - Clock::now(), 1ms))) return;
  }
}

}  // namespace lightwell
