// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// The rest of what the image uses, by RM0090's chapters.

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "tests/integration/firmware/stm32f405.h"

namespace lightwell::test {

// RCC: a crystal of 8 MHz, where one is fitted.
class Stm32F405Clocks : public PlainRegisters {
 public:
  explicit Stm32F405Clocks(bool crystal) : crystal_(crystal) { Stm32F405Clocks::reset(); }
  std::uint32_t read(std::uint32_t offset) override;
  void reset() override;
  [[nodiscard]] double pll_hz(bool usb);  // of the core, or of USB; 0 where it does not run
  bool usb_clocked() { return pll_hz(true) == 48e6 && (PlainRegisters::read(0x34) >> 7 & 1u) != 0; }

 private:
  bool crystal_;
};

class Stm32F405Gpio : public PlainRegisters {
 public:
  std::uint32_t read(std::uint32_t offset) override {
    return offset == 0x10 ? input : PlainRegisters::read(offset);
  }
  void write(std::uint32_t offset, std::uint32_t value) override;
  [[nodiscard]] unsigned mode(unsigned pin) { return PlainRegisters::read(0) >> (2 * pin) & 3u; }
  [[nodiscard]] unsigned function(unsigned pin) {
    return PlainRegisters::read(0x20 + 4 * (pin / 8)) >> (4 * (pin % 8)) & 15u;
  }

  std::uint32_t input = 0xFFFF, output = 0;
};

// FLASH: erases by sector, programs words, ones to zeros only. What is written without its key is a misuse.
class Stm32F405Flash : public Peripheral {
 public:
  explicit Stm32F405Flash(Stm32F405& chip);
  std::uint32_t read(std::uint32_t offset) override;
  void write(std::uint32_t offset, std::uint32_t value) override;
  void reset() override;

  static std::uint32_t sector_start(unsigned sector);

  std::uint64_t operations = 0;              // words programmed and sectors erased
  std::uint64_t cut_at = ~std::uint64_t{0};  // the power fails within that one

 private:
  void program(std::uint32_t address, std::uint32_t word);
  void finish_program();

  Stm32F405& chip_;
  std::uint32_t control_ = 1u << 31;
  unsigned keys_ = 0;
  bool written_ = false;  // by the program: memory holds the word as written, not as flash would keep it
  std::uint32_t address_ = 0, word_ = 0;
};

// TIM2: compare channel 1 drives a line, 2 to 4 capture. Ticks are of 84 MHz.
class Stm32F405EdgeTimer : public Peripheral {
 public:
  explicit Stm32F405EdgeTimer(Stm32F405Gpio& pins) : pins_(pins) {}
  struct Edge {
    std::uint64_t tick;
    bool level;
  };
  // An edge on the pin of channel 2, 3 or 4 (PA1 to PA3) at a tick to come.
  void edge(unsigned channel, std::uint64_t tick, bool level) { coming_.push_back({tick, channel, level}); }
  [[nodiscard]] std::uint64_t ticks() const { return now_; }

  std::uint32_t read(std::uint32_t offset) override;
  void write(std::uint32_t offset, std::uint32_t value) override;
  [[nodiscard]] bool timed() const override { return true; }
  void advance(std::uint64_t cycles) override;
  [[nodiscard]] bool interrupt() const override { return (status_ & enabled_) != 0; }
  void reset() override;

  std::vector<Edge> output;  // of the trigger line

 private:
  struct Coming {
    std::uint64_t tick;
    unsigned channel;
    bool level;
  };
  void drive(std::uint64_t tick, bool level);
  void apply_mode(std::uint64_t tick);
  void capture(const Coming& edge);

  Stm32F405Gpio& pins_;
  PlainRegisters plain_;
  std::uint32_t status_ = 0, enabled_ = 0;
  std::array<std::uint32_t, 4> compare_{};
  std::deque<Coming> coming_;
  std::uint64_t now_ = 0, offset_ = 0;  // ticks since power-on; counter = now - offset
  bool running_ = false, line_ = false;
};

// USART1: ten bits a byte at 1 Mbit/s. It waits until a byte was taken, for interrupts are taken late here.
class Stm32F405Uart : public Peripheral {
 public:
  void send(const std::vector<std::uint8_t>& bytes) {
    coming_.insert(coming_.end(), bytes.begin(), bytes.end());
  }
  std::uint32_t read(std::uint32_t offset) override;
  void write(std::uint32_t offset, std::uint32_t value) override;
  [[nodiscard]] bool timed() const override { return true; }
  void advance(std::uint64_t cycles) override;
  [[nodiscard]] bool interrupt() const override { return received_ && (control_ >> 5 & 1u) != 0; }
  void reset() override;

  std::deque<std::uint8_t> sent;

 private:
  static constexpr std::uint64_t kByte = 1680;  // cycles
  std::deque<std::uint8_t> coming_;
  std::uint64_t now_ = 0, next_ = 0, free_ = 0;
  std::uint32_t control_ = 0;
  bool received_ = false;
  std::uint8_t data_ = 0;
};

// TIM3, ADC1 and DMA2's stream 0 as one: a code of light at each of the timer's updates goes to memory.
class Stm32F405Light {
 public:
  explicit Stm32F405Light(Stm32F405& chip) : chip_(chip), dma(*this) {}

  std::function<unsigned(double seconds)> code = [](double) { return 0u; };

 private:
  struct Dma : PlainRegisters {
    explicit Dma(Stm32F405Light& light) : light_(light) {}
    std::uint32_t read(std::uint32_t offset) override;
    void write(std::uint32_t offset, std::uint32_t value) override;
    [[nodiscard]] bool timed() const override { return true; }
    void advance(std::uint64_t cycles) override { light_.advance(cycles); }
    [[nodiscard]] bool interrupt() const override { return complete && interrupts; }
    void reset() override;
    Stm32F405Light& light_;
    bool complete = false, interrupts = false;
    std::uint32_t left = 0;
  };
  void advance(std::uint64_t cycles);

  Stm32F405& chip_;
  std::uint64_t next_ = 0;

 public:
  Dma dma;
  PlainRegisters timer, adc;
};

// I2C1 with devices of 8 bit registers behind it, an address each.
class Stm32F405I2c : public Peripheral {
 public:
  std::map<unsigned, std::array<std::uint8_t, 256>> devices;

  std::uint32_t read(std::uint32_t offset) override;
  void write(std::uint32_t offset, std::uint32_t value) override;
  void reset() override;

 private:
  PlainRegisters plain_;
  std::uint32_t status_ = 0;
  unsigned device_ = 0, register_ = 0;
  bool reading_ = false, pointed_ = false;
};

// IWDG: 32 kHz.
class Stm32F405Watchdog : public Peripheral {
 public:
  explicit Stm32F405Watchdog(Stm32F405& chip) : chip_(chip) {}
  std::uint32_t read(std::uint32_t) override { return 0; }
  void write(std::uint32_t offset, std::uint32_t value) override;
  [[nodiscard]] bool timed() const override { return true; }
  void advance(std::uint64_t cycles) override;
  void reset() override { running_ = false; }

  [[nodiscard]] bool running() const { return running_; }

 private:
  Stm32F405& chip_;
  bool running_ = false;
  std::uint32_t prescaler_ = 0, reload_ = 0xFFF;
  std::uint64_t fed_ = 0;
};

}  // namespace lightwell::test
