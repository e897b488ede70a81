// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/fake_v4l2.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include "daemon/capture/v4l2_format.h"
#include "daemon/clock.h"

namespace lightwell::test {
FakeV4l2::~FakeV4l2() {
  hush();
  for (auto& [fd, file] : files_) {
    free_buffers(file);
    ::close(fd);
  }
}

std::size_t FakeV4l2::stride() const {
  return v4l2_format_of(fourcc_)->line_bytes(model_.width) + model_.padding;
}
std::size_t FakeV4l2::size_image() const {
  return stride() * static_cast<std::size_t>(model_.height);
}
std::size_t FakeV4l2::buffer_bytes() const {
  const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  return (size_image() + page - 1) / page * page;
}
std::uint32_t FakeV4l2::type() const {
  return model_.multi_planar ? V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE : V4L2_BUF_TYPE_VIDEO_CAPTURE;
}

void FakeV4l2::run() {
  clock_ = std::jthread([this](const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      deliver();
      std::this_thread::sleep_for(std::chrono::duration<double>(1 / model_.rate_hz));
    }
  });
}

void FakeV4l2::hush() {
  clock_ = {};
}

bool FakeV4l2::deliver(std::uint32_t flags, std::uint32_t lost, std::ptrdiff_t bytes) {
  const std::lock_guard lock(mutex_);
  return deliver_locked(flags, lost, bytes);
}

bool FakeV4l2::deliver_locked(std::uint32_t flags, std::uint32_t lost, std::ptrdiff_t bytes) {
  for (auto& [fd, file] : files_) {
    if (!file.streaming || file.gone || file.broken) continue;
    sequence_ += lost;
    const std::uint32_t sequence = sequence_++;
    const auto content = static_cast<int>(number_++ % 251);
    if (file.queue.empty()) return false;
    const std::uint32_t index = file.queue.front();
    file.queue.pop_front();
    std::byte* line = file.buffers[index].memory;
    for (int y = 0; y < model_.height; ++y, line += stride()) {
      std::memset(line, content, stride() - model_.padding);
      std::memset(line + stride() - model_.padding, 0xee, model_.padding);
    }
    file.done.push_back(
        {index, flags | model_.stamp_flags, sequence,
         static_cast<std::uint32_t>(bytes < 0 ? static_cast<std::ptrdiff_t>(size_image()) : bytes),
         mono_now_ns() - model_.stamp_age_ns});
    ring_all();
    return true;
  }
  return false;
}

void FakeV4l2::count_from(std::uint32_t sequence) {
  const std::lock_guard lock(mutex_);
  sequence_ = sequence;
}

void FakeV4l2::ring_all() {
  for (const auto& [fd, file] : files_) ::eventfd_write(fd, 1);
}

void FakeV4l2::unplug() {
  const std::lock_guard lock(mutex_);
  plugged_ = false;
  for (auto& [fd, file] : files_) file.gone = true;
  ring_all();
}

void FakeV4l2::plug() {
  const std::lock_guard lock(mutex_);
  plugged_ = true;
  fourcc_ = 0;
  sequence_ = 0;
}

void FakeV4l2::plug(const FakeV4l2Model& model) {
  {
    const std::lock_guard lock(mutex_);
    model_ = model;
  }
  plug();
}

void FakeV4l2::break_off() {
  const std::lock_guard lock(mutex_);
  for (auto& [fd, file] : files_) file.broken = file.streaming;
  ring_all();
}

void FakeV4l2::fail(unsigned long request, int error, int times) {
  const std::lock_guard lock(mutex_);
  failures_[request] = {error, times};
  ring_all();
}

void FakeV4l2::set_input_status(std::uint32_t status) {
  const std::lock_guard lock(mutex_);
  input_status_ = status;
}

void FakeV4l2::set_signal(int error, int width, int height) {
  const std::lock_guard lock(mutex_);
  signal_error_ = error;
  signal_width_ = width;
  signal_height_ = height;
}

