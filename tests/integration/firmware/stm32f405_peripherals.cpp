// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/integration/firmware/stm32f405_peripherals.h"

#include <algorithm>

namespace lightwell::test {

std::uint32_t Stm32F405Clocks::read(std::uint32_t offset) {
  std::uint32_t value = PlainRegisters::read(offset);
  if (offset == 0x00) {  // what is on and can run is ready
    if ((value & 1u) != 0) value |= 1u << 1;
    if ((value >> 16 & 1u) != 0 && crystal_) value |= 1u << 17;
    if (pll_hz(false) > 0) value |= 1u << 25;
  }
  if (offset == 0x08) value |= (value & 3u) << 2;
  return value;
}

void Stm32F405Clocks::reset() {
  PlainRegisters::reset();
  PlainRegisters::write(0x00, 1);
}

double Stm32F405Clocks::pll_hz(bool usb) {
  const std::uint32_t pll = PlainRegisters::read(0x04);
  const bool from_crystal = (pll >> 22 & 1u) != 0;
  if ((PlainRegisters::read(0x00) >> 24 & 1u) == 0 || (pll & 63u) == 0 || (from_crystal && !crystal_))
    return 0;
  const double base = (from_crystal ? 8e6 : 16e6) / (pll & 63u) * (pll >> 6 & 511u);
  return usb ? base / (pll >> 24 & 15u) : base / (2 * ((pll >> 16 & 3u) + 1));
}

void Stm32F405Gpio::write(std::uint32_t offset, std::uint32_t value) {
  if (offset == 0x18)
    output = (output & ~(value >> 16)) | (value & 0xFFFFu);
  else
    PlainRegisters::write(offset, value);
}

Stm32F405Flash::Stm32F405Flash(Stm32F405& chip) : chip_(chip) {
  chip.on_flash_write = [this](std::uint32_t address, std::uint32_t word) { program(address, word); };
}

void Stm32F405Flash::reset() {
  finish_program();
  control_ = 1u << 31;
  keys_ = 0;
}

std::uint32_t Stm32F405Flash::sector_start(unsigned sector) {
  if (sector < 4) return Stm32F405::kFlash + sector * 0x4000;
  return Stm32F405::kFlash + (sector == 4 ? 0x10000 : (sector - 4) * 0x20000);
}

void Stm32F405Flash::program(std::uint32_t address, std::uint32_t word) {
  finish_program();
  const bool cut = ++operations == cut_at;
  if ((control_ >> 31) != 0 || (control_ & 1u) == 0 || (control_ >> 8 & 3u) != 2 || address % 4 != 0)
    chip_.misuse("flash: a write that was not prepared");
  address_ = address;
  word_ = chip_.load(address) & word;
  if (word_ != word) chip_.misuse("flash: a word was programmed twice");
  written_ = true;
  if (!cut) return;
  word_ |= 0x0FF00FF0u & chip_.load(address);  // half of its bits had no time
  chip_.cut_power();
}

void Stm32F405Flash::finish_program() {
  if (written_) chip_.store(address_, word_);
  written_ = false;
}

std::uint32_t Stm32F405Flash::read(std::uint32_t offset) {
  finish_program();
  return offset == 0x10 ? control_ : 0;  // never busy: erases let time pass at once
}

void Stm32F405Flash::write(std::uint32_t offset, std::uint32_t value) {
  finish_program();
  if (offset == 0x04) {
    keys_ = value == 0x45670123u ? 1 : keys_ == 1 && value == 0xCDEF89ABu ? 2 : 0;
    if (keys_ == 2) control_ &= ~(1u << 31);
  }
  if (offset != 0x10) return;
  if ((control_ >> 31) != 0) {
    if (value != control_) chip_.misuse("flash: its control is locked");
    return;
  }
  control_ = value & ~(1u << 16);
  if ((value & 2u) == 0 || (value >> 16 & 1u) == 0) return;
  const unsigned sector = value >> 3 & 15u;
  if (sector == 0 || sector > 11) chip_.misuse("flash: erase of the boot program");
  const bool cut = ++operations == cut_at;
  const std::uint32_t end = sector_start(sector + 1);
  for (std::uint32_t at = sector_start(sector) + (cut ? (end - sector_start(sector)) / 2 : 0); at < end;
       at += 4)
    chip_.store(at, 0xFFFFFFFFu);
  if (cut) return chip_.cut_power();
  chip_.stall(sector < 4 ? 0.25 : sector == 4 ? 0.55 : 1.0);  // DS8626, table 40, words
}

void Stm32F405EdgeTimer::reset() {
  plain_.reset();
  status_ = enabled_ = 0;
  compare_ = {};
  running_ = false;
  drive(now_, false);
}

void Stm32F405EdgeTimer::drive(std::uint64_t tick, bool level) {
  if (level != line_) output.push_back({tick, level});
  line_ = level;
}

void Stm32F405EdgeTimer::apply_mode(std::uint64_t tick) {
  const unsigned mode = plain_.read(0x18) >> 4 & 7u;
  if (mode == 4) drive(tick, false);
}

void Stm32F405EdgeTimer::capture(const Coming& edge) {
  const unsigned i = edge.channel - 1;
  const unsigned pin = i;
  pins_.input = (pins_.input & ~(1u << pin)) | (edge.level ? 1u << pin : 0u);
  // Mode: 1 is the pin's own input. Polarity: 0 rising, 1 both (with its second bit).
  const unsigned mode = plain_.read(i < 2 ? 0x18 : 0x1C) >> (8 * (i % 2)) & 3u;
  const unsigned polarity = plain_.read(0x20) >> (4 * i) & 15u;
  if (mode != 1 || (polarity & 1u) == 0) return;
  const bool both = (polarity & 10u) == 10u;
  if (!both && edge.level != ((polarity & 2u) == 0)) return;
  if ((status_ >> edge.channel & 1u) != 0) status_ |= 1u << (8 + edge.channel);
  status_ |= 1u << edge.channel;
  compare_[i] = static_cast<std::uint32_t>(edge.tick - offset_);
}

void Stm32F405EdgeTimer::advance(std::uint64_t cycles) {
  const std::uint64_t ticks = cycles / 2;
  if (!running_) {
    now_ = ticks;
    return;
  }
  // The compare's tick, if it lies in (now, ticks].
  const std::uint64_t ahead =
      static_cast<std::uint32_t>(compare_[0] - static_cast<std::uint32_t>(now_ - offset_));
  const bool matches = ahead > 0 && ahead <= ticks - now_;
  if (matches) {
    const unsigned mode = plain_.read(0x18) >> 4 & 7u;
    if ((plain_.read(0x20) & 1u) != 0 && (mode == 1 || mode == 2)) drive(now_ + ahead, mode == 1);
    status_ |= 1u << 1;
  }
  now_ = ticks;
  for (auto edge = coming_.begin(); edge != coming_.end();)
    if (edge->tick <= now_) {
      capture(*edge);
      edge = coming_.erase(edge);
    } else {
      ++edge;
    }
}

std::uint32_t Stm32F405EdgeTimer::read(std::uint32_t offset) {
  switch (offset) {
    case 0x0C:
      return enabled_;
    case 0x10:
      return status_;
    case 0x24:
      return static_cast<std::uint32_t>(now_ - offset_);
    case 0x34:
    case 0x38:
    case 0x3C:
    case 0x40: {
      const unsigned channel = (offset - 0x34) / 4;
      if (channel > 0) status_ &= ~(1u << (channel + 1));  // reading a capture clears its flag
      return compare_[channel];
    }
    default:
      return plain_.read(offset);
  }
}

void Stm32F405EdgeTimer::write(std::uint32_t offset, std::uint32_t value) {
  if (offset == 0x00 && (value & 1u) != 0 && !running_) {
    running_ = true;
    offset_ = now_;
  }
  if (offset == 0x0C) enabled_ = value;
  if (offset == 0x10) status_ &= value;
  if (offset == 0x34) compare_[0] = value;
  plain_.write(offset, value);
  if (offset == 0x18) apply_mode(now_);
}

void Stm32F405Uart::reset() {
  received_ = false;
  control_ = 0;
}

void Stm32F405Uart::advance(std::uint64_t cycles) {
  now_ = cycles;
  if (coming_.empty() || received_ || now_ < next_) return;
  next_ = now_ + kByte;
  data_ = coming_.front();
  received_ = true;
  coming_.pop_front();
}

std::uint32_t Stm32F405Uart::read(std::uint32_t offset) {
  if (offset == 0x00) return (received_ ? 1u << 5 : 0u) | (now_ >= free_ ? 3u << 6 : 0u);
  if (offset == 0x0C) return control_;
  if (offset == 0x04) {
    received_ = false;
    return data_;
  }
  return 0;
}

void Stm32F405Uart::write(std::uint32_t offset, std::uint32_t value) {
  if (offset == 0x0C) control_ = value;
  if (offset != 0x04) return;
  sent.push_back(static_cast<std::uint8_t>(value));
  free_ = now_ + kByte;
}

void Stm32F405Light::Dma::reset() {
  PlainRegisters::reset();
  complete = interrupts = false;
}

std::uint32_t Stm32F405Light::Dma::read(std::uint32_t offset) {
  if (offset == 0x14) return left;
  if (offset == 0x00) return complete ? 1u << 5 : 0u;
  return PlainRegisters::read(offset);
}

void Stm32F405Light::Dma::write(std::uint32_t offset, std::uint32_t value) {
  PlainRegisters::write(offset, value);
  if (offset == 0x08 && (value >> 5 & 1u) != 0) complete = false;
  if (offset == 0x14) left = value;
  if (offset == 0x10) interrupts = (value >> 4 & 1u) != 0;
}

void Stm32F405Light::advance(std::uint64_t cycles) {
  if (cycles < next_) return;
  const bool goes = (timer.read(0x00) & 1u) != 0 && (timer.read(0x04) >> 4 & 7u) == 2 &&
                    (adc.read(0x08) & 1u) != 0 && (adc.read(0x08) >> 8 & 1u) != 0 &&
                    (adc.read(0x08) >> 24 & 15u) == 8 && (dma.PlainRegisters::read(0x10) & 1u) != 0;
  if (!goes) {
    next_ = cycles + Stm32F405::kHz / 100000;
    return;
  }
  while (next_ <= cycles) {
    const std::uint32_t size = dma.PlainRegisters::read(0x14);
    chip_.store(dma.PlainRegisters::read(0x1C) + 2 * (size - dma.left),
                code(static_cast<double>(next_) / Stm32F405::kHz) & 0xFFFu, 2);
    if (--dma.left == 0) {
      dma.left = size;
      dma.complete = true;
    }
    next_ += 2 * (std::uint64_t{timer.read(0x2C)} + 1);
  }
}

void Stm32F405I2c::reset() {
  plain_.reset();
  status_ = 0;
}

std::uint32_t Stm32F405I2c::read(std::uint32_t offset) {
  if (offset == 0x14) return status_;
  if (offset == 0x18 && (status_ & 2u) != 0) {  // after status 1: the address phase ends
    status_ &= ~2u;
    status_ |= reading_ ? 1u << 6 : 1u << 7;
    return 0;
  }
  if (offset == 0x10 && reading_) {
    const std::uint8_t byte = devices.at(device_)[register_ & 255u];
    ++register_;
    return byte;
  }
  return plain_.read(offset);
}

void Stm32F405I2c::write(std::uint32_t offset, std::uint32_t value) {
  if (offset == 0x14) status_ &= value;
  if (offset == 0x00) {
    if ((value >> 8 & 1u) != 0) status_ = 1;
    if ((value >> 9 & 1u) != 0 && !reading_) status_ = 0;
    value &= ~(3u << 8);
  }
  if (offset == 0x10) {
    if ((status_ & 1u) != 0) {
      device_ = value >> 1 & 0x7Fu;
      reading_ = (value & 1u) != 0;
      pointed_ = false;
      status_ = devices.contains(device_) ? 2u : 1u << 10;
    } else if (!reading_ && devices.contains(device_)) {
      if (pointed_)
        devices.at(device_)[register_++ & 255u] = static_cast<std::uint8_t>(value);
      else
        register_ = value & 255u;
      pointed_ = true;
      status_ |= 1u << 7 | 1u << 2;
    }
  }
  plain_.write(offset, value);
}

void Stm32F405Watchdog::write(std::uint32_t offset, std::uint32_t value) {
  if (offset == 0x04) prescaler_ = value & 7u;
  if (offset == 0x08) reload_ = value & 0xFFFu;
  if (offset != 0x00) return;
  if (value == 0xCCCCu) running_ = true;
  if (value == 0xCCCCu || value == 0xAAAAu) fed_ = chip_.cycles();
}

void Stm32F405Watchdog::advance(std::uint64_t cycles) {
  const double patience = (reload_ + 1) * (4u << prescaler_) / 32e3;
  if (running_ && static_cast<double>(cycles - fed_) > patience * Stm32F405::kHz) chip_.reset_wanted = true;
}

}  // namespace lightwell::test
