// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

namespace lightwell::test {

// Bytes in network order, one field after another.
class BigEndian {
 public:
  template <std::unsigned_integral Integer>
  BigEndian& put(Integer value) {
    for (std::size_t i = sizeof value; i-- > 0;)
      bytes_.push_back(static_cast<std::uint8_t>(value >> (8 * i) & 0xff));
    return *this;
  }
  BigEndian& put(double value) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    return put(bits);
  }
  BigEndian& put(std::span<const std::uint8_t> bytes) {
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    return *this;
  }
  [[nodiscard]] const std::vector<std::uint8_t>& bytes() const { return bytes_; }

 private:
  std::vector<std::uint8_t> bytes_;
};

// Sends frames as a GigE Vision camera does (GigE Vision Streaming Protocol, version 2.0, section 24): image payload with
// chunks, block ids of 16 or of 64 bits.
class GvspSender {
 public:
  struct Frame {
    std::uint64_t id = 0;
    std::uint64_t t_ns = 0;
    std::uint32_t pixel_format = 0, width = 0, height = 0;
    bool chunks = false;
  };

  GvspSender() : fd_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {}
  ~GvspSender() { ::close(fd_); }
  GvspSender(const GvspSender&) = delete;
  GvspSender& operator=(const GvspSender&) = delete;

  // packet_bytes: with the headers of IP and UDP, as GigE Vision counts
  void send(const Frame& frame, std::span<const std::uint8_t> payload, std::uint32_t address,
            std::uint16_t port, std::size_t packet_bytes, bool wide_ids) const {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_addr.s_addr = htonl(address);
    to.sin_port = htons(port);
    const auto packet = [&](std::uint32_t type, std::uint32_t number, std::span<const std::uint8_t> data) {
      BigEndian out;
      out.put(std::uint16_t{0});
      if (wide_ids)
        out.put(std::uint16_t{0}).put(std::uint32_t{0x80000000} | type << 24).put(frame.id).put(number);
      else
        out.put(static_cast<std::uint16_t>(frame.id)).put(type << 24 | number);
      out.put(data);
      static_cast<void>(::sendto(fd_, out.bytes().data(), out.bytes().size(), 0,
                                 reinterpret_cast<const sockaddr*>(&to), sizeof to));
    };
    BigEndian leader;
    leader.put(std::uint16_t{0})
        .put(static_cast<std::uint16_t>(frame.chunks ? 0x4001 : 0x0001))
        .put(frame.t_ns);
    leader.put(frame.pixel_format).put(frame.width).put(frame.height);
    leader.put(std::uint64_t{0}).put(std::uint32_t{0});  // no offset, no padding
    packet(1, 0, leader.bytes());
    const std::size_t block = packet_bytes - 20 - 8 - (wide_ids ? 20 : 8);
    std::uint32_t number = 1;
    for (std::size_t at = 0; at < payload.size(); at += block)
      packet(3, number++, payload.subspan(at, std::min(block, payload.size() - at)));
    packet(2, number, BigEndian().put(std::uint32_t{1}).put(frame.height).bytes());
  }

 private:
  int fd_;
};

}  // namespace lightwell::test
