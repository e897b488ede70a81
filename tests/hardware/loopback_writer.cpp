// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/hardware/loopback_writer.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <chrono>

namespace lightwell::test {

LoopbackWriter::LoopbackWriter(const std::string& path, std::uint32_t fourcc, int width, int height)
    : fd_(::open(path.c_str(), O_RDWR | O_CLOEXEC)) {
  v4l2_format format{};
  format.type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
  v4l2_pix_format& p = format.fmt.pix;
  p.width = static_cast<__u32>(width);
  p.height = static_cast<__u32>(height);
  p.pixelformat = fourcc;
  p.field = V4L2_FIELD_NONE;
  if (::ioctl(fd_, VIDIOC_S_FMT, &format) != 0 || p.pixelformat != fourcc)
    ADD_FAILURE() << path << " does not take the format";
  bytes_ = p.sizeimage;
}

LoopbackWriter::~LoopbackWriter() {
  rest();
  if (fd_ >= 0) ::close(fd_);
}

bool LoopbackWriter::write(std::span<const std::byte> frame) const {
  return ::write(fd_, frame.data(), frame.size()) == static_cast<ssize_t>(frame.size());
}

void LoopbackWriter::run(double rate_hz, std::function<void(std::uint64_t, std::span<std::byte>)> make) {
  rest();
  thread_ = std::jthread([this, rate_hz, make = std::move(make)](const std::stop_token& stop) {
    std::vector<std::byte> frame(bytes_);
    const auto period = std::chrono::duration_cast<std::chrono::steady_clock::duration>(
        std::chrono::duration<double>(1 / rate_hz));
    auto due = std::chrono::steady_clock::now();
    for (std::uint64_t n = 0; !stop.stop_requested(); ++n) {
      make(n, frame);
      static_cast<void>(write(frame));
      due = std::max(due + period, std::chrono::steady_clock::now());
      std::this_thread::sleep_until(due);
    }
  });
}

}  // namespace lightwell::test
