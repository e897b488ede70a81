// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// OTG_FS of an STM32F405 as a device (RM0090, chapter 34; slave mode) with a host at the other end of the cable. The host's
// transactions are one token each, answered as the core's registers and FIFOs have it at that moment.

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "tests/integration/firmware/stm32f405.h"

namespace lightwell::test {

class Stm32F405Usb : public Peripheral {
 public:
  explicit Stm32F405Usb(Stm32F405& chip) : chip_(chip) { Stm32F405Usb::reset(); }

  std::function<bool()> clocked = [] { return true; };

  enum class Answer { kAck, kNak, kStall, kSilence };

  // The pull-up is on: transceiver powered, session valid, not soft-disconnected.
  [[nodiscard]] bool attached() const;
  void bus_reset();
  void suspend() { interrupts_ |= kSuspend; }
  Answer setup(std::uint8_t address, const std::array<std::uint8_t, 8>& request);
  Answer out(std::uint8_t address, unsigned endpoint, const std::vector<std::uint8_t>& packet);
  Answer in(std::uint8_t address, unsigned endpoint, std::vector<std::uint8_t>& packet);

  std::uint32_t read(std::uint32_t offset) override;
  void write(std::uint32_t offset, std::uint32_t value) override;
  [[nodiscard]] bool interrupt() const override;
  void reset() override;

 private:
  static constexpr unsigned kEndpoints = 4, kFifoWords = 320;
  static constexpr std::uint32_t kSuspend = 1u << 11, kBusReset = 1u << 12, kEnumerated = 1u << 13;

  struct Endpoint {
    std::uint32_t control = 0, interrupts = 0, size = 0;
    std::deque<std::uint8_t> fifo;  // of an IN endpoint
    [[nodiscard]] unsigned packet(unsigned number) const;
    [[nodiscard]] unsigned left() const { return size & 0x7FFFFu; }
    [[nodiscard]] unsigned packets() const { return size >> 19 & 0x3FFu; }
  };
  struct Received {
    std::uint32_t status;
    std::vector<std::uint8_t> bytes;
  };

  [[nodiscard]] std::uint32_t global_interrupts() const;
  [[nodiscard]] std::uint32_t endpoint_interrupts() const;
  [[nodiscard]] bool in_raised(unsigned n) const;
  void receive(unsigned kind, unsigned endpoint, const std::vector<std::uint8_t>& bytes);
  std::uint32_t pop();
  std::uint32_t read_endpoint(unsigned n, bool in, std::uint32_t offset) const;
  void write_endpoint(unsigned n, bool in, std::uint32_t offset, std::uint32_t value);
  void write_fifo(unsigned n, std::uint32_t value);
  void check_fifos();
  [[nodiscard]] unsigned depth(unsigned n) const;
  [[nodiscard]] bool answers(std::uint8_t address) const;

  Stm32F405& chip_;
  PlainRegisters plain_;
  std::uint32_t interrupts_ = 0;
  std::array<Endpoint, kEndpoints> in_, out_;
  std::deque<Received> received_;
  std::deque<std::uint8_t> reading_;  // of the entry that was popped
  bool out_nak_ = false;              // of all OUT endpoints
  std::uint8_t address_ = 0;          // in force
};

}  // namespace lightwell::test
