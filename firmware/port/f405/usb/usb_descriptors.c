// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// Windows takes the board without a driver package: the BOS descriptor leads it to a set (Microsoft OS 2.0 Descriptors
// Specification) that names WinUSB.
#include "firmware/port/f405/usb/usb_descriptors.h"

#include <stdbool.h>
#include <stddef.h>

#include "interface/sync_usb.h"
#include "tusb.h"

// pid.codes' product for private tests: who makes boards for others needs one of their own. The host does not look at it.
enum { kVendor = 0x1209, kProduct = 0x0001, kRelease = 0x0020 };
enum { kManufacturerText = 1, kProductText = 2, kSerialText = 3 };
enum { kInterfaces = 1, kConfigurationSize = 9 + 9 + 7 + 7, kMilliamperes = 100 };
enum { kMicrosoftRequest = 1, kMicrosoftSetIndex = 7, kMicrosoftSetSize = 10 + 20 + 132, kBosSize = 5 + 28 };
enum { kSerialDigits = 24, kLongestText = 32 };

#define LOW_HIGH(value) (uint8_t)((value)&0xFF), (uint8_t)((value) >> 8)
#define TEXT2(a, b) (a), 0, (b), 0
#define TEXT4(a, b, c, d) TEXT2(a, b), TEXT2(c, d)

// A line, or a few, for each descriptor.
// clang-format off
static const uint8_t kDevice[] = {
    18, TUSB_DESC_DEVICE, LOW_HIGH(0x0210), 0, 0, 0, CFG_TUD_ENDPOINT0_SIZE, LOW_HIGH(kVendor), LOW_HIGH(kProduct),
    LOW_HIGH(kRelease), kManufacturerText, kProductText, kSerialText, 1};

static const uint8_t kConfiguration[kConfigurationSize] = {
    9, TUSB_DESC_CONFIGURATION, LOW_HIGH(kConfigurationSize), kInterfaces, 1, 0, 0x80, kMilliamperes / 2,
    9, TUSB_DESC_INTERFACE, 0, 0, 2, SYNC_USB_CLASS, SYNC_USB_SUBCLASS, SYNC_USB_PROTOCOL, kProductText,
    7, TUSB_DESC_ENDPOINT, USB_FROM_HOST, TUSB_XFER_BULK, LOW_HIGH(USB_PACKET), 0,
    7, TUSB_DESC_ENDPOINT, USB_TO_HOST, TUSB_XFER_BULK, LOW_HIGH(USB_PACKET), 0};

// One capability: the platform D8DD60DF-4589-4CC7-9CD2-659D9E648A9F, for Windows 8.1 and later.
static const uint8_t kBos[kBosSize] = {
    5, TUSB_DESC_BOS, LOW_HIGH(kBosSize), 1,
    28, TUSB_DESC_DEVICE_CAPABILITY, DEVICE_CAPABILITY_PLATFORM, 0,
    0xDF, 0x60, 0xDD, 0xD8, 0x89, 0x45, 0xC7, 0x4C, 0x9C, 0xD2, 0x65, 0x9D, 0x9E, 0x64, 0x8A, 0x9F,
    LOW_HIGH(0x0000), LOW_HIGH(0x0603), LOW_HIGH(kMicrosoftSetSize), kMicrosoftRequest, 0};

// Set header; compatible id; the property DeviceInterfaceGUIDs, a list of one that ends in two zeros.
static const uint8_t kMicrosoftSet[kMicrosoftSetSize] = {
    LOW_HIGH(10), LOW_HIGH(0), LOW_HIGH(0x0000), LOW_HIGH(0x0603), LOW_HIGH(kMicrosoftSetSize),
    LOW_HIGH(20), LOW_HIGH(3), 'W', 'I', 'N', 'U', 'S', 'B', 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,
    LOW_HIGH(132), LOW_HIGH(4), LOW_HIGH(7), LOW_HIGH(42),
    TEXT4('D', 'e', 'v', 'i'), TEXT4('c', 'e', 'I', 'n'), TEXT4('t', 'e', 'r', 'f'), TEXT4('a', 'c', 'e', 'G'),
    TEXT4('U', 'I', 'D', 's'), 0, 0, LOW_HIGH(80),
    TEXT4('{', '5', 'c', '1'), TEXT4('d', '3', 'f', '2'), TEXT4('e', '-', '7', 'a'), TEXT4('6', '4', '-', '4'),
    TEXT4('b', '0', 'd', '-'), TEXT4('9', 'c', '0', 'b'), TEXT4('-', '2', 'f', '4'), TEXT4('c', '5', '7', 'a'),
    TEXT4('1', 'e', '6', 'd'), TEXT4('8', '}', 0, 0)};
// clang-format on

static char serial_text[kSerialDigits + 1];

void usb_descriptors_serial(const uint32_t serial[3]) {
  for (unsigned i = 0; i < (unsigned)kSerialDigits; ++i)
    serial_text[i] = "0123456789abcdef"[serial[i / 8u] >> (28u - 4u * (i % 8u)) & 15u];
}

uint8_t const* tud_descriptor_device_cb(void) {
  return kDevice;
}

uint8_t const* tud_descriptor_configuration_cb(uint8_t index) {
  (void)index;  // there is one
  return kConfiguration;
}

uint8_t const* tud_descriptor_bos_cb(void) {
  return kBos;
}

// UTF-16 with its header; the list of languages is that of text 0: American English.
uint16_t const* tud_descriptor_string_cb(uint8_t index, uint16_t language) {
  static uint16_t descriptor[1 + kLongestText];
  static const char* const kTexts[kSerialText + 1] = {[kManufacturerText] = "Lightwell",
                                                      [kProductText] = "Lightwell sync board",
                                                      [kSerialText] = serial_text};
  (void)language;
  unsigned count = 0;
  if (index == 0u) {
    descriptor[++count] = 0x0409u;
  } else if (index <= (uint8_t)kSerialText) {
    const char* text = kTexts[index];
    while (count < (unsigned)kLongestText && text[count] != '\0') {
      descriptor[count + 1u] = (uint16_t)text[count];
      ++count;
    }
  } else {
    return NULL;
  }
  descriptor[0] = (uint16_t)((uint16_t)TUSB_DESC_STRING << 8 | (2u + 2u * count));
  return descriptor;
}

bool tud_vendor_control_xfer_cb(uint8_t port, uint8_t stage, tusb_control_request_t const* request) {
  if (stage != (uint8_t)CONTROL_STAGE_SETUP) return true;
  if (request->bRequest != (uint8_t)kMicrosoftRequest || request->wIndex != (uint16_t)kMicrosoftSetIndex ||
      request->bmRequestType_bit.direction != (unsigned)TUSB_DIR_IN)
    return false;
  return tud_control_xfer(port, request, (void*)(uintptr_t)kMicrosoftSet, kMicrosoftSetSize);
}
