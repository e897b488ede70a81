// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <linux/videodev2.h>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "daemon/capture/v4l2_calls.h"

namespace lightwell::test {

// What the fake device is; set before it is opened.
struct FakeV4l2Model {
  std::vector<std::uint32_t> formats = {V4L2_PIX_FMT_GREY};
  int width = 64, height = 48;
  int largest_width = 640, largest_height = 480;
  std::size_t padding = 0;  // bytes behind every line
  bool multi_planar = false, exports = true, has_rate = true;
  bool dv_timings = false;  // its input is one of digital video
  double rate_hz = 100;
  std::uint32_t stamp_flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_SOE;
  std::int64_t stamp_age_ns = 4'000'000;  // a stamp lies this long before its frame is ready
  struct Control {
    std::string name;
    std::uint32_t type = V4L2_CTRL_TYPE_INTEGER;
    std::int64_t minimum = 0, maximum = 100, step = 1, value = 0;
    std::uint32_t flags = 0;
    std::vector<std::string> menu;  // from minimum on; empty words are choices left out
  };
  std::map<std::uint32_t, Control> controls = {
      {V4L2_CID_EXPOSURE_ABSOLUTE,
       {"Exposure Time, Absolute", V4L2_CTRL_TYPE_INTEGER, 1, 1000, 1, 20, 0, {}}}};
};

// A V4L2 driver in this process, as strict as the kernel's videobuf2: formats cannot change while buffers exist,
// a buffer cannot be queued twice, a second opener gets no buffers, memory outlives the device where it is mapped.
// Every byte of frame n is n modulo 251, every byte of padding 0xee. Threading: every call from any thread.
class FakeV4l2 final : public V4l2Calls {
 public:
  static constexpr const char* kPath = "/dev/video-fake";

  explicit FakeV4l2(FakeV4l2Model model = {}) : model_(std::move(model)) {}
  ~FakeV4l2() override;

  // Frames come at the model's rate from now on, where somebody streams.
  void run();
  void hush();  // and no longer
  // One frame. lost: sequence numbers left out before it; bytes: of its payload that are filled, −1: all.
  // False: nobody streams or no buffer is queued, and the frame is lost.
  bool deliver(std::uint32_t flags = 0, std::uint32_t lost = 0, std::ptrdiff_t bytes = -1);
  void count_from(std::uint32_t sequence);  // the next frame's
  void unplug();
  void plug(const FakeV4l2Model& model);
  void plug();
  void break_off();  // every stream fails with EIO until it is started anew
  // The next ioctls of this kind fail.
  void fail(unsigned long request, int error, int times = 1 << 30);
  void set_input_status(std::uint32_t status);
  // What VIDIOC_QUERY_DV_TIMINGS finds, without an event; error 0: a picture of this size.
  void set_signal(int error, int width, int height);
  void change_source();                                       // the event
  void change_control(std::uint32_t id, std::int64_t value);  // by somebody else, with its event
  [[nodiscard]] std::int64_t control(std::uint32_t id);
  [[nodiscard]] int open_files();
  [[nodiscard]] int mappings();

  int open(const char* path) noexcept override;
  void close(int fd) noexcept override;
  int ioctl(int fd, unsigned long request, void* argument) noexcept override;
  void* map(int fd, std::size_t bytes, std::int64_t offset) noexcept override;
  void unmap(void* at, std::size_t bytes) noexcept override;
  Ready wait(int fd, int wake_fd, int timeout_ms) noexcept override;

 private:
  struct Buffer {
    int memory_fd = -1;
    std::byte* memory = nullptr;
    std::size_t bytes = 0;
    bool queued = false;
  };
  struct Done {
    std::uint32_t index, flags, sequence, bytes;
    std::int64_t stamp_ns;
  };
  struct File {
    bool gone = false, broken = false, streaming = false;
    std::vector<Buffer> buffers;
    std::deque<std::uint32_t> queue;
    std::deque<Done> done;
    std::deque<v4l2_event> events;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> subscribed;
  };

  int answer(File& file, unsigned long request, void* argument);
  int answer_timings(unsigned long request, void* argument);
  int answer_formats(File& file, unsigned long request, void* argument);
  int answer_controls(unsigned long request, void* argument);
  int answer_buffers(File& file, unsigned long request, void* argument);
  void free_buffers(File& file);
  void fill(v4l2_format& format) const;
  [[nodiscard]] std::size_t stride() const;
  [[nodiscard]] std::size_t size_image() const;
  [[nodiscard]] std::size_t buffer_bytes() const;
  [[nodiscard]] std::uint32_t type() const;
  bool deliver_locked(std::uint32_t flags, std::uint32_t lost, std::ptrdiff_t bytes);
  void tell(std::uint32_t event, std::uint32_t id, std::int64_t value);
  void ring_all();

  std::mutex mutex_;
  FakeV4l2Model model_;
  std::uint32_t fourcc_ = 0;  // in force; 0: the first
  bool plugged_ = true;
  std::uint32_t input_status_ = 0;
  int signal_error_ = 0, signal_width_ = 0, signal_height_ = 0;  // size 0: as it is set
  std::uint32_t sequence_ = 0, number_ = 0;
  std::map<int, File> files_;
  std::map<unsigned long, std::pair<int, int>> failures_;
  int mappings_ = 0;
  std::jthread clock_;
};

}  // namespace lightwell::test
