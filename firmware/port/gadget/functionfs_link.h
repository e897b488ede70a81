// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <libaio.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <memory>

#include "firmware/port/simulator/link.h"

namespace lightwell::sync_gadget {

// A board's two bulk endpoints through FunctionFS. Hosts come and go; what is on its way when one goes is lost, and the
// protocol finds its feet again. Transfers are the kernel's own asynchronous ones (io_submit): a read(2) there would hold
// up the board's loop until the host has something to say.
class FunctionFsLink final : public sync_simulator::Link {
 public:
  // folder: a functionfs, mounted; once this stands, its gadget can be bound. stall_every: both endpoints are halted so
  // often, as broken firmware would; 0: never. Throws std::runtime_error.
  FunctionFsLink(const std::filesystem::path& folder, std::chrono::milliseconds stall_every);
  ~FunctionFsLink() override;

  bool move(std::deque<std::uint8_t>& from_host, std::deque<std::uint8_t>& to_host) override;

 private:
  static constexpr std::size_t kReads = 4;
  static constexpr std::size_t kPacket = 512;  // of high speed, and a multiple of full speed's

  class File {
   public:
    explicit File(const std::filesystem::path& path);
    ~File();
    File(const File&) = delete;
    File& operator=(const File&) = delete;
    int descriptor;
  };
  struct Transfer {
    iocb request{};
    std::array<std::uint8_t, kPacket> bytes{};
    bool on_its_way = false;
  };

  void take_events();
  void take_ended(std::deque<std::uint8_t>& from_host);
  void start_reads();
  void start_write(std::deque<std::uint8_t>& to_host);
  void stall_if_due();
  bool submit(Transfer& transfer);

  File control_;
  std::unique_ptr<File> from_host_, to_host_;  // there once control_ has its descriptors
  std::chrono::milliseconds stall_every_;
  std::chrono::steady_clock::time_point next_stall_;
  io_context_t context_ = nullptr;
  std::array<Transfer, kReads> reads_;
  Transfer write_;
  bool enabled_ = false;  // a host has configured the device
};

}  // namespace lightwell::sync_gadget
