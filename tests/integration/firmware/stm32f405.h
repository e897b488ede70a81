// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// An STM32F405 for the board's real image: Unicorn runs its ARM code, and the registers that the image uses answer as RM0090
// says. What a register is told that the chip would not do (a word of flash programmed twice, a FIFO overrun) is a misuse.
//
// Time goes on with the bus: kCyclesAnAccess of 168 MHz at each access of a register, none between them. Edges are exact all
// the same, for the timer makes them; how long the program takes is not what is asked here. Interrupts are taken where the
// loop asks for the time (hal_ticks), one at a time, the most urgent first.

#include <unicorn/unicorn.h>

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

namespace lightwell::test {

// A block of registers. Offsets are in bytes from its base, values 32 bits.
class Peripheral {
 public:
  virtual ~Peripheral() = default;
  virtual std::uint32_t read(std::uint32_t offset) = 0;
  virtual void write(std::uint32_t offset, std::uint32_t value) = 0;
  [[nodiscard]] virtual bool timed() const { return false; }  // advance is to be called
  virtual void advance(std::uint64_t /*cycles*/) {}           // to this time
  [[nodiscard]] virtual bool interrupt() const { return false; }
  virtual void reset() = 0;
};

// Registers that only keep what was written.
class PlainRegisters : public Peripheral {
 public:
  std::uint32_t read(std::uint32_t offset) override {
    return offset / 4 < values_.size() ? values_[offset / 4] : 0;
  }
  void write(std::uint32_t offset, std::uint32_t value) override {
    if (offset / 4 >= values_.size()) values_.resize(offset / 4 + 1);
    values_[offset / 4] = value;
  }
  void reset() override { values_.clear(); }

 private:
  std::vector<std::uint32_t> values_;
};

class Stm32F405 {
 public:
  static constexpr std::uint64_t kHz = 168'000'000;
  static constexpr std::uint32_t kFlash = 0x08000000, kFlashSize = 0x100000;
  static constexpr std::uint32_t kSerial[3] = {0x00340021, 0x30385119, 0x36323734};

  Stm32F405();
  ~Stm32F405();
  Stm32F405(const Stm32F405&) = delete;
  Stm32F405& operator=(const Stm32F405&) = delete;

  // A program: what the ELF file has for the flash, and the names in it; or its names alone, where it comes to flash otherwise.
  void load_program(const std::string& elf, bool into_flash = true);
  void load_bytes(const std::vector<std::uint8_t>& bytes, std::uint32_t address);

  // Adds registers at an address, with the number of their interrupt (negative: none).
  void add(std::uint32_t base, std::uint32_t size, Peripheral& peripheral, int interrupt = -1);

  // As the reset line does: memories keep what they have.
  void reset();

  // Lets the chip run until done says so, asked where the loop asks for the time and no more once it was so; gives up after that much of its own time.
  bool run(double seconds, const std::function<bool()>& done);
  void run(double seconds) {
    run(seconds, [] { return false; });
  }

  [[nodiscard]] std::uint64_t cycles() const { return cycles_; }
  // The power fails here and now, and comes back: for what the flash is doing.
  void cut_power() {
    reset_wanted = true;
    uc_emu_stop(engine_);
  }
  // The core stands still for so long, as during an erase.
  void stall(double seconds) { cycles_ += static_cast<std::uint64_t>(seconds * kHz); }

  std::uint32_t load(std::uint32_t address, unsigned size = 4) const;
  void store(std::uint32_t address, std::uint32_t value, unsigned size = 4);

  [[nodiscard]] bool has_symbol(const std::string& name) const { return symbols_.contains(name); }

  void misuse(const std::string& what) { misuses.push_back(what); }

  std::vector<std::string> misuses;
  std::uint64_t resets = 0;  // by the program or the watchdog
  std::function<void(std::uint32_t, std::uint32_t)>
      on_flash_write;         // address and word, before it is in memory
  bool reset_wanted = false;  // at the next call of hal_ticks

 private:
  static constexpr std::uint64_t kCyclesAnAccess = 320;
  static constexpr std::uint32_t kReturn = 0x1FFF0000;  // where interrupts return to

  struct Mapped {
    std::uint32_t base, size;
    Peripheral* peripheral;
    int interrupt;
  };

  void hook(const std::string& name, std::uint32_t address);
  std::uint32_t bus_read(std::uint32_t address);
  void bus_write(std::uint32_t address, unsigned size, std::uint32_t value);
  std::uint32_t system_read(std::uint32_t address);
  void system_write(std::uint32_t address, unsigned size, std::uint32_t value);
  void access();
  int pending() const;  // interrupt to take, or -1
  void take(int interrupt);
  std::uint32_t reg(int number) const;
  void set(int number, std::uint32_t value);
  void emulate(std::uint32_t from, std::uint32_t until);

  uc_engine* engine_ = nullptr;
  std::vector<Mapped> mapped_;
  std::set<std::string> symbols_;
  std::uint64_t cycles_ = 0;
  std::uint32_t enabled_[3] = {};
  std::uint8_t priority_[96] = {};
  std::map<std::uint32_t, std::uint32_t> system_;
  std::vector<Peripheral*> timed_;
  std::function<bool()> done_;
  bool finished_ = false;
  std::uint64_t until_ = 0;
};

}  // namespace lightwell::test
