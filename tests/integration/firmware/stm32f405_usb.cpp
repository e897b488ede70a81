// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/integration/firmware/stm32f405_usb.h"

#include <algorithm>

namespace lightwell::test {
namespace {

enum : std::uint32_t {  // registers
  kAhb = 0x08,
  kResetControl = 0x10,
  kInterrupts = 0x14,
  kInterruptMask = 0x18,
  kReceivePop = 0x20,
  kReceiveSize = 0x24,
  kTransmitSize0 = 0x28,
  kCoreConfiguration = 0x38,
  kCoreId = 0x40,
  kTransmitSize1 = 0x104,
  kDevice = 0x800,
  kDeviceControl = 0x804,
  kDeviceStatus = 0x808,
  kInMask = 0x810,
  kOutMask = 0x814,
  kEndpoints_ = 0x818,
  kEndpointMask = 0x81C,
  kEmptyMask = 0x834,
  kIn = 0x900,
  kOut = 0xB00,
  kFifo = 0x1000
};
enum : std::uint32_t {  // of an endpoint's control
  kActive = 1u << 15,
  kNak = 1u << 17,
  kStalled = 1u << 21,
  kClearNak = 1u << 26,
  kSetNak = 1u << 27,
  kDisable = 1u << 30,
  kEnable = 1u << 31,
  kKept = 0x03EC87FFu & ~kNak
};
enum : std::uint32_t {
  kDone = 1,
  kDisabled = 1u << 1,
  kSetupDone = 1u << 3,
  kNakEffective = 1u << 6,
  kEmpty = 1u << 7
};
enum : unsigned { kOutReceived = 2, kOutDone = 3, kSetupComplete = 4, kSetupReceived = 6 };

}  // namespace

unsigned Stm32F405Usb::Endpoint::packet(unsigned number) const {
  return number == 0 ? 64u >> (control & 3u) : control & 0x7FFu;
}

void Stm32F405Usb::reset() {
  plain_.reset();
  interrupts_ = 0;
  in_ = {};
  out_ = {};
  received_.clear();
  reading_.clear();
  out_nak_ = false;
  address_ = 0;
  plain_.write(kDeviceControl, 2);  // soft-disconnected
}

bool Stm32F405Usb::attached() const {
  auto& plain = const_cast<PlainRegisters&>(plain_);
  const std::uint32_t general = plain.read(kCoreConfiguration);
  return (general >> 16 & 1u) != 0 && (general >> 21 & 1u) != 0 && (plain.read(kDeviceControl) & 2u) == 0;
}

void Stm32F405Usb::bus_reset() {
  address_ = 0;
  for (auto& endpoint : in_)
    endpoint = {.control = endpoint.control & ~kEnable, .interrupts = 0, .size = 0, .fifo = {}};
  for (auto& endpoint : out_) endpoint.control &= ~kEnable;
  received_.clear();
  plain_.write(kDeviceStatus, 3u << 1);  // full speed
  interrupts_ |= kBusReset | kEnumerated;
}

bool Stm32F405Usb::answers(std::uint8_t address) const {
  return attached() && address == address_;
}

void Stm32F405Usb::receive(unsigned kind, unsigned endpoint, const std::vector<std::uint8_t>& bytes) {
  received_.push_back({kind << 17 | static_cast<std::uint32_t>(bytes.size()) << 4 | endpoint, bytes});
}

Stm32F405Usb::Answer Stm32F405Usb::setup(std::uint8_t address, const std::array<std::uint8_t, 8>& request) {
  if (!answers(address)) return Answer::kSilence;
  in_[0].control = (in_[0].control & ~kStalled) | kNak;
  out_[0].control = (out_[0].control & ~(kStalled | kEnable)) | kNak;
  receive(kSetupReceived, 0, {request.begin(), request.end()});
  receive(kSetupComplete, 0, {});
  return Answer::kAck;
}

Stm32F405Usb::Answer Stm32F405Usb::out(std::uint8_t address, unsigned n,
                                       const std::vector<std::uint8_t>& packet) {
  auto& endpoint = out_.at(n);
  if (!answers(address) || (n > 0 && (endpoint.control & kActive) == 0)) return Answer::kSilence;
  if ((endpoint.control & kStalled) != 0) return Answer::kStall;
  unsigned used = 0;
  for (const auto& entry : received_) used += 1 + (static_cast<unsigned>(entry.bytes.size()) + 3) / 4;
  const bool room = used + 2 + (packet.size() + 3) / 4 <= plain_.read(kReceiveSize);
  if ((endpoint.control & kEnable) == 0 || (endpoint.control & kNak) != 0 || out_nak_ ||
      endpoint.packets() == 0 || !room)
    return Answer::kNak;
  if (packet.size() > endpoint.packet(n == 0 ? 0 : n) || packet.size() > endpoint.left())
    chip_.misuse("babble");
  const bool last = packet.size() < endpoint.packet(n) || endpoint.packets() == 1;
  endpoint.size = (endpoint.size & ~(0x7FFFFu | 0x3FFu << 19)) | (endpoint.packets() - 1u) << 19 |
                  (endpoint.left() - static_cast<unsigned>(packet.size()));
  receive(kOutReceived, n, packet);
  if (last) {
    endpoint.control = (endpoint.control & ~kEnable) | kNak;
    receive(kOutDone, n, {});
  }
  return Answer::kAck;
}

Stm32F405Usb::Answer Stm32F405Usb::in(std::uint8_t address, unsigned n, std::vector<std::uint8_t>& packet) {
  auto& endpoint = in_.at(n);
  packet.clear();
  if (!answers(address) || (n > 0 && (endpoint.control & kActive) == 0)) return Answer::kSilence;
  if ((endpoint.control & kStalled) != 0) return Answer::kStall;
  const std::size_t due = std::min<std::size_t>(endpoint.packet(n), endpoint.fifo.size() + endpoint.left());
  if ((endpoint.control & kEnable) == 0 || (endpoint.control & kNak) != 0 || endpoint.packets() == 0 ||
      endpoint.fifo.size() < due)
    return Answer::kNak;
  packet.assign(endpoint.fifo.begin(), endpoint.fifo.begin() + static_cast<std::ptrdiff_t>(due));
  endpoint.fifo.erase(endpoint.fifo.begin(), endpoint.fifo.begin() + static_cast<std::ptrdiff_t>(due));
  endpoint.size -= 1u << 19;
  if (endpoint.packets() == 0) {
    endpoint.control = (endpoint.control & ~kEnable) | kNak;
    endpoint.interrupts |= kDone;
  }
  if (n == 0)
    address_ = static_cast<std::uint8_t>(plain_.read(kDevice) >> 4 & 0x7Fu);  // holds from a status stage on
  return Answer::kAck;
}

bool Stm32F405Usb::in_raised(unsigned n) const {
  auto& plain = const_cast<PlainRegisters&>(plain_);
  return (in_[n].interrupts & plain.read(kInMask)) != 0 ||
         (in_[n].fifo.empty() && (plain.read(kEmptyMask) >> n & 1u) != 0);
}

std::uint32_t Stm32F405Usb::endpoint_interrupts() const {
  auto& plain = const_cast<PlainRegisters&>(plain_);
  std::uint32_t raised = 0;
  for (unsigned n = 0; n < kEndpoints; ++n) {
    if (in_raised(n)) raised |= 1u << n;
    if ((out_[n].interrupts & plain.read(kOutMask)) != 0) raised |= 1u << (16 + n);
  }
  return raised;
}

std::uint32_t Stm32F405Usb::global_interrupts() const {
  auto& plain = const_cast<PlainRegisters&>(plain_);
  const std::uint32_t raised = endpoint_interrupts() & plain.read(kEndpointMask);
  return interrupts_ | (received_.empty() ? 0u : 1u << 4) | (out_nak_ ? 1u << 7 : 0u) |
         ((raised & 0xFFFFu) != 0 ? 1u << 18 : 0u) | ((raised >> 16) != 0 ? 1u << 19 : 0u);
}

bool Stm32F405Usb::interrupt() const {
  auto& plain = const_cast<PlainRegisters&>(plain_);
  return (plain.read(kAhb) & 1u) != 0 && (global_interrupts() & plain.read(kInterruptMask)) != 0;
}

std::uint32_t Stm32F405Usb::pop() {
  if (received_.empty()) {
    chip_.misuse("USB: nothing to pop");
    return 0;
  }
  if (!reading_.empty()) chip_.misuse("USB: a packet was not read");
  const Received entry = received_.front();
  received_.pop_front();
  reading_.assign(entry.bytes.begin(), entry.bytes.end());
  const unsigned n = entry.status & 15u;
  if (entry.status >> 17 == kOutDone) out_[n].interrupts |= kDone;
  if (entry.status >> 17 == kSetupComplete) out_[n].interrupts |= kSetupDone;
  return entry.status;
}

std::uint32_t Stm32F405Usb::read_endpoint(unsigned n, bool in, std::uint32_t offset) const {
  const auto& endpoint = in ? in_[n] : out_[n];
  switch (offset) {
    case 0x00:
      return endpoint.control | (n == 0 ? kActive : 0u);
    case 0x08:
      return endpoint.interrupts | (in && endpoint.fifo.empty() ? kEmpty : 0u);
    case 0x10:
      return endpoint.size;
    case 0x18:
      return in ? depth(n) - (static_cast<unsigned>(endpoint.fifo.size()) + 3) / 4 : 0;
    default:
      return 0;
  }
}

void Stm32F405Usb::write_endpoint(unsigned n, bool in, std::uint32_t offset, std::uint32_t value) {
  auto& endpoint = in ? in_[n] : out_[n];
  if (offset == 0x08) endpoint.interrupts &= ~value;
  if (offset == 0x10) endpoint.size = value;
  if (offset != 0x00) return;
  // Of endpoint 0 the next SETUP ends a stall, not the program.
  const std::uint32_t sticky = endpoint.control & (kEnable | kNak | (n == 0 ? kStalled : 0u));
  endpoint.control = (value & kKept) | sticky;
  if ((value & kClearNak) != 0) endpoint.control &= ~kNak;
  if ((value & kSetNak) != 0) {
    endpoint.control |= kNak;
    endpoint.interrupts |= kNakEffective;
  }
  if ((value & kDisable) != 0 && (sticky & kEnable) != 0) {
    if ((endpoint.control & kNak) == 0 && !out_nak_)
      chip_.misuse("USB: an endpoint was disabled that does not NAK");
    endpoint.control &= ~kEnable;
    endpoint.interrupts |= kDisabled;
  } else if ((value & kEnable) != 0) {
    endpoint.control |= kEnable;
  }
}

unsigned Stm32F405Usb::depth(unsigned n) const {
  auto& plain = const_cast<PlainRegisters&>(plain_);
  return plain.read(n == 0 ? +kTransmitSize0 : kTransmitSize1 + 4 * (n - 1)) >> 16;
}

void Stm32F405Usb::write_fifo(unsigned n, std::uint32_t value) {
  auto& endpoint = in_.at(n);
  if (endpoint.left() == 0) chip_.misuse("USB: more was written to a FIFO than its transfer has");
  if ((endpoint.fifo.size() + 3) / 4 >= depth(n)) chip_.misuse("USB: FIFO overrun");
  for (unsigned i = 0; i < 4 && endpoint.left() > 0; ++i) {
    endpoint.fifo.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
    --endpoint.size;
  }
}

// Of all FIFOs in use: within the 320 words, and apart.
void Stm32F405Usb::check_fifos() {
  std::uint32_t lowest = kFifoWords;
  for (unsigned n = 0; n < kEndpoints; ++n) {
    const std::uint32_t at = plain_.read(n == 0 ? +kTransmitSize0 : kTransmitSize1 + 4 * (n - 1));
    if (at == 0) continue;
    if ((at & 0xFFFFu) + (at >> 16) > lowest) chip_.misuse("USB: FIFOs overlap");
    lowest = at & 0xFFFFu;
  }
  if (plain_.read(kReceiveSize) > lowest) chip_.misuse("USB: the receive FIFO reaches into another");
}

std::uint32_t Stm32F405Usb::read(std::uint32_t offset) {
  if (offset >= kFifo) {
    std::uint32_t word = 0;
    for (unsigned i = 0; i < 4 && !reading_.empty(); ++i) {
      word |= std::uint32_t{reading_.front()} << (8 * i);
      reading_.pop_front();
    }
    return word;
  }
  if (offset >= kIn && offset < kIn + kEndpoints * 0x20)
    return read_endpoint((offset - kIn) / 0x20, true, offset % 0x20);
  if (offset >= kOut && offset < kOut + kEndpoints * 0x20)
    return read_endpoint((offset - kOut) / 0x20, false, offset % 0x20);
  switch (offset) {
    case kResetControl:
      return 1u << 31;  // idle: what was asked for is done
    case kInterrupts:
      return global_interrupts();
    case kReceivePop:
      return pop();
    case kCoreId:
      return 0x4F54281Au;
    case kEndpoints_:
      return endpoint_interrupts();
    default:
      return plain_.read(offset);
  }
}

void Stm32F405Usb::write(std::uint32_t offset, std::uint32_t value) {
  if (!clocked()) chip_.misuse("USB: no clock of 48 MHz");
  if (offset >= kFifo) return write_fifo((offset - kFifo) / 0x1000, value);
  if (offset >= kIn && offset < kIn + kEndpoints * 0x20)
    return write_endpoint((offset - kIn) / 0x20, true, offset % 0x20, value);
  if (offset >= kOut && offset < kOut + kEndpoints * 0x20)
    return write_endpoint((offset - kOut) / 0x20, false, offset % 0x20, value);
  if (offset == kInterrupts) {
    interrupts_ &= ~value;
    return;
  }
  if (offset == kResetControl) {
    if ((value & 1u) != 0) {
      const std::uint32_t general = plain_.read(kCoreConfiguration);
      reset();
      plain_.write(kCoreConfiguration, general);
    }
    if ((value >> 5 & 1u) != 0) in_.at(value >> 6 & 3u).fifo.clear();
    return;
  }
  if (offset == kDeviceControl) {
    if ((value >> 9 & 1u) != 0) out_nak_ = true;
    if ((value >> 10 & 1u) != 0) out_nak_ = false;
    value &= ~(3u << 9);
  }
  plain_.write(offset, value);
  if (offset == kTransmitSize0 || (offset >= kTransmitSize1 && offset < kTransmitSize1 + 12)) check_fifos();
}

}  // namespace lightwell::test
