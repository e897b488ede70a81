// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/pipeline/retired_sources.h"

namespace lightwell {

RetiredSources::RetiredSources() : thread_([this] { run(); }) {}

RetiredSources::~RetiredSources() {
  {
    const std::scoped_lock lock(mutex_);
    ending_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void RetiredSources::take(std::shared_ptr<CaptureSource> source, std::shared_ptr<const void> tables) {
  {
    const std::scoped_lock lock(mutex_);
    waiting_.push_back({std::move(source), std::move(tables)});
  }
  changed_.notify_all();
}

void RetiredSources::settle() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return waiting_.empty() && !at_work_; });
}

void RetiredSources::run() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [&] { return ending_ || !waiting_.empty(); });
    if (waiting_.empty()) return;
    std::vector<Retired> now;
    now.swap(waiting_);
    at_work_ = true;
    lock.unlock();
    for (const Retired& retired : now)
      if (retired.source) retired.source->stop();
    now.clear();  // what a stop leaves to the destructor is waited for here as well
    lock.lock();
    at_work_ = false;
    changed_.notify_all();
  }
}

}  // namespace lightwell
