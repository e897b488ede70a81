// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/sync/usb_link.h"

#include <algorithm>
#include <utility>

namespace lightwell {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

constexpr auto kPatience = milliseconds(1000);  // SyncLink::write

void LIBUSB_CALL take_back(libusb_transfer* transfer) {
  *static_cast<int*>(transfer->user_data) = 1;
}

Error ended_badly(const char* doing, libusb_transfer_status status) {
  const char* why = status == LIBUSB_TRANSFER_NO_DEVICE   ? "it is gone"
                    : status == LIBUSB_TRANSFER_TIMED_OUT ? "it has taken nothing for a second"
                    : status == LIBUSB_TRANSFER_OVERFLOW
                        ? "it sends more than a packet at once"
                        : "the transfer failed; it is gone, or the cable is bad";
  return {ErrorKind::failed, std::string("sync board: ") + doing + ": " + why};
}

}  // namespace

Error usb_error(const std::string& what, int code) {
  return {ErrorKind::failed, "sync board: " + what + ": " + libusb_strerror(static_cast<libusb_error>(code))};
}

UsbLink::UsbLink(UsbContext context, UsbHandle handle, const UsbBoardInterface& board)
    : context_(std::move(context)), handle_(std::move(handle)), board_(board) {
  // One packet each: a transfer of more would wait for a packet that is not full.
  for (Transfer& transfer : in_) transfer.bytes.resize(board_.packet);
}

UsbLink::~UsbLink() {
  call_back(in_);
  call_back(out_);
  libusb_release_interface(handle_.get(), board_.number);
}

Status UsbLink::start() {
  for (Transfer& transfer : in_)
    if (Status submitted = submit(transfer, board_.in); !submitted) return submitted;
  return {};
}

Status UsbLink::submit(Transfer& transfer, std::uint8_t endpoint) {
  const bool to_board = endpoint == board_.out;
  libusb_fill_bulk_transfer(transfer.usb.get(), handle_.get(), endpoint, transfer.bytes.data(),
                            static_cast<int>(transfer.bytes.size()), take_back, &transfer.ended,
                            to_board ? static_cast<unsigned>(kPatience.count()) : 0);
  // A board that asked for more than a packet must not wait for the rest of a full one.
  if (to_board) transfer.usb->flags = LIBUSB_TRANSFER_ADD_ZERO_PACKET;
  transfer.ended = 0;
  const int code = libusb_submit_transfer(transfer.usb.get());
  if (code == 0) return {};
  transfer.ended = 1;
  return code == LIBUSB_ERROR_NO_DEVICE ? Status(Error{ErrorKind::failed, "sync board: it is gone"})
                                        : Status(usb_error("submitting a transfer", code));
}

void UsbLink::wait_for(Transfer& transfer, milliseconds timeout) {
  timeval time{timeout.count() / 1000, timeout.count() % 1000 * 1000};
  libusb_handle_events_timeout_completed(context_.get(), &time, &transfer.ended);
}

template <std::size_t N>
void UsbLink::call_back(std::array<Transfer, N>& transfers) {
  for (Transfer& transfer : transfers)
    if (transfer.ended == 0) libusb_cancel_transfer(transfer.usb.get());
  for (Transfer& transfer : transfers)
    while (transfer.ended == 0) wait_for(transfer, kPatience);
}

// Of a halted endpoint no transfer may be on its way when the halt is cleared: both ends begin with the same data toggle.
Status UsbLink::resume_in() {
  call_back(in_);
  if (const int code = libusb_clear_halt(handle_.get(), board_.in); code != 0)
    return usb_error("clearing a halt", code);
  next_in_ = taken_ = 0;
  return start();
}

Status UsbLink::resume_out() {
  call_back(out_);
  if (const int code = libusb_clear_halt(handle_.get(), board_.out); code != 0)
    return usb_error("clearing a halt", code);
  // Part of the first may have arrived: a zero ends what it was, and all of it goes out again.
  std::vector<std::uint8_t>& first = out_[oldest_out_].bytes;
  first.insert(first.begin(), 0);
  for (std::size_t i = 0; i < unsent_; ++i)
    if (Status submitted = submit(out_[(oldest_out_ + i) % kOut], board_.out); !submitted) return submitted;
  return {};
}

Status UsbLink::take_sent() {
  while (unsent_ > 0 && out_[oldest_out_].ended != 0) {
    const libusb_transfer_status status = out_[oldest_out_].usb->status;
    if (status == LIBUSB_TRANSFER_STALL) return resume_out();
    if (status != LIBUSB_TRANSFER_COMPLETED) return ended_badly("writing", status);
    oldest_out_ = (oldest_out_ + 1) % kOut;
    --unsent_;
  }
  return {};
}

Result<std::size_t> UsbLink::read(std::span<std::uint8_t> buffer, milliseconds timeout) {
  if (Status sent = take_sent(); !sent) return sent.error();
  const auto deadline = Clock::now() + timeout;
  std::size_t size = 0;
  for (;;) {
    Transfer& next = in_[next_in_];
    if (next.ended == 0) {
      const auto left = std::chrono::ceil<milliseconds>(deadline - Clock::now());
      if (size > 0 || left <= milliseconds(0)) return size;
      wait_for(next, left);
      continue;
    }
    if (next.usb->status == LIBUSB_TRANSFER_STALL) {
      if (size > 0) return size;
      if (Status resumed = resume_in(); !resumed) return resumed.error();
      continue;
    }
    if (next.usb->status != LIBUSB_TRANSFER_COMPLETED) {
      if (size > 0) return size;  // what came before it ended; the next call says why
      return ended_badly("reading", next.usb->status);
    }
    const auto arrived =
        std::span(next.bytes).first(static_cast<std::size_t>(next.usb->actual_length)).subspan(taken_);
    const std::size_t taken = std::min(arrived.size(), buffer.size() - size);
    std::copy_n(arrived.begin(), taken, buffer.begin() + static_cast<std::ptrdiff_t>(size));
    size += taken;
    taken_ += taken;
    if (taken < arrived.size()) return size;
    taken_ = 0;
    next_in_ = (next_in_ + 1) % kIn;
    if (Status submitted = submit(next, board_.in); !submitted) return submitted.error();
  }
}

Status UsbLink::write(std::span<const std::uint8_t> bytes) {
  const auto deadline = Clock::now() + kPatience;
  for (;;) {
    if (Status sent = take_sent(); !sent) return sent;
    if (unsent_ < kOut) break;
    if (Clock::now() >= deadline) return ended_badly("writing", LIBUSB_TRANSFER_TIMED_OUT);
    wait_for(out_[oldest_out_], milliseconds(50));
  }
  Transfer& free = out_[(oldest_out_ + unsent_) % kOut];
  free.bytes.assign(bytes.begin(), bytes.end());
  if (Status submitted = submit(free, board_.out); !submitted) return submitted;
  ++unsent_;
  return {};
}

}  // namespace lightwell
