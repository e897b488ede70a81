// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "daemon/pipeline/snapshot.h"
#include "daemon/pipeline/status.h"
#include "daemon/web/metrics.h"

namespace lightwell {

struct WebAnswer {
  int status = 200;
  const char* type = "application/json";
  std::string body;
};
WebAnswer error_answer(int status, const std::string& message);

// What the paths of interface/openapi.yaml and the page answer, without how it travels. One thread; holds one lease
// while it answers.
class WebAnswers {
 public:
  // All three outlive it; counters are only read.
  WebAnswers(SnapshotChannel& snapshots, DaemonControl& control, const WebCounters& counters)
      : snapshots_(snapshots), control_(control), counters_(counters) {}

  // What answers a GET of the path; empty: nothing does.
  std::function<WebAnswer()> find(const std::string& path);
  // A POST to /api/v1/record.
  WebAnswer record(const std::string& body);

 private:
  // The last one made of each kind: many viewers cost one.
  struct Picture {
    std::uint64_t number = 0;
    std::int64_t capture_ns = 0;
    std::string body;
  };
  WebAnswer status();
  WebAnswer lights();
  WebAnswer metrics();
  WebAnswer environment_exr();
  WebAnswer environment_jpg();
  WebAnswer picture(Picture& last, const char* type, Result<std::string> (*make)(const Snapshot&));

  SnapshotChannel& snapshots_;
  DaemonControl& control_;
  const WebCounters& counters_;
  Picture exr_picture_, jpg_picture_;
};

}  // namespace lightwell
