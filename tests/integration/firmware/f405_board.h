// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// The STM32F405 with all that the image uses wired to it.

#include <array>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "interface/sync_frame.h"
#include "tests/integration/firmware/stm32f405.h"
#include "tests/integration/firmware/stm32f405_peripherals.h"
#include "tests/integration/firmware/stm32f405_usb.h"
#include "tests/integration/firmware/usb_host.h"

namespace lightwell::test {

// Frames over one of the board's links.
class FrameLine {
 public:
  FrameLine() { frame_receiver_init(&receiver_); }
  std::vector<std::uint8_t> frame(const sync_message& message) {
    std::uint8_t wire[SYNC_MAX_WIRE];
    return {wire, wire + frame_encode_message(&message, sequence_++, wire)};
  }
  void take(const std::vector<std::uint8_t>& bytes) {
    for (const std::uint8_t byte : bytes) {
      frame_view view;
      sync_message message{};
      if (frame_receive(&receiver_, byte, &view) && frame_message(&view, &message))
        messages.push_back(message);
    }
  }
  [[nodiscard]] const sync_message* find(std::uint8_t type) const {
    for (const auto& message : messages)
      if (message.type == type) return &message;
    return nullptr;
  }
  [[nodiscard]] unsigned damaged() const { return receiver_.damaged; }

  std::vector<sync_message> messages;

 private:
  frame_receiver receiver_{};
  std::uint16_t sequence_ = 0;
};

class F405Board {
 public:
  // As it leaves the bench: the boot program, and image A with its record. folder: of the firmware's build.
  explicit F405Board(const std::string& folder, bool crystal = true)
      : clocks(crystal),
        flash(chip),
        edges(gpio[0]),
        light(chip),
        watchdog(chip),
        usb(chip),
        host(chip, usb) {
    usb.clocked = [this] { return clocks.usb_clocked(); };
    for (unsigned i = 0; i < gpio.size(); ++i) chip.add(0x40020000 + 0x400 * i, 0x400, gpio[i]);
    chip.add(0x40000000, 0x400, edges, 28);
    chip.add(0x40000400, 0x400, light.timer);
    chip.add(0x40003000, 0x400, watchdog);
    chip.add(0x40005400, 0x400, i2c);
    chip.add(0x40011000, 0x400, uart, 37);
    chip.add(0x40012000, 0x300, light.adc);
    chip.add(0x40012300, 0x100, adc_common);
    chip.add(0x40023800, 0x400, clocks);
    chip.add(0x40023C00, 0x400, flash);
    chip.add(0x40026400, 0x400, light.dma, 56);
    chip.add(0x50000000, 0x40000, usb, 67);
    chip.load_program(folder + "/lightwell-boot-f405.elf");
    chip.load_program(folder + "/lightwell-sync-f405-a.elf");
    chip.load_program(folder + "/lightwell-sync-f405-b.elf", false);
    std::ifstream record(folder + "/lightwell-sync-f405-a.bin",
                         std::ios::binary);  // absent: built without a verifier
    if (record)
      chip.load_bytes({std::istreambuf_iterator<char>(record), {}}, Stm32F405Flash::sector_start(4));
    chip.reset();
  }

  // Over the UART; nothing: no such answer within seconds.
  const sync_message* ask_uart(const sync_message& request, std::uint8_t answer, double seconds = 0.2) {
    listen_uart();
    uart_line.messages.clear();
    uart.send(uart_line.frame(request));
    chip.run(seconds, [&] {
      listen_uart();
      return uart_line.find(answer) != nullptr;
    });
    return uart_line.find(answer);
  }
  void listen_uart() {
    uart_line.take({uart.sent.begin(), uart.sent.end()});
    uart.sent.clear();
  }
  const sync_message* ask_usb(const sync_message& request, std::uint8_t answer, int reads = 20) {
    usb_line.messages.clear();
    host.write(1, usb_line.frame(request));
    for (int i = 0; i < reads && usb_line.find(answer) == nullptr; ++i) usb_line.take(host.read(1));
    return usb_line.find(answer);
  }

  Stm32F405 chip;
  Stm32F405Clocks clocks;
  std::array<Stm32F405Gpio, 3> gpio;
  Stm32F405Flash flash;
  Stm32F405EdgeTimer edges;
  Stm32F405Light light;
  Stm32F405I2c i2c;
  Stm32F405Uart uart;
  Stm32F405Watchdog watchdog;
  PlainRegisters adc_common;
  Stm32F405Usb usb;
  UsbHost host;
  FrameLine uart_line, usb_line;
};

inline sync_message message_of(std::uint8_t type) {
  sync_message message{};
  message.type = type;
  return message;
}

}  // namespace lightwell::test
