// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <chrono>
#include <string>

namespace lightwell {

// A running lightwell-libcamera, beside the program that starts it in the same folder.
class LibcameraProcess {
 public:
  LibcameraProcess() = default;
  ~LibcameraProcess() { end(std::chrono::milliseconds(0)); }
  LibcameraProcess(const LibcameraProcess&) = delete;
  LibcameraProcess& operator=(const LibcameraProcess&) = delete;

  // argument: its one argument, what it is to do. False: it cannot be started.
  bool start(const std::string& argument);
  // Our end of the socket between us; −1 where there is none.
  [[nodiscard]] int socket() const noexcept { return socket_; }
  // Hangs up, which ends it, and kills it where that takes longer.
  void end(std::chrono::milliseconds patience) noexcept;
  // How it ended, for people, where it did: "ended by signal 6"; after the other end of the socket has gone.
  [[nodiscard]] std::string how_it_ended() noexcept;

 private:
  pid_t pid_ = -1;
  int socket_ = -1;
};

// Full path of that program.
std::string libcamera_program();

}  // namespace lightwell
