// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/pipeline/fit_worker.h"

#include <chrono>
#include <utility>

#include "daemon/clock.h"

namespace lightwell {
namespace {

using namespace std::chrono_literals;
constexpr auto kStopCheck = 100ms;  // how long the thread may wait before it looks whether to stop

}  // namespace

FitWorker::FitWorker(SnapshotChannel& snapshots, std::optional<FewLightsOptions> options, Listener listener)
    : snapshots_(snapshots), listener_(std::move(listener)), options_(options), thread_([this] { run(); }) {}

FitWorker::~FitWorker() {
  stopping_ = true;
  thread_.join();
}

void FitWorker::set_options(std::optional<FewLightsOptions> options) {
  const std::scoped_lock lock(mutex_);
  options_ = options;
  options_changed_ = true;
  newest_.reset();
}

std::optional<FitSnapshot> FitWorker::newest() const {
  const std::scoped_lock lock(mutex_);
  return newest_;
}

void FitWorker::run() {
  while (!stopping_) {
    std::optional<FewLightsOptions> options;
    {
      const std::scoped_lock lock(mutex_);
      options = options_;
      if (std::exchange(options_changed_, false)) {
        fitter_.reset();
        made_.number = 0;  // the newest frame is to be fitted again
      }
    }
    if (!options) {
      std::this_thread::sleep_for(kStopCheck);
      continue;
    }
    const auto asked_at = std::chrono::steady_clock::now();
    const auto lease = snapshots_.wait_newer(made_.number, kStopCheck);
    if (lease)
      fit(*lease, *options);
    else if (std::chrono::steady_clock::now() - asked_at < kStopCheck / 2)
      std::this_thread::sleep_for(kStopCheck);  // a closed channel answers at once
  }
}

void FitWorker::fit(const Snapshot& snapshot, const FewLightsOptions& options) {
  if (!fitter_ || !(grid_ == snapshot.map.grid)) {
    auto created = FewLights::create(snapshot.map.grid, options);
    verify_bug(created.ok(), "options of the fit were not checked");
    fitter_.emplace(std::move(created).value());
    grid_ = snapshot.map.grid;
  }
  made_.number = snapshot.number;
  made_.sequence = snapshot.sequence;
  made_.capture_mono_ns = snapshot.capture_mono_ns;
  made_.capture_utc_ns = snapshot.capture_utc_ns;
  made_.calibration_id = snapshot.calibration_id;
  made_.measured_part = snapshot.map.coverage;
  made_.fit = fitter_->fit(snapshot.map);
  made_.publish_mono_ns = mono_now_ns();
  {
    const std::scoped_lock lock(mutex_);
    if (options_changed_) return;
    newest_ = made_;
  }
  if (listener_) listener_(made_);
}

}  // namespace lightwell
