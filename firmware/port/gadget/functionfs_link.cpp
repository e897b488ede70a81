// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "firmware/port/gadget/functionfs_link.h"

#include <fcntl.h>
#include <linux/usb/functionfs.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

#include "firmware/port/gadget/descriptors.h"

namespace lightwell::sync_gadget {
namespace {

std::runtime_error failure(const std::string& what, int number) {
  return std::runtime_error(what + ": " + std::strerror(number));
}

void tell(int control, const std::vector<std::byte>& bytes, const std::string& what) {
  if (write(control, bytes.data(), bytes.size()) != static_cast<ssize_t>(bytes.size()))
    throw failure(what, errno);
}

}  // namespace

FunctionFsLink::File::File(const std::filesystem::path& path)
    : descriptor(open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC)) {
  if (descriptor < 0) throw failure(path.string(), errno);
}
FunctionFsLink::File::~File() {
  close(descriptor);
}

FunctionFsLink::FunctionFsLink(const std::filesystem::path& folder, std::chrono::milliseconds stall_every)
    : control_(folder / "ep0"),
      stall_every_(stall_every),
      next_stall_(std::chrono::steady_clock::now() + stall_every) {
  tell(control_.descriptor, descriptors(), "USB descriptors");
  tell(control_.descriptor, strings(), "USB strings");
  from_host_ = std::make_unique<File>(folder / "ep1");
  to_host_ = std::make_unique<File>(folder / "ep2");
  if (const int code = io_setup(kReads + 1, &context_); code < 0) throw failure("io_setup", -code);
  for (Transfer& read : reads_)
    io_prep_pread(&read.request, from_host_->descriptor, read.bytes.data(), read.bytes.size(), 0);
}

// Calls back what is on its way, and waits for it, while its buffers still stand.
FunctionFsLink::~FunctionFsLink() {
  io_destroy(context_);
}

void FunctionFsLink::take_events() {
  usb_functionfs_event event{};
  while (read(control_.descriptor, &event, sizeof event) == sizeof event) {
    switch (event.type) {
      case FUNCTIONFS_ENABLE:
        enabled_ = true;
        break;
      case FUNCTIONFS_DISABLE:
      case FUNCTIONFS_UNBIND:
        enabled_ = false;
        break;
      case FUNCTIONFS_SETUP:
        // No request of the control endpoint is ours: the wrong direction refuses it.
        if ((event.u.setup.bRequestType & USB_DIR_IN) != 0)
          (void)!read(control_.descriptor, nullptr, 0);
        else
          (void)!write(control_.descriptor, nullptr, 0);
        break;
      default:
        break;
    }
  }
}

void FunctionFsLink::take_ended(std::deque<std::uint8_t>& from_host) {
  std::array<io_event, kReads + 1> ended{};
  timespec at_once{};
  const int count = io_getevents(context_, 0, static_cast<long>(ended.size()), ended.data(), &at_once);
  for (int i = 0; i < count; ++i) {
    const io_event& event = ended[static_cast<std::size_t>(i)];
    if (event.obj == &write_.request) write_.on_its_way = false;
    for (Transfer& read : reads_) {
      if (event.obj != &read.request) continue;
      read.on_its_way = false;
      const auto size = static_cast<long>(event.res);  // negative: the host went away
      if (size > 0) from_host.insert(from_host.end(), read.bytes.begin(), read.bytes.begin() + size);
    }
  }
}

// False: no host is there.
bool FunctionFsLink::submit(Transfer& transfer) {
  iocb* request = &transfer.request;
  transfer.on_its_way = io_submit(context_, 1, &request) == 1;
  return transfer.on_its_way;
}

void FunctionFsLink::start_reads() {
  for (Transfer& read : reads_)
    if (!read.on_its_way && !submit(read)) return;
}

void FunctionFsLink::start_write(std::deque<std::uint8_t>& to_host) {
  if (write_.on_its_way || to_host.empty()) return;
  std::size_t size = std::min(to_host.size(), write_.bytes.size());
  // A transfer of whole packets would leave a host waiting for the short one that ends it.
  if (size % 64 == 0) --size;
  std::copy_n(to_host.begin(), size, write_.bytes.begin());
  io_prep_pwrite(&write_.request, to_host_->descriptor, write_.bytes.data(), size, 0);
  if (submit(write_)) to_host.erase(to_host.begin(), to_host.begin() + static_cast<std::ptrdiff_t>(size));
}

// FunctionFS halts an endpoint that is read or written against its direction. One that has something to send cannot be.
void FunctionFsLink::stall_if_due() {
  const auto now = std::chrono::steady_clock::now();
  if (stall_every_.count() == 0 || now < next_stall_ || write_.on_its_way) return;
  next_stall_ = now + stall_every_;
  std::uint8_t none = 0;
  (void)!read(to_host_->descriptor, &none, 1);
  (void)!write(from_host_->descriptor, &none, 1);
  std::fputs("halted both endpoints\n", stderr);
}

bool FunctionFsLink::move(std::deque<std::uint8_t>& from_host, std::deque<std::uint8_t>& to_host) {
  take_events();
  take_ended(from_host);
  if (!enabled_) return true;
  stall_if_due();
  start_reads();
  start_write(to_host);
  return true;
}

}  // namespace lightwell::sync_gadget
