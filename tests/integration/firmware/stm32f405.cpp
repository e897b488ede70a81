// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/integration/firmware/stm32f405.h"

#include <elf.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>

namespace lightwell::test {
namespace {

constexpr std::uint32_t kRam = 0x20000000, kRamSize = 0x20000;
constexpr std::uint32_t kSystemMemory = 0x1FFF0000, kUniqueId = 0x1FFF7A10;
constexpr std::uint32_t kPeripherals = 0x40000000, kPeripheralsSize = 0x80000;
constexpr std::uint32_t kUsb = 0x50000000, kUsbSize = 0x40000;
constexpr std::uint32_t kSystem = 0xE000E000, kSystemSize = 0x1000;
constexpr std::uint32_t kVectors = 0xE000ED08, kResetControl = 0xE000ED0C;
constexpr std::uint64_t kPatienceUs =
    60'000'000;  // of this machine's time: a program that hangs ends the test

void check(uc_err error) {
  if (error != UC_ERR_OK) throw std::runtime_error(uc_strerror(error));
}

}  // namespace

Stm32F405::Stm32F405() {
  check(uc_open(UC_ARCH_ARM, static_cast<uc_mode>(UC_MODE_THUMB | UC_MODE_MCLASS), &engine_));
  check(uc_ctl_set_cpu_model(engine_, UC_CPU_ARM_CORTEX_M4));
  check(uc_mem_map(engine_, kFlash, kFlashSize, UC_PROT_ALL));
  check(uc_mem_map(engine_, kRam, kRamSize, UC_PROT_ALL));
  check(uc_mem_map(engine_, kSystemMemory, 0x10000, UC_PROT_ALL));
  const auto map = [this](std::uint32_t base, std::uint32_t size, uc_cb_mmio_read_t read,
                          uc_cb_mmio_write_t write) {
    check(uc_mmio_map(engine_, base, size, read, this, write, this));
  };
  map(
      kPeripherals, kPeripheralsSize,
      [](uc_engine*, std::uint64_t offset, unsigned, void* self) -> std::uint64_t {
        return static_cast<Stm32F405*>(self)->bus_read(kPeripherals + static_cast<std::uint32_t>(offset));
      },
      [](uc_engine*, std::uint64_t offset, unsigned size, std::uint64_t value, void* self) {
        static_cast<Stm32F405*>(self)->bus_write(kPeripherals + static_cast<std::uint32_t>(offset), size,
                                                 static_cast<std::uint32_t>(value));
      });
  map(
      kUsb, kUsbSize,
      [](uc_engine*, std::uint64_t offset, unsigned, void* self) -> std::uint64_t {
        return static_cast<Stm32F405*>(self)->bus_read(kUsb + static_cast<std::uint32_t>(offset));
      },
      [](uc_engine*, std::uint64_t offset, unsigned size, std::uint64_t value, void* self) {
        static_cast<Stm32F405*>(self)->bus_write(kUsb + static_cast<std::uint32_t>(offset), size,
                                                 static_cast<std::uint32_t>(value));
      });
  map(
      kSystem, kSystemSize,
      [](uc_engine*, std::uint64_t offset, unsigned, void* self) -> std::uint64_t {
        return static_cast<Stm32F405*>(self)->system_read(kSystem + static_cast<std::uint32_t>(offset));
      },
      [](uc_engine*, std::uint64_t offset, unsigned size, std::uint64_t value, void* self) {
        static_cast<Stm32F405*>(self)->system_write(kSystem + static_cast<std::uint32_t>(offset), size,
                                                    static_cast<std::uint32_t>(value));
      });
  const std::vector<std::uint8_t> erased(kFlashSize, 0xFF);
  check(uc_mem_write(engine_, kFlash, erased.data(), erased.size()));
  check(uc_mem_write(engine_, kUniqueId, kSerial, sizeof kSerial));
  const auto at_write =
      +[](uc_engine*, uc_mem_type, std::uint64_t address, int, std::int64_t value, void* context) {
        auto* self = static_cast<Stm32F405*>(context);
        if (self->on_flash_write)
          self->on_flash_write(static_cast<std::uint32_t>(address), static_cast<std::uint32_t>(value));
      };
  uc_hook hook;
  check(uc_hook_add(engine_, &hook, UC_HOOK_MEM_WRITE, reinterpret_cast<void*>(at_write), this, kFlash,
                    kFlash + kFlashSize - 1));
}

Stm32F405::~Stm32F405() {
  uc_close(engine_);
}

void Stm32F405::load_bytes(const std::vector<std::uint8_t>& bytes, std::uint32_t address) {
  check(uc_mem_write(engine_, address, bytes.data(), bytes.size()));
}

void Stm32F405::load_program(const std::string& elf, bool into_flash) {
  std::ifstream file(elf, std::ios::binary);
  const std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
  if (bytes.size() < sizeof(Elf32_Ehdr)) throw std::runtime_error(elf + ": not an ELF file");
  const auto* header = reinterpret_cast<const Elf32_Ehdr*>(bytes.data());
  const auto* segments = reinterpret_cast<const Elf32_Phdr*>(bytes.data() + header->e_phoff);
  for (unsigned i = 0; i < header->e_phnum && into_flash; ++i)
    if (segments[i].p_type == PT_LOAD && segments[i].p_filesz > 0)
      check(uc_mem_write(engine_, segments[i].p_paddr, bytes.data() + segments[i].p_offset,
                         segments[i].p_filesz));
  const auto* sections = reinterpret_cast<const Elf32_Shdr*>(bytes.data() + header->e_shoff);
  for (unsigned i = 0; i < header->e_shnum; ++i) {
    if (sections[i].sh_type != SHT_SYMTAB) continue;
    const auto* symbols = reinterpret_cast<const Elf32_Sym*>(bytes.data() + sections[i].sh_offset);
    const char* names = bytes.data() + sections[sections[i].sh_link].sh_offset;
    for (unsigned k = 0; k < sections[i].sh_size / sizeof(Elf32_Sym); ++k) {
      symbols_.insert(names + symbols[k].st_name);
      hook(names + symbols[k].st_name, symbols[k].st_value & ~1u);
    }
  }
}

// A hook on one instruction costs nothing elsewhere, and to stop there is exact; Unicorn's stop within an access of a register
// would run part of its block again.
void Stm32F405::hook(const std::string& name, std::uint32_t address) {
  const auto at_ticks = +[](uc_engine* engine, std::uint64_t, std::uint32_t, void* context) {
    auto* self = static_cast<Stm32F405*>(context);
    if (self->pending() >= 0 || self->reset_wanted || self->cycles_ >= self->until_ ||
        (self->finished_ = self->done_()))
      uc_emu_stop(engine);
  };
  // A loop that waits for the watchdog: a millisecond a turn.
  const auto at_hang = +[](uc_engine* engine, std::uint64_t, std::uint32_t, void* context) {
    auto* self = static_cast<Stm32F405*>(context);
    self->stall(1e-3);
    self->access();
    if (self->reset_wanted || self->cycles_ >= self->until_) uc_emu_stop(engine);
  };
  uc_hook added;
  if (name == "hal_ticks")
    check(uc_hook_add(engine_, &added, UC_HOOK_CODE, reinterpret_cast<void*>(at_ticks), this, address,
                      address));
  if (name == "hang")
    check(
        uc_hook_add(engine_, &added, UC_HOOK_CODE, reinterpret_cast<void*>(at_hang), this, address, address));
}

void Stm32F405::add(std::uint32_t base, std::uint32_t size, Peripheral& peripheral, int interrupt) {
  mapped_.push_back({base, size, &peripheral, interrupt});
  if (peripheral.timed()) timed_.push_back(&peripheral);
}

std::uint32_t Stm32F405::reg(int number) const {
  std::uint32_t value = 0;
  check(uc_reg_read(engine_, number, &value));
  return value;
}

void Stm32F405::set(int number, std::uint32_t value) {
  check(uc_reg_write(engine_, number, &value));
}

std::uint32_t Stm32F405::load(std::uint32_t address, unsigned size) const {
  std::uint32_t value = 0;
  check(uc_mem_read(engine_, address, &value, size));
  return value;
}

void Stm32F405::store(std::uint32_t address, std::uint32_t value, unsigned size) {
  check(uc_mem_write(engine_, address, &value, size));
}

void Stm32F405::reset() {
  reset_wanted = false;
  std::fill(std::begin(enabled_), std::end(enabled_), 0u);
  std::fill(std::begin(priority_), std::end(priority_), std::uint8_t{0});
  system_.clear();
  for (const auto& block : mapped_) block.peripheral->reset();
  set(UC_ARM_REG_CONTROL, 0);
  set(UC_ARM_REG_PRIMASK, 0);
  set(UC_ARM_REG_SP, load(kFlash));
  set(UC_ARM_REG_PC, load(kFlash + 4) | 1u);
}

void Stm32F405::emulate(std::uint32_t from, std::uint32_t until) {
  const uc_err error = uc_emu_start(engine_, from | 1u, until, kPatienceUs, 0);
  if (error != UC_ERR_OK)
    throw std::runtime_error(std::string(uc_strerror(error)) + " at " + std::to_string(reg(UC_ARM_REG_PC)));
}

bool Stm32F405::run(double seconds, const std::function<bool()>& done) {
  done_ = done;
  until_ = cycles_ + static_cast<std::uint64_t>(seconds * kHz);
  finished_ = done();
  while (!finished_ && cycles_ < until_) {
    if (reset_wanted) {
      ++resets;
      reset();
    }
    if (const int interrupt = pending(); interrupt >= 0) {
      take(interrupt);
      continue;
    }
    const std::uint64_t before = cycles_;
    emulate(reg(UC_ARM_REG_PC), 0xFFFFFFFE);
    if (cycles_ == before && pending() < 0 && !reset_wanted && !finished_)
      throw std::runtime_error("the program hangs at " + std::to_string(reg(UC_ARM_REG_PC)));
  }
  return finished_;
}

int Stm32F405::pending() const {
  int chosen = -1;
  for (const auto& block : mapped_) {
    const int n = block.interrupt;
    if (n < 0 || (enabled_[n / 32] >> (n % 32) & 1u) == 0 || !block.peripheral->interrupt()) continue;
    if (chosen < 0 || priority_[n] < priority_[chosen]) chosen = n;
  }
  return chosen >= 0 && reg(UC_ARM_REG_PRIMASK) == 0 ? chosen : -1;
}

void Stm32F405::take(int interrupt) {
  uc_context* context = nullptr;
  check(uc_context_alloc(engine_, &context));
  check(uc_context_save(engine_, context));
  const std::uint32_t vectors = system_.contains(kVectors) ? system_[kVectors] : kFlash;
  set(UC_ARM_REG_SP, load(vectors) - 16u);  // the main stack, but for what the start left there
  set(UC_ARM_REG_LR, kReturn | 1u);
  emulate(load(vectors + 4u * (16u + static_cast<unsigned>(interrupt))), kReturn);
  check(uc_context_restore(engine_, context));
  check(uc_context_free(context));
}

void Stm32F405::access() {
  cycles_ += kCyclesAnAccess;
  for (auto* peripheral : timed_) peripheral->advance(cycles_);
}

std::uint32_t Stm32F405::bus_read(std::uint32_t address) {
  access();
  for (const auto& block : mapped_)
    if (address - block.base < block.size) return block.peripheral->read((address - block.base) & ~3u);
  misuse("read of " + std::to_string(address));
  return 0;
}

void Stm32F405::bus_write(std::uint32_t address, unsigned size, std::uint32_t value) {
  access();
  if (size != 4) misuse("write of a part of " + std::to_string(address));
  for (const auto& block : mapped_)
    if (address - block.base < block.size) return block.peripheral->write(address - block.base, value);
  misuse("write of " + std::to_string(address));
}

std::uint32_t Stm32F405::system_read(std::uint32_t address) {
  access();
  return system_[address];
}

void Stm32F405::system_write(std::uint32_t address, unsigned size, std::uint32_t value) {
  access();
  const std::uint32_t offset = address - kSystem;
  if (offset - 0x100u < 12u) {
    enabled_[(offset - 0x100u) / 4u] |= value;
  } else if (offset - 0x180u < 12u) {
    enabled_[(offset - 0x180u) / 4u] &= ~value;
  } else if (offset - 0x400u < sizeof priority_) {
    for (unsigned i = 0; i < size; ++i)
      priority_[offset - 0x400u + i] = static_cast<std::uint8_t>(value >> (8u * i));
  } else {
    system_[address] = value;
    if (address == kResetControl && value == 0x05FA0004u) reset_wanted = true;
  }
}

}  // namespace lightwell::test
