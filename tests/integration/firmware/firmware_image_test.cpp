// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// Builds the sync board's image and talks to it in QEMU's mps2-an386. Skips where the toolchain or QEMU is
// missing.

#include <gtest/gtest.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "interface/sync_frame.h"
#include "tests/support/temporary_folder.h"

namespace {

bool have(const char* program) {
  return std::system(("command -v " + std::string(program) + " >/dev/null").c_str()) == 0;
}

class Emulator {
 public:
  explicit Emulator(const std::string& image) : socket_path_((folder_.path() / "uart").string()) {
    std::vector<std::string> words = {"qemu-system-arm",
                                      "-M",
                                      "mps2-an386",
                                      "-kernel",
                                      image,
                                      "-nographic",
                                      "-monitor",
                                      "none",
                                      "-chardev",
                                      "socket,id=u,path=" + socket_path_ + ",server=on,wait=off",
                                      "-serial",
                                      "chardev:u"};
    std::vector<char*> argv;
    for (auto& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    if (posix_spawnp(&process_, argv[0], nullptr, nullptr, argv.data(), environ) != 0) process_ = -1;
  }
  ~Emulator() {
    if (link_ >= 0) close(link_);
    if (process_ > 0) {
      kill(process_, SIGKILL);
      waitpid(process_, nullptr, 0);
    }
  }
  Emulator(const Emulator&) = delete;
  Emulator& operator=(const Emulator&) = delete;

  bool connect() {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    socket_path_.copy(address.sun_path, sizeof address.sun_path - 1);
    for (int i = 0; i < 300; ++i) {
      link_ = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
      if (::connect(link_, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0) return true;
      close(link_);
      link_ = -1;
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    return false;
  }

  // Asks until an answer of that type comes: the board may still be starting when the first request is sent.
  std::optional<std::vector<std::uint8_t>> ask(std::uint8_t type, const std::vector<std::uint8_t>& payload,
                                               std::uint8_t answer_type) {
    frame_receiver receiver;
    frame_receiver_init(&receiver);
    for (int attempt = 0; attempt < 30; ++attempt) {
      std::uint8_t wire[SYNC_MAX_WIRE];
      const std::size_t size = frame_encode(type, 0, payload.data(), payload.size(), wire);
      if (send(link_, wire, size, MSG_NOSIGNAL) != static_cast<ssize_t>(size)) return std::nullopt;
      pollfd wait{link_, POLLIN, 0};
      while (poll(&wait, 1, 1000) > 0) {
        std::uint8_t byte = 0;
        if (recv(link_, &byte, 1, 0) != 1) return std::nullopt;
        frame_view view;
        if (frame_receive(&receiver, byte, &view) && view.type == answer_type)
          return std::vector<std::uint8_t>(view.payload, view.payload + view.payload_size);
      }
    }
    return std::nullopt;
  }

 private:
  lightwell::test::TemporaryFolder folder_;
  std::string socket_path_;
  pid_t process_ = -1;
  int link_ = -1;
};

std::uint64_t u64(const std::vector<std::uint8_t>& bytes, std::size_t at) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < 8; ++i) value |= std::uint64_t{bytes.at(at + i)} << (8 * i);
  return value;
}

TEST(FirmwareImage, AnswersHelloAndPingOnAnEmulatedBoard) {
  for (const char* program : {"arm-none-eabi-gcc", "qemu-system-arm", "cmake", "ninja"})
    if (!have(program)) GTEST_SKIP() << program << " is not installed";
  const lightwell::test::TemporaryFolder build;
  const std::string configure = "cmake -S " LIGHTWELL_SOURCE_DIR " -B " + build.path().string() +
                                " -G Ninja -DCMAKE_BUILD_TYPE=MinSizeRel -DLIGHTWELL_FIRMWARE=ON "
                                "-DCMAKE_TOOLCHAIN_FILE=" LIGHTWELL_SOURCE_DIR
                                "/cmake/arm-none-eabi.cmake >/dev/null && cmake --build " +
                                build.path().string() + " >/dev/null";
  ASSERT_EQ(std::system(configure.c_str()), 0);

  Emulator emulator((build.path() / "lightwell-sync-mps2.elf").string());
  ASSERT_TRUE(emulator.connect());
  const auto hello = emulator.ask(SYNC_HELLO_REQUEST, {}, SYNC_HELLO);
  ASSERT_TRUE(hello);
  EXPECT_EQ(static_cast<std::uint32_t>(u64(*hello, 0)), SYNC_SCHEMA_HASH);

  std::uint64_t last_us = 0;
  for (std::uint8_t i = 0; i < 50; ++i) {
    const auto pong = emulator.ask(SYNC_PING, {i, 0, 0, 0, 0, 0, 0, 9}, SYNC_PONG);
    ASSERT_TRUE(pong);
    EXPECT_EQ(u64(*pong, 0), 0x0900000000000000ull + i);
    EXPECT_LE(u64(*pong, 8), u64(*pong, 16));
    EXPECT_LE(last_us, u64(*pong, 8));
    last_us = u64(*pong, 16);
  }
}

}  // namespace
