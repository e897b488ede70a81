// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <optional>
#include <thread>
#include <utility>

#include "daemon/sync/usb_link.h"
#include "interface/sync_usb.h"

namespace lightwell {
namespace {

using std::chrono::milliseconds;

constexpr auto kRetry = milliseconds(300);  // where nothing will say that it is worth another try

std::optional<UsbBoardInterface> board_interface(libusb_device* device) {
  libusb_config_descriptor* configuration = nullptr;
  if (libusb_get_active_config_descriptor(device, &configuration) != 0) return std::nullopt;
  std::optional<UsbBoardInterface> found;
  for (int i = 0; i < configuration->bNumInterfaces && !found; ++i) {
    const libusb_interface& of_device = configuration->interface[i];
    if (of_device.num_altsetting < 1) continue;
    const libusb_interface_descriptor& setting = of_device.altsetting[0];
    if (setting.bInterfaceClass != SYNC_USB_CLASS || setting.bInterfaceSubClass != SYNC_USB_SUBCLASS ||
        setting.bInterfaceProtocol != SYNC_USB_PROTOCOL)
      continue;
    UsbBoardInterface board;
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

Result<std::string> serial_of(libusb_device* device, libusb_device_handle* handle) {
  libusb_device_descriptor descriptor{};
  libusb_get_device_descriptor(device, &descriptor);
  if (descriptor.iSerialNumber == 0) return std::string();
  std::array<unsigned char, 128> text{};
  const int size = libusb_get_string_descriptor_ascii(handle, descriptor.iSerialNumber, text.data(),
                                                      static_cast<int>(text.size()));
  if (size < 0) return usb_error("reading its serial number", size);
  return std::string(reinterpret_cast<const char*>(text.data()), static_cast<std::size_t>(size));
}

class UsbPort final : public SyncPort {
 public:
  explicit UsbPort(std::string serial) : serial_(std::move(serial)) {}
  ~UsbPort() override {
    if (announced_) libusb_hotplug_deregister_callback(context_.get(), announcer_);
  }
  UsbPort(const UsbPort&) = delete;
  UsbPort& operator=(const UsbPort&) = delete;

  Result<std::unique_ptr<SyncLink>> open() override;
  bool wait(milliseconds most) override;

 private:
  Status start();
  Result<std::unique_ptr<SyncLink>> open_device(libusb_device* device, const UsbBoardInterface& board);

  std::string serial_;
  UsbContext context_;
  libusb_hotplug_callback_handle announcer_ = 0;
  bool announced_ = false;  // arrivals are: nobody need ask
  int arrived_ = 0;         // libusb's type of a flag
  bool perhaps_ = false;    // a board may be there without any arrival to come
  milliseconds waited_{0};
};

Status UsbPort::start() {
  if (context_) return {};
  libusb_context* made = nullptr;
  if (const int code = libusb_init(&made); code != 0) return usb_error("USB is not to be had", code);
  context_ = UsbContext(made, libusb_exit);
  if (libusb_has_capability(LIBUSB_CAP_HAS_HOTPLUG) == 0) return {};
  // Nothing may be asked of a device in here; whether it is a board, open() will see.
  const auto arrived = [](libusb_context*, libusb_device*, libusb_hotplug_event, void* self) {
    static_cast<UsbPort*>(self)->arrived_ = 1;
    return 0;
  };
  announced_ = libusb_hotplug_register_callback(context_.get(), LIBUSB_HOTPLUG_EVENT_DEVICE_ARRIVED,
                                                LIBUSB_HOTPLUG_NO_FLAGS, LIBUSB_HOTPLUG_MATCH_ANY,
                                                LIBUSB_HOTPLUG_MATCH_ANY, LIBUSB_HOTPLUG_MATCH_ANY, arrived,
                                                this, &announcer_) == LIBUSB_SUCCESS;
  return {};
}

// Null: a board with another serial number.
Result<std::unique_ptr<SyncLink>> UsbPort::open_device(libusb_device* device,
                                                       const UsbBoardInterface& board) {
  libusb_device_handle* opened = nullptr;
  if (const int code = libusb_open(device, &opened); code != 0)
    return usb_error(
        code == LIBUSB_ERROR_ACCESS ? "no right to use it; a udev rule must give it" : "opening it", code);
  UsbHandle handle(opened);
  if (!serial_.empty()) {
    const auto serial = serial_of(device, opened);
    if (!serial) return serial.error();  // it may be the one: another try
    if (*serial != serial_) return std::unique_ptr<SyncLink>();
  }
  if (const int code = libusb_claim_interface(opened, board.number); code != 0)
    return usb_error(code == LIBUSB_ERROR_BUSY ? "another program uses it" : "claiming it", code);
  auto link = std::make_unique<UsbLink>(context_, std::move(handle), board);
  if (Status started = link->start(); !started) return started.error();
  return std::unique_ptr<SyncLink>(std::move(link));
}

Result<std::unique_ptr<SyncLink>> UsbPort::open() {
  waited_ = milliseconds(0);
  arrived_ = 0;  // what has come so far is listed below
  perhaps_ = true;
  if (Status started = start(); !started) return started.error();
  libusb_device** devices = nullptr;
  const ssize_t count = libusb_get_device_list(context_.get(), &devices);
  if (count < 0) return usb_error("listing USB devices", static_cast<int>(count));
  const auto free_list = [](libusb_device** list) { libusb_free_device_list(list, 1); };
  const std::unique_ptr<libusb_device*, decltype(free_list)> list(devices, free_list);
  std::optional<Error> refused;
  for (ssize_t i = 0; i < count; ++i) {
    const auto board = board_interface(devices[i]);
    if (!board) continue;
    auto link = open_device(devices[i], *board);
    if (link && *link) return link;
    if (!link) refused = link.error();
  }
  if (refused) return *refused;
  perhaps_ = false;
  return Error{ErrorKind::failed,
               serial_.empty() ? "no sync board on USB" : "no sync board " + serial_ + " on USB"};
}

bool UsbPort::wait(milliseconds most) {
  if (announced_) {
    timeval time{most.count() / 1000, most.count() % 1000 * 1000};
    libusb_handle_events_timeout_completed(context_.get(), &time, &arrived_);
    if (std::exchange(arrived_, 0) != 0) return true;
  } else {
    std::this_thread::sleep_for(most);
  }
  waited_ += most;
  return (perhaps_ || !announced_) && waited_ >= kRetry;
}

}  // namespace

std::unique_ptr<SyncPort> make_usb_port(const std::string& serial) {
  return std::make_unique<UsbPort>(serial);
}

}  // namespace lightwell
