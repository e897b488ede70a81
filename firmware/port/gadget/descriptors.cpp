// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "firmware/port/gadget/descriptors.h"

#include <endian.h>
#include <linux/usb/functionfs.h>

#include <cstdint>
#include <cstring>

#include "interface/sync_usb.h"

namespace lightwell::sync_gadget {
namespace {

constexpr char kInterfaceName[] = "Lightwell sync board";
constexpr char kGuidName[] = "DeviceInterfaceGUID";
constexpr char kGuid[] = "{5c1d3f2e-7a64-4b0d-9c0b-2f4c57a1e6d8}";      // this interface's own, made once
constexpr std::uint16_t kFullSpeedPacket = 64, kHighSpeedPacket = 512;  // USB 2.0, 5.8.3
constexpr std::uint16_t kCompatibleId = 4, kProperties = 5;             // wIndex of Microsoft's two requests

// Each ends where the next begins; FunctionFS turns the texts into UTF-16.
struct Interface {
  usb_interface_descriptor interface;
  usb_endpoint_descriptor_no_audio from_host, to_host;
} __attribute__((packed));

struct Property {
  std::uint32_t size, type;
  std::uint16_t name_size;
  char name[sizeof kGuidName];
  std::uint32_t data_size;
  char data[sizeof kGuid];
} __attribute__((packed));

struct Descriptors {
  usb_functionfs_descs_head_v2 head;
  std::uint32_t full_count, high_count, microsoft_count;
  Interface full, high;
  usb_os_desc_header compatible_head;
  usb_ext_compat_desc compatible;
  usb_os_desc_header property_head;
  Property property;
} __attribute__((packed));

struct Strings {
  usb_functionfs_strings_head head;
  std::uint16_t language;
  char name[sizeof kInterfaceName];
} __attribute__((packed));

usb_endpoint_descriptor_no_audio bulk(std::uint8_t address, std::uint16_t packet) {
  usb_endpoint_descriptor_no_audio endpoint{};
  endpoint.bLength = USB_DT_ENDPOINT_SIZE;
  endpoint.bDescriptorType = USB_DT_ENDPOINT;
  endpoint.bEndpointAddress = address;
  endpoint.bmAttributes = USB_ENDPOINT_XFER_BULK;
  endpoint.wMaxPacketSize = htole16(packet);
  return endpoint;
}

Interface interface_with(std::uint16_t packet) {
  Interface made{};
  made.interface.bLength = USB_DT_INTERFACE_SIZE;
  made.interface.bDescriptorType = USB_DT_INTERFACE;
  made.interface.bNumEndpoints = 2;
  made.interface.bInterfaceClass = SYNC_USB_CLASS;
  made.interface.bInterfaceSubClass = SYNC_USB_SUBCLASS;
  made.interface.bInterfaceProtocol = SYNC_USB_PROTOCOL;
  made.interface.iInterface = 1;
  made.from_host = bulk(USB_DIR_OUT | 1, packet);
  made.to_host = bulk(USB_DIR_IN | 2, packet);
  return made;
}

usb_os_desc_header microsoft_head(std::uint16_t index, std::size_t payload) {
  usb_os_desc_header head{};
  head.interface = 0;
  head.dwLength = htole32(static_cast<std::uint32_t>(sizeof head + payload));
  head.bcdVersion = htole16(1);
  head.wIndex = htole16(index);
  head.wCount = htole16(1);
  return head;
}

template <class T>
std::vector<std::byte> bytes_of(const T& value) {
  std::vector<std::byte> bytes(sizeof value);
  std::memcpy(bytes.data(), &value, sizeof value);
  return bytes;
}

}  // namespace

std::vector<std::byte> descriptors() {
  Descriptors d{};
  d.head.magic = htole32(FUNCTIONFS_DESCRIPTORS_MAGIC_V2);
  d.head.length = htole32(sizeof d);
  d.head.flags = htole32(FUNCTIONFS_HAS_FS_DESC | FUNCTIONFS_HAS_HS_DESC | FUNCTIONFS_HAS_MS_OS_DESC);
  d.full_count = d.high_count = htole32(3);  // the interface and its endpoints
  d.microsoft_count = htole32(2);
  d.full = interface_with(kFullSpeedPacket);
  d.high = interface_with(kHighSpeedPacket);
  d.compatible_head = microsoft_head(kCompatibleId, sizeof d.compatible);
  d.compatible.Reserved1 = 1;  // as Microsoft's specification has it
  std::memcpy(d.compatible.CompatibleID, "WINUSB", 6);
  d.property_head = microsoft_head(kProperties, sizeof d.property);
  d.property.size = htole32(sizeof d.property);
  d.property.type = htole32(1);  // a text
  d.property.name_size = htole16(sizeof kGuidName);
  std::memcpy(d.property.name, kGuidName, sizeof kGuidName);
  d.property.data_size = htole32(sizeof kGuid);
  std::memcpy(d.property.data, kGuid, sizeof kGuid);
  return bytes_of(d);
}

std::vector<std::byte> strings() {
  Strings s{};
  s.head.magic = htole32(FUNCTIONFS_STRINGS_MAGIC);
  s.head.length = htole32(sizeof s);
  s.head.str_count = s.head.lang_count = htole32(1);
  s.language = htole16(0x0409);  // English
  std::memcpy(s.name, kInterfaceName, sizeof kInterfaceName);
  return bytes_of(s);
}

}  // namespace lightwell::sync_gadget
