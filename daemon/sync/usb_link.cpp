// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <libusb.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <optional>
#include <utility>

#include "daemon/sync/sync_link.h"
#include "interface/sync_usb.h"

namespace lightwell {
namespace {

Error usb_error(const std::string& what, int code) {
  return {ErrorKind::failed, "sync board: " + what + ": " + libusb_strerror(static_cast<libusb_error>(code))};
}

struct ContextEnd {
  void operator()(libusb_context* context) const { libusb_exit(context); }
};
using Context = std::unique_ptr<libusb_context, ContextEnd>;
struct HandleEnd {
  void operator()(libusb_device_handle* handle) const { libusb_close(handle); }
};
using Handle = std::unique_ptr<libusb_device_handle, HandleEnd>;

// Endpoint numbers are the gadget's to choose: they stand in the descriptor.
struct BoardInterface {
  std::uint8_t number = 0, in = 0, out = 0;
  std::size_t packet = 64;  // bytes; reads are whole multiples
};

std::optional<BoardInterface> board_interface(libusb_device* device) {
  libusb_config_descriptor* configuration = nullptr;
  if (libusb_get_active_config_descriptor(device, &configuration) != 0) return std::nullopt;
  std::optional<BoardInterface> found;
  for (int i = 0; i < configuration->bNumInterfaces && !found; ++i) {
    const libusb_interface& of_device = configuration->interface[i];
    if (of_device.num_altsetting < 1) continue;
    const libusb_interface_descriptor& setting = of_device.altsetting[0];
    if (setting.bInterfaceClass != SYNC_USB_CLASS || setting.bInterfaceSubClass != SYNC_USB_SUBCLASS ||
        setting.bInterfaceProtocol != SYNC_USB_PROTOCOL)
      continue;
    BoardInterface board;
    board.number = setting.bInterfaceNumber;
    for (int e = 0; e < setting.bNumEndpoints; ++e) {
      const libusb_endpoint_descriptor& endpoint = setting.endpoint[e];
      if ((endpoint.bmAttributes & LIBUSB_TRANSFER_TYPE_MASK) != LIBUSB_TRANSFER_TYPE_BULK) continue;
      if ((endpoint.bEndpointAddress & LIBUSB_ENDPOINT_IN) != 0) {
        board.in = endpoint.bEndpointAddress;
        board.packet = endpoint.wMaxPacketSize;
      } else {
        board.out = endpoint.bEndpointAddress;
      }
    }
    if (board.in != 0 && board.out != 0 && board.packet > 0) found = board;
  }
  libusb_free_config_descriptor(configuration);
  return found;
}

std::string serial_of(libusb_device_handle* handle, std::uint8_t index) {
  std::array<unsigned char, 128> text{};
  const int size = index == 0 ? 0
                              : libusb_get_string_descriptor_ascii(handle, index, text.data(),
                                                                   static_cast<int>(text.size()));
  return {reinterpret_cast<const char*>(text.data()), static_cast<std::size_t>(std::max(size, 0))};
}

class UsbLink final : public SyncLink {
 public:
  UsbLink(Context context, Handle handle, const BoardInterface& board)
      : context_(std::move(context)), handle_(std::move(handle)), board_(board) {}
  ~UsbLink() override { libusb_release_interface(handle_.get(), board_.number); }

  Result<std::size_t> read(std::span<std::uint8_t> buffer, std::chrono::milliseconds timeout) override {
    if (at_ == size_) {
      int size = 0;
      // A transfer shorter than what a board sends would be an overflow: whole packets.
      const std::size_t room = received_.size() / board_.packet * board_.packet;
      const int code =
          libusb_bulk_transfer(handle_.get(), board_.in, received_.data(), static_cast<int>(room), &size,
                               static_cast<unsigned>(std::max<long>(timeout.count(), 1)));
      if (code == LIBUSB_ERROR_PIPE) {
        libusb_clear_halt(handle_.get(), board_.in);
        return std::size_t{0};
      }
      if (code != 0 && code != LIBUSB_ERROR_TIMEOUT && code != LIBUSB_ERROR_INTERRUPTED)
        return usb_error("reading", code);
      at_ = 0;
      size_ = static_cast<std::size_t>(size);  // a timeout may have brought some
    }
    const std::size_t taken = std::min(buffer.size(), size_ - at_);
    std::copy_n(received_.begin() + static_cast<std::ptrdiff_t>(at_), taken, buffer.begin());
    at_ += taken;
    return taken;
  }

  Status write(std::span<const std::uint8_t> bytes) override {
    while (!bytes.empty()) {
      int size = 0;
      const int code =
          libusb_bulk_transfer(handle_.get(), board_.out, const_cast<std::uint8_t*>(bytes.data()),
                               static_cast<int>(bytes.size()), &size, 1000);
      bytes = bytes.subspan(static_cast<std::size_t>(size));
      if (code == LIBUSB_ERROR_PIPE) libusb_clear_halt(handle_.get(), board_.out);
      if (code != 0) return usb_error("writing", code);
    }
    return {};
  }

 private:
  Context context_;
  Handle handle_;
  BoardInterface board_;
  std::array<std::uint8_t, 4096> received_{};
  std::size_t at_ = 0, size_ = 0;
};

Result<std::unique_ptr<SyncLink>> claim(Context context, Handle handle, const BoardInterface& board) {
  if (const int code = libusb_claim_interface(handle.get(), board.number); code != 0)
    return usb_error(code == LIBUSB_ERROR_BUSY ? "another program uses it" : "claiming it", code);
  return std::unique_ptr<SyncLink>(std::make_unique<UsbLink>(std::move(context), std::move(handle), board));
}

}  // namespace

Result<std::unique_ptr<SyncLink>> open_usb_link(const std::string& serial) {
  libusb_context* made = nullptr;
  if (const int code = libusb_init(&made); code != 0) return usb_error("USB is not to be had", code);
  Context context(made);
  libusb_device** devices = nullptr;
  const ssize_t count = libusb_get_device_list(context.get(), &devices);
  if (count < 0) return usb_error("listing USB devices", static_cast<int>(count));
  const auto free_list = [](libusb_device** list) { libusb_free_device_list(list, 1); };
  const std::unique_ptr<libusb_device*, decltype(free_list)> list(devices, free_list);
  std::optional<Error> refused;
  for (ssize_t i = 0; i < count; ++i) {
    const auto board = board_interface(devices[i]);
    if (!board) continue;
    libusb_device_descriptor descriptor{};
    libusb_get_device_descriptor(devices[i], &descriptor);
    libusb_device_handle* opened = nullptr;
    if (const int code = libusb_open(devices[i], &opened); code != 0) {
      refused = usb_error(
          code == LIBUSB_ERROR_ACCESS ? "no right to use it; a udev rule must give it" : "opening it", code);
      continue;
    }
    Handle handle(opened);
    if (!serial.empty() && serial_of(opened, descriptor.iSerialNumber) != serial) continue;
    return claim(std::move(context), std::move(handle), *board);
  }
  if (refused) return *refused;
  return Error{ErrorKind::failed,
               serial.empty() ? "no sync board on USB" : "no sync board " + serial + " on USB"};
}

}  // namespace lightwell
