// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// A USB host for the emulated chip: enumeration, control transfers and bulk, each token tried again while the device NAKs, a
// frame's part later.

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "tests/integration/firmware/stm32f405.h"
#include "tests/integration/firmware/stm32f405_usb.h"

namespace lightwell::test {

class UsbHost {
 public:
  using Bytes = std::vector<std::uint8_t>;

  UsbHost(Stm32F405& chip, Stm32F405Usb& usb) : chip_(chip), usb_(usb) {}

  // Nothing: the device stalled it, or fell silent.
  std::optional<Bytes> control_in(std::uint8_t type, std::uint8_t request, std::uint16_t value,
                                  std::uint16_t index, std::uint16_t length) {
    if (!setup(type, request, value, index, length)) return std::nullopt;
    Bytes all;
    for (;;) {
      const auto packet = in(0);
      if (!packet) return std::nullopt;
      all.insert(all.end(), packet->begin(), packet->end());
      if (packet->size() < 64 || all.size() >= length) break;
    }
    if (!out(0, {})) return std::nullopt;
    return all;
  }
  bool control_out(std::uint8_t type, std::uint8_t request, std::uint16_t value, std::uint16_t index) {
    return setup(type, request, value, index, 0) && in(0) &&
           (request != 5 || type != 0 || take_address(value));
  }
  std::optional<Bytes> descriptor(std::uint8_t kind, std::uint8_t index, std::uint16_t language = 0,
                                  std::uint16_t length = 255) {
    return control_in(0x80, 6, static_cast<std::uint16_t>(kind << 8 | index), language, length);
  }

  std::optional<Bytes> in(unsigned endpoint) {
    Bytes packet;
    return token([&] { return usb_.in(address_, endpoint, packet); }) ? std::optional(packet) : std::nullopt;
  }
  bool out(unsigned endpoint, const Bytes& packet) {
    return token([&] { return usb_.out(address_, endpoint, packet); });
  }
  // As a host's read of many packets: up to the first that is not full. Nothing within a tenth of a second: empty.
  Bytes read(unsigned endpoint) {
    Bytes all;
    while (const auto packet = in(endpoint)) {
      all.insert(all.end(), packet->begin(), packet->end());
      if (packet->size() < 64) break;
    }
    return all;
  }
  void write(unsigned endpoint, const Bytes& bytes) {
    for (std::size_t at = 0; at < bytes.size(); at += 64)
      out(endpoint, Bytes(bytes.begin() + static_cast<std::ptrdiff_t>(at),
                          bytes.begin() + static_cast<std::ptrdiff_t>(std::min(at + 64, bytes.size()))));
  }
  void bus_reset() {
    usb_.bus_reset();
    address_ = 0;
    chip_.run(0.01);
  }
  // Reset, address 5, configuration 1.
  bool enumerate() {
    bus_reset();
    return control_out(0x00, 5, 5, 0) && control_out(0x00, 9, 1, 0);
  }

  Stm32F405Usb::Answer last = Stm32F405Usb::Answer::kAck;

 private:
  static constexpr double kPatience = 0.1;

  bool setup(std::uint8_t type, std::uint8_t request, std::uint16_t value, std::uint16_t index,
             std::uint16_t length) {
    const auto low = [](std::uint16_t number) { return static_cast<std::uint8_t>(number); };
    const auto high = [](std::uint16_t number) { return static_cast<std::uint8_t>(number >> 8); };
    const std::array<std::uint8_t, 8> bytes = {type,       request,     low(value),  high(value),
                                               low(index), high(index), low(length), high(length)};
    last = usb_.setup(address_, bytes);
    return last == Stm32F405Usb::Answer::kAck;
  }
  bool take_address(std::uint16_t address) {
    address_ = static_cast<std::uint8_t>(address);
    return true;
  }
  template <typename Try>
  bool token(Try attempt) {
    chip_.run(kPatience, [&] { return (last = attempt()) != Stm32F405Usb::Answer::kNak; });
    return last == Stm32F405Usb::Answer::kAck;
  }

  Stm32F405& chip_;
  Stm32F405Usb& usb_;
  std::uint8_t address_ = 0;
};

}  // namespace lightwell::test