void FakeV4l2::tell(std::uint32_t event, std::uint32_t id, std::int64_t value) {
  for (auto& [fd, file] : files_) {
    const std::pair wanted(event, id);
    if (std::find(file.subscribed.begin(), file.subscribed.end(), wanted) == file.subscribed.end()) continue;
    v4l2_event e{};
    e.type = event;
    e.id = id;
    if (event == V4L2_EVENT_CTRL) {
      e.u.ctrl.changes = V4L2_EVENT_CTRL_CH_VALUE;
      e.u.ctrl.value = static_cast<__s32>(value);
    }
    file.events.push_back(e);
  }
  ring_all();
}

void FakeV4l2::change_source() {
  const std::lock_guard lock(mutex_);
  tell(V4L2_EVENT_SOURCE_CHANGE, 0, 0);
}

void FakeV4l2::change_control(std::uint32_t id, std::int64_t value) {
  const std::lock_guard lock(mutex_);
  model_.controls.at(id).value = value;
  tell(V4L2_EVENT_CTRL, id, value);
}

std::int64_t FakeV4l2::control(std::uint32_t id) {
  const std::lock_guard lock(mutex_);
  return model_.controls.at(id).value;
}

int FakeV4l2::open_files() {
  const std::lock_guard lock(mutex_);
  return static_cast<int>(files_.size());
}

int FakeV4l2::mappings() {
  const std::lock_guard lock(mutex_);
  return mappings_;
}

int FakeV4l2::open(const char* path) noexcept {
  const std::lock_guard lock(mutex_);
  if (path != std::string(kPath) || !plugged_) return -ENOENT;
  if (fourcc_ == 0) fourcc_ = model_.formats.front();
  const int fd = ::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
  files_[fd] = {};
  return fd;
}

void FakeV4l2::close(int fd) noexcept {
  const std::lock_guard lock(mutex_);
  if (const auto at = files_.find(fd); at != files_.end()) {
    free_buffers(at->second);
    files_.erase(at);
  }
  ::close(fd);
}

void FakeV4l2::free_buffers(File& file) {
  for (Buffer& buffer : file.buffers) {
    ::munmap(buffer.memory, buffer.bytes);
    ::close(buffer.memory_fd);
  }
  file.buffers.clear();
  file.queue.clear();
  file.done.clear();
}

void* FakeV4l2::map(int fd, std::size_t bytes, std::int64_t offset) noexcept {
  const std::lock_guard lock(mutex_);
  int memory = fd;  // of an exported buffer
  if (const auto at = files_.find(fd); at != files_.end()) {
    const auto index = static_cast<std::size_t>(offset) / buffer_bytes();
    if (index >= at->second.buffers.size()) return nullptr;
    memory = at->second.buffers[index].memory_fd;
  }
  void* mapped = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, memory, 0);
  if (mapped == MAP_FAILED) return nullptr;
  ++mappings_;
  return mapped;
}

void FakeV4l2::unmap(void* at, std::size_t bytes) noexcept {
  const std::lock_guard lock(mutex_);
  ::munmap(at, bytes);
  --mappings_;
}

V4l2Calls::Ready FakeV4l2::wait(int fd, int wake_fd, int timeout_ms) noexcept {
  const auto look = [&] {
    const std::lock_guard lock(mutex_);
    const File& file = files_.at(fd);
    return Ready{!file.done.empty(), !file.events.empty(), file.gone || file.broken || !file.streaming,
                 false};
  };
  Ready ready = look();
  std::array<pollfd, 2> fds = {{{fd, POLLIN, 0}, {wake_fd, POLLIN, 0}}};
  const bool at_once = ready.frame || ready.event || ready.broken;
  ::poll(fds.data(), fds.size(), at_once ? 0 : timeout_ms);
  eventfd_t count = 0;
  ::eventfd_read(fd, &count);
  ready = look();
  ready.woken = (fds[1].revents & POLLIN) != 0;
  return ready;
}

int FakeV4l2::ioctl(int fd, unsigned long request, void* argument) noexcept {
  const std::lock_guard lock(mutex_);
  File& file = files_.at(fd);
  if (file.gone) return -ENODEV;
  if (const auto at = failures_.find(request); at != failures_.end() && at->second.second > 0) {
    --at->second.second;
    return -at->second.first;
  }
  return answer(file, request, argument);
}

}  // namespace lightwell::test
