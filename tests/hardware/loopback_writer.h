// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <span>
#include <string>
#include <thread>
#include <vector>

namespace lightwell::test {

// The camera behind a v4l2loopback device: writes frames into it with write(2) at a rate.
class LoopbackWriter {
 public:
  // Fails the test where the device cannot be opened or does not take the format.
  LoopbackWriter(const std::string& path, std::uint32_t fourcc, int width, int height);
  ~LoopbackWriter();
  LoopbackWriter(const LoopbackWriter&) = delete;
  LoopbackWriter& operator=(const LoopbackWriter&) = delete;

  // False where the driver takes less than the whole.
  bool write(std::span<const std::byte> frame) const;
  // make fills frame n, from 0; until rest or the end.
  void run(double rate_hz, std::function<void(std::uint64_t n, std::span<std::byte> frame)> make);
  void rest() { thread_ = {}; }

 private:
  int fd_ = -1;
  std::size_t bytes_ = 0;
  std::jthread thread_;
};

}  // namespace lightwell::test
