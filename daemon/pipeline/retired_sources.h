// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "daemon/capture/capture_source.h"

namespace lightwell {

// Stops and ends sources that have been replaced, on a thread of its own: a dead camera takes seconds to let go,
// and nobody should wait for that. The tables that went with a source are let go of there too. Any thread may
// call.
class RetiredSources {
 public:
  RetiredSources();
  ~RetiredSources();  // waits as settle does
  RetiredSources(const RetiredSources&) = delete;
  RetiredSources& operator=(const RetiredSources&) = delete;

  // source: started, and no longer waited on by anybody; may be null. Returns at once.
  void take(std::shared_ptr<CaptureSource> source, std::shared_ptr<const void> tables = {});
  // Returns when all that were taken have stopped; up to 5 s for each whose camera died.
  void settle();

 private:
  void run();

  std::mutex mutex_;  // guards the three below
  std::condition_variable changed_;
  struct Retired {
    std::shared_ptr<CaptureSource> source;
    std::shared_ptr<const void> tables;
  };
  std::vector<Retired> waiting_;
  bool at_work_ = false;
  bool ending_ = false;
  std::thread thread_;  // last: starts when all else is there
};

}  // namespace lightwell
