// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <string>
#include <vector>

namespace lightwell::test {

// A camera's process, listening on 127.0.0.1 of the private network.
class FakeCamera {
 public:
  // Of fake_camera_main.cpp.
  FakeCamera(int width, int height, double rate_hz, const std::string& serial = "TEST");
  // Of feature_camera_main.cpp.
  explicit FakeCamera(std::uint64_t first_id);
  ~FakeCamera() { kill(); }
  FakeCamera(const FakeCamera&) = delete;
  FakeCamera& operator=(const FakeCamera&) = delete;

  // It listens. False: it could not be started.
  [[nodiscard]] bool ready() const { return ready_; }
  void tell(const std::string& command) const;
  // As when its cable is pulled: no goodbye.
  void kill();

 private:
  void start(std::vector<std::string> words);

  pid_t pid_ = -1;
  int to_ = -1;
  bool ready_ = false;
};

}  // namespace lightwell::test
