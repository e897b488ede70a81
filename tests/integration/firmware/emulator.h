// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// An image in QEMU, its link and its stimulus at the other ends of sockets.

#include <gtest/gtest.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "firmware/core/board.h"
#include "firmware/core/settings.h"
#include "interface/sync_frame.h"
#include "tests/support/temporary_folder.h"

namespace lightwell::test {

class Socket {
 public:
  ~Socket() {
    if (fd_ >= 0) close(fd_);
  }
  bool connect(const std::string& path) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.copy(address.sun_path, sizeof address.sun_path - 1);
    for (int i = 0; i < 300; ++i) {
      fd_ = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
      if (::connect(fd_, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0) return true;
      close(fd_);
      fd_ = -1;
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    return false;
  }
  void write(const std::uint8_t* bytes, std::size_t size) const {
    while (size > 0) {
      const ssize_t sent = send(fd_, bytes, size, MSG_NOSIGNAL);
      ASSERT_GT(sent, 0);
      bytes += sent;
      size -= static_cast<std::size_t>(sent);
    }
  }
  // What has arrived within timeout_ms; nothing: empty.
  std::vector<std::uint8_t> read(int timeout_ms) const {
    pollfd wait{fd_, POLLIN, 0};
    if (poll(&wait, 1, timeout_ms) <= 0) return {};
    std::vector<std::uint8_t> bytes(4096);
    const ssize_t got = recv(fd_, bytes.data(), bytes.size(), 0);
    bytes.resize(got > 0 ? static_cast<std::size_t>(got) : 0);
    return bytes;
  }

 private:
  int fd_ = -1;
};

class Emulator {
 public:
  Emulator(const std::string& machine, const std::string& image, bool stimulus,
           const std::vector<std::string>& more = {}) {
    std::vector<std::string> words = {"qemu-system-arm", "-M",       machine, "-kernel", image,
                                      "-nographic",      "-monitor", "none"};
    words.insert(words.end(), more.begin(), more.end());
    if (stimulus) words.insert(words.end(), {"-icount", "shift=3,sleep=off"});
    words.insert(words.end(), {"-qmp", "unix:" + path("control") + ",server=on,wait=off"});
    for (const char* name : {"link", "stimulus"}) {
      words.insert(
          words.end(),
          {"-chardev", "socket,id=" + std::string(name) + ",path=" + path(name) + ",server=on,wait=off",
           "-serial", "chardev:" + std::string(name)});
      if (!stimulus) break;
    }
    std::vector<char*> argv;
    for (auto& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    if (posix_spawnp(&process_, argv[0], nullptr, nullptr, argv.data(), environ) != 0) process_ = -1;
    frame_receiver_init(&receiver_);
    connected = link_.connect(path("link")) && (!stimulus || stimulus_.connect(path("stimulus"))) &&
                control_.connect(path("control"));
    if (connected) control("qmp_capabilities");
  }
  ~Emulator() {
    if (process_ > 0) {
      kill(process_, SIGKILL);
      waitpid(process_, nullptr, 0);
    }
  }
  Emulator(const Emulator&) = delete;
  Emulator& operator=(const Emulator&) = delete;

  void send(const sync_message& message) {
    std::uint8_t wire[SYNC_MAX_WIRE];
    link_.write(wire, frame_encode_message(&message, sequence_++, wire));
  }

  // Takes what has arrived on both lines.
  void listen(int timeout_ms) {
    for (const std::uint8_t byte : link_.read(timeout_ms)) {
      frame_view view;
      sync_message message{};
      if (frame_receive(&receiver_, byte, &view) && frame_message(&view, &message))
        messages.push_back(message);
    }
    for (const std::uint8_t byte : stimulus_.read(0)) {
      record_.push_back(byte);
      if (record_.size() < 8) continue;
      pulses.push_back(record_[4] | std::uint32_t{record_[5]} << 8 | std::uint32_t{record_[6]} << 16 |
                       std::uint32_t{record_[7]} << 24);
      EXPECT_EQ(record_[0], 'P');
      record_.clear();
    }
  }

  // Asks until an answer of that type comes: the board may still be starting when the first request is sent.
  std::optional<sync_message> ask(const sync_message& request, std::uint8_t type) {
    for (int attempt = 0; attempt < 30; ++attempt) {
      const std::size_t before = messages.size();
      send(request);
      const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(2);
      while (std::chrono::steady_clock::now() < until) {
        listen(100);
        for (std::size_t i = before; i < messages.size(); ++i)
          if (messages[i].type == type) return messages[i];
      }
    }
    return std::nullopt;
  }
  std::optional<sync_message> ask(std::uint8_t request, std::uint8_t type) {
    sync_message message{};
    message.type = request;
    return ask(message, type);
  }

  // Lets the board run until done says so; gives up after half an hour.
  bool run_until(const std::function<bool()>& done) {
    const auto until = std::chrono::steady_clock::now() + std::chrono::minutes(30);
    while (!done() && std::chrono::steady_clock::now() < until) listen(10);
    return done();
  }

  // What the world does to the board: firmware/port/mps2/hal.c lists the kinds.
  void stimulate(char kind, unsigned index, std::uint32_t value) {
    const std::uint8_t record[8] = {static_cast<std::uint8_t>(kind),
                                    static_cast<std::uint8_t>(index),
                                    0,
                                    0,
                                    static_cast<std::uint8_t>(value),
                                    static_cast<std::uint8_t>(value >> 8),
                                    static_cast<std::uint8_t>(value >> 16),
                                    static_cast<std::uint8_t>(value >> 24)};
    stimulus_.write(record, sizeof record);
    if (++stimuli_ % 32 == 0) listen(0);  // or both ends might wait for room
  }
  void edge(board_input input, std::uint32_t stamp) { stimulate('E', input, stamp); }

  // The machine's reset line; its memories keep what they have.
  void reset() {
    control("system_reset");
    frame_receiver_init(&receiver_);
  }

  std::optional<sync_message> configure(std::uint32_t numerator, std::uint32_t denominator,
                                        std::uint8_t reference = SYNC_REFERENCE_NONE,
                                        std::uint32_t reference_hz = 1) {
    sync_message request{};
    request.type = SYNC_CONFIGURE;
    request.configuration = settings_default();
    request.configuration.rate_numerator = numerator;
    request.configuration.rate_denominator = denominator;
    request.configuration.trigger_on = 1;
    request.configuration.heartbeat_ms = 0;  // virtual time may run much faster than this test talks
    request.configuration.reference = reference;
    request.configuration.reference_numerator = reference_hz;
    return ask(request, SYNC_CONFIGURATION);
  }

  bool connected = false;
  std::vector<sync_message> messages;
  std::vector<std::uint32_t> pulses;  // stamps of rises

 private:
  void control(const std::string& command) const {
    const std::string line = R"({"execute": ")" + command + "\"}\n";
    control_.write(reinterpret_cast<const std::uint8_t*>(line.data()), line.size());
    std::string answer;
    for (int i = 0; i < 100 && answer.find("\"return\"") == std::string::npos; ++i)
      for (const std::uint8_t byte : control_.read(100)) answer += static_cast<char>(byte);
    EXPECT_NE(answer.find("\"return\""), std::string::npos) << command << ": " << answer;
  }
  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }

  TemporaryFolder folder_;
  Socket link_, stimulus_, control_;
  pid_t process_ = -1;
  frame_receiver receiver_{};
  std::uint16_t sequence_ = 0;
  std::uint64_t stimuli_ = 0;
  std::vector<std::uint8_t> record_;
};

}  // namespace lightwell::test
