// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <libusb.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "daemon/sync/sync_link.h"

namespace lightwell {

using UsbContext = std::shared_ptr<libusb_context>;
struct UsbHandleEnd {
  void operator()(libusb_device_handle* handle) const { libusb_close(handle); }
};
using UsbHandle = std::unique_ptr<libusb_device_handle, UsbHandleEnd>;

// The board's part of a device. Endpoint numbers are the device's to choose: they stand in its descriptor.
struct UsbBoardInterface {
  std::uint8_t number = 0, in = 0, out = 0;
  std::size_t packet = 64;  // bytes, of the endpoint to the host
};

// A link of asynchronous transfers: while the thread does other things the kernel goes on taking in what the board says,
// and sends what it was told. An endpoint that has halted is set going again; half a frame is lost of what the board was
// saying, nothing of what it was told.
class UsbLink final : public SyncLink {
 public:
  // The interface is claimed, and given up with the link.
  UsbLink(UsbContext context, UsbHandle handle, const UsbBoardInterface& board);
  // Waits until the kernel has given every transfer back.
  ~UsbLink() override;
  UsbLink(const UsbLink&) = delete;
  UsbLink& operator=(const UsbLink&) = delete;

  // Has the board's packets taken in from now on; before read and write.
  Status start();
  Result<std::size_t> read(std::span<std::uint8_t> buffer, std::chrono::milliseconds timeout) override;
  Status write(std::span<const std::uint8_t> bytes) override;

 private:
  struct TransferEnd {
    void operator()(libusb_transfer* transfer) const { libusb_free_transfer(transfer); }
  };
  struct Transfer {
    std::unique_ptr<libusb_transfer, TransferEnd> usb{libusb_alloc_transfer(0)};
    std::vector<std::uint8_t> bytes;
    int ended = 1;  // libusb's type of a flag; 0: the kernel has it
  };
  static constexpr std::size_t kIn = 16;   // packets, 1 KB at full speed; a board that finds none free waits
  static constexpr std::size_t kOut = 16;  // frames

  Status submit(Transfer& transfer, std::uint8_t endpoint);
  void wait_for(Transfer& transfer, std::chrono::milliseconds timeout);
  template <std::size_t N>
  void call_back(std::array<Transfer, N>& transfers);
  Status resume_in();
  Status resume_out();
  Status take_sent();

  UsbContext context_;
  UsbHandle handle_;
  UsbBoardInterface board_;
  // Rings: the kernel ends transfers of an endpoint in the order in which it got them.
  std::array<Transfer, kIn> in_;
  std::size_t next_in_ = 0;  // the one that ends next
  std::size_t taken_ = 0;    // bytes of it that have been read
  std::array<Transfer, kOut> out_;
  std::size_t oldest_out_ = 0, unsent_ = 0;
};

// "sync board: WHAT: libusb's words"
Error usb_error(const std::string& what, int code);

}  // namespace lightwell
