// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <mutex>
#include <thread>

namespace lightwell {

// Pushes a file's data from the system's memory to the disk, on a thread of its own: a slow disk delays
// nobody. Requests that come while one is under way become one. Errors show at the writer's own fsync.
class DiskSync {
 public:
  explicit DiskSync(int fd);
  ~DiskSync();  // waits for a request under way
  DiskSync(const DiskSync&) = delete;
  DiskSync& operator=(const DiskSync&) = delete;

  void request();

 private:
  void run();

  int fd_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool wanted_ = false;
  bool ending_ = false;
  std::thread thread_;
};

}  // namespace lightwell
