// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// The board's own class on TinyUSB: one interface, a bulk endpoint a direction. TinyUSB's vendor class would send a packet a
// byte as the loop writes them, and would leave a host waiting that reads more than a transfer of whole packets. All but
// usb_interrupt runs in the loop.
#include <stddef.h>

#include "device/usbd_pvt.h"
#include "firmware/core/board.h"
#include "firmware/port/f405/port.h"
#include "firmware/port/f405/registers.h"
#include "firmware/port/f405/usb/usb_descriptors.h"
#include "interface/sync_usb.h"
#include "tusb.h"

enum { kPort = 0, kInterfaceSize = 9 + 7 + 7, kSendBytes = 256 };
enum { kNoVbusSensing = 1 << 21, kClock = 1 << 7 };

uint32_t SystemCoreClock = 168000000;  // which TinyUSB's driver waits and turns around by

static bool running;  // clock and core
static bool open;     // by a host
static uint8_t received[USB_PACKET];
static uint32_t received_size, taken;
static uint8_t filling[kSendBytes], sending[kSendBytes];  // one gathers while the other is on its way
static uint32_t filled;

void usb_interrupt(void);

void usb_interrupt(void) {
  tud_int_handler(kPort);
}

static void class_start(void) {}

static void class_reset(uint8_t port) {
  (void)port;
  open = false;
}

static void listen(void) {
  taken = 0;
  received_size = 0;
  (void)usbd_edpt_xfer(kPort, USB_FROM_HOST, received, sizeof received);
}

static uint16_t class_open(uint8_t port, tusb_desc_interface_t const* descriptor, uint16_t most) {
  uint8_t out;
  uint8_t in;
  if (descriptor->bInterfaceClass != SYNC_USB_CLASS || most < (uint16_t)kInterfaceSize ||
      !usbd_open_edpt_pair(port, tu_desc_next(descriptor), 2, TUSB_XFER_BULK, &out, &in))
    return 0;
  open = true;
  filled = 0;
  listen();
  return kInterfaceSize;
}

static bool class_control(uint8_t port, uint8_t stage, tusb_control_request_t const* request) {
  (void)port;
  (void)stage;
  (void)request;
  return false;  // stalled: it has no requests
}

static bool class_moved(uint8_t port, uint8_t endpoint, xfer_result_t result, uint32_t size) {
  (void)port;
  if (endpoint == (uint8_t)USB_FROM_HOST) received_size = result == XFER_RESULT_SUCCESS ? size : 0u;
  return true;
}

usbd_class_driver_t const* usbd_app_driver_get_cb(uint8_t* count) {
  static const usbd_class_driver_t kClass = {.init = class_start,
                                             .reset = class_reset,
                                             .open = class_open,
                                             .control_xfer_cb = class_control,
                                             .xfer_cb = class_moved,
                                             .sof = NULL};
  *count = 1;
  return &kClass;
}

// The board is fed by this connector, so a device that runs is a device that is plugged: VBUS is not sensed and PA9 is free.
void usb_start(const uint32_t serial[3]) {
  CLOCKS->ahb2 |= kClock;
  USB_GENERAL->core_configuration = kNoVbusSensing;
  usb_descriptors_serial(serial);
  running = tusb_init();
}

// Sends what was gathered. A transfer ends with a packet that is not full, so that the host's read ends with it: a full last
// packet keeps its last byte for the next transfer.
static void flush(void) {
  if (!open || filled == 0u || usbd_edpt_busy(kPort, USB_TO_HOST)) return;
  const uint32_t size = filled % (uint32_t)USB_PACKET == 0u ? filled - 1u : filled;
  const uint8_t last = filling[filled - 1u];
  for (uint32_t i = 0; i < size; ++i) sending[i] = filling[i];
  if (!usbd_edpt_xfer(kPort, USB_TO_HOST, sending, (uint16_t)size)) return;
  filling[0] = last;
  filled -= size;
}

bool usb_link_read(uint8_t* byte) {
  if (!running) return false;
  if (taken == received_size) {
    tud_task();
    flush();
    if (taken == received_size) {
      if (open && !usbd_edpt_busy(kPort, USB_FROM_HOST)) listen();
      return false;
    }
  }
  *byte = received[taken];
  ++taken;
  return true;
}

bool usb_link_ready(void) {
  return open && filled < (uint32_t)kSendBytes;
}

void usb_link_write(uint8_t byte) {
  filling[filled] = byte;
  ++filled;
}
