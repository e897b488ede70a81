// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "daemon/capture/capture_session.h"

namespace lightwell {

// What lightwell-libcamera and the program that started it say to each other, over a socket that keeps messages whole
// (AF_UNIX, SOCK_SEQPACKET). Both are of one build: values are sent as they lie in memory.
struct LibcameraMessage {
  static constexpr std::size_t kMostBuffers = 64;

  // fault: no frames, and why; the process ends. ready: once, with the descriptors of the buffers. go: from the host, once
  // it has mapped them. frame: a buffer is the host's, until give_back.
  enum class Kind : std::uint32_t { fault, ready, go, frame, give_back };
  struct Fault {
    SourceState state;
    std::array<char, 4000> message;
  };
  struct Ready {
    std::array<char, 128> name;
    std::array<char, 64> device_format;
    std::array<char, 1000> remark;
    std::uint32_t fourcc;  // with the modifier: as LibcameraFormat
    std::uint64_t modifier;
    std::int32_t width, height;
    std::uint64_t stride;
    double rate_hz, exposure_us;
    std::uint32_t buffers;
    struct Buffer {
      std::uint64_t begin, bytes;  // of the picture in it, and of it whole
    };
    std::array<Buffer, kMostBuffers> buffer;
  };
  struct Frame {
    std::uint32_t buffer;
    SessionFrame::Outcome outcome;
    SessionFrame::Stamp stamp;
    std::uint64_t frame_id;
    std::int64_t t_stamp_mono_ns, received_mono_ns;
    double exposure_us, gain_db, rate_hz;
  };

  Kind kind;
  union {
    Fault fault;
    Ready ready;
    Frame frame;
    std::uint32_t buffer;  // of give_back
  };
};

template <std::size_t size>
void put_text(std::array<char, size>& field, const std::string& text) {
  field.fill('\0');
  text.copy(field.data(), size - 1);
}

// False: nobody listens any more. Any thread; neither waits nor allocates: what may be under way is less than a socket holds.
bool send_message(int fd, const LibcameraMessage& message, std::span<const int> descriptors = {}) noexcept;
// Waits for one. False: the other end is gone. descriptors: those that came with it, to be closed by the caller.
bool receive_message(int fd, LibcameraMessage& message, std::vector<int>* descriptors = nullptr);

}  // namespace lightwell
