// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// A GigE Vision camera for tests of what Aravis's fake camera has not: chunk data, a trigger input, PTP, frame ids of 64
// bits. Control is Aravis's, frames are our own. feature-camera XML FIRST_ID; "ready" on stdout when it listens.
// Frame n (from 0) has the id FIRST_ID + n, 16 bits wide where FIRST_ID is; every byte is n modulo 256; its chunks say an
// exposure of 1000 + n µs and a gain of n modulo 8 dB, whatever the registers say. Commands on stdin, one a line:
// trigger (an edge at Line0) | skip N (ids that no frame gets).
#include <arv.h>
#include <signal.h>
#include <sys/prctl.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <ctime>
#include <iostream>
#include <sstream>
#include <string>
#include <thread>

#include "tests/integration/capture/gvsp_sender.h"

namespace lightwell::test {
namespace {

constexpr std::uint32_t kWidth = 64, kHeight = 48, kMono8 = 0x01080001;
// Of feature_camera.xml.
enum Register : guint32 {
  acquisition = 0x500,
  frame_period = 0x504,
  exposure = 0x508,
  exposure_mode = 0x50c,
  trigger_mode = 0x510,
  trigger_source = 0x514,
  trigger_activation = 0x518,
  chunk_mode = 0x520,
  chunk_enable = 0x530,
  ptp_enable = 0x540,
  ptp_latch = 0x544,
  ptp_status = 0x548
};
// Of GigE Vision (2.0, section 28).
enum Bootstrap : guint32 {
  control_privilege = 0xa00,
  stream_port = 0xd00,
  packet_size = 0xd04,
  stream_address = 0xd18
};

class FeatureCamera {
 public:
  FeatureCamera(ArvFakeCamera* camera, std::uint64_t first_id)
      : camera_(camera), first_id_(first_id), wide_(first_id > 65535) {
    write(frame_period, 10'000);
    write(exposure, 500);
    write(exposure_mode, 2);
    write(trigger_source, 0);
    write(ptp_status, 1);
  }

  void trigger() { ++edges_; }
  void skip(std::uint64_t count) { skipped_ += count; }

  [[noreturn]] void run() {
    using namespace std::chrono_literals;
    auto due = std::chrono::steady_clock::now();
    for (;; std::this_thread::sleep_for(1ms)) {
      if (read(control_privilege) == 0) write(acquisition, 0);
      if (read(ptp_latch) != 0) {
        write(ptp_status, read(ptp_enable) != 0 ? 9 : 1);
        write(ptp_latch, 0);
      }
      const auto now = std::chrono::steady_clock::now();
      if (read(acquisition) == 0) {
        due = now;
        edges_ = 0;
      } else if (read(trigger_mode) != 0) {
        // Line0, rising edge, an exposure as long as it is set.
        if (read(trigger_source) != 1 || read(trigger_activation) != 1 || read(exposure_mode) != 1)
          edges_ = 0;
        for (; edges_ > 0; --edges_) send();
      } else if (now >= due) {
        due += std::chrono::microseconds(read(frame_period));
        send();
      }
    }
  }

 private:
  [[nodiscard]] guint32 read(guint32 address) const {
    guint32 value = 0;
    arv_fake_camera_read_register(camera_, address, &value);
    return value;
  }
  void write(guint32 address, guint32 value) { arv_fake_camera_write_register(camera_, address, value); }

  void send() {
    timespec now{};
    ::clock_gettime(CLOCK_TAI, &now);
    GvspSender::Frame frame;
    frame.id = first_id_ + skipped_ + n_;
    if (!wide_) frame.id = (frame.id - 1) % 65535 + 1;  // 65535 is followed by 1
    frame.t_ns =
        static_cast<std::uint64_t>(now.tv_sec) * 1'000'000'000 + static_cast<std::uint64_t>(now.tv_nsec);
    frame.pixel_format = kMono8;
    frame.width = kWidth;
    frame.height = kHeight;
    frame.chunks = read(chunk_mode) != 0;
    const std::vector<std::uint8_t> picture(std::size_t{kWidth} * kHeight, static_cast<std::uint8_t>(n_));
    BigEndian payload;
    payload.put(picture);
    const auto end_of = [&](std::uint32_t id, std::uint32_t bytes) { payload.put(id).put(bytes); };
    if (frame.chunks) {
      end_of(1, kWidth * kHeight);
      if (read(chunk_enable) != 0) payload.put(1000.0 + static_cast<double>(n_)), end_of(0xa0, 8);
      if (read(chunk_enable + 4) != 0) payload.put(static_cast<double>(n_ % 8)), end_of(0xa1, 8);
      if (read(chunk_enable + 8) != 0) payload.put(frame.t_ns), end_of(0xa2, 8);
    }
    sender_.send(frame, payload.bytes(), read(stream_address), static_cast<std::uint16_t>(read(stream_port)),
                 read(packet_size) & 0xffff, wide_);
    ++n_;
  }

  ArvFakeCamera* camera_;
  const std::uint64_t first_id_;
  const bool wide_;
  std::atomic<int> edges_{0};
  std::atomic<std::uint64_t> skipped_{0};
  std::uint64_t n_ = 0;
  GvspSender sender_;
};

}  // namespace
}  // namespace lightwell::test

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  auto* server = static_cast<ArvGvFakeCamera*>(g_object_new(ARV_TYPE_GV_FAKE_CAMERA, "interface-name",
                                                            "127.0.0.1", "serial-number", "FEATURES",
                                                            "genicam-filename", argv[1], nullptr));
  if (!arv_gv_fake_camera_is_running(server)) return 1;
  auto* camera = new lightwell::test::FeatureCamera(arv_gv_fake_camera_get_fake_camera(server),
                                                    std::strtoull(argv[2], nullptr, 10));
  std::thread([camera] { camera->run(); }).detach();
  std::cout << "ready" << std::endl;
  for (std::string line; std::getline(std::cin, line);) {
    std::istringstream words(line);
    std::string command;
    std::uint64_t value = 0;
    words >> command >> value;
    if (command == "trigger") camera->trigger();
    if (command == "skip") camera->skip(value);
  }
  std::_Exit(0);
}
