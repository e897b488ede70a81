// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// STM32F405: pins, start, and what is one line each.
#include "firmware/hal/hal.h"

#include "firmware/port/f405/port.h"
#include "firmware/port/f405/registers.h"

enum { kSampleHz = 8000, kLed = 12, kButton = 13, kCamera = 14 };
enum { kHsiReady = 1 << 1 };
enum { kOutput = 1, kAlternate = 2, kAnalog = 3 };

extern uint32_t image_start;  // of the linker: where this image lies

static board_facts facts;

static void pin_mode(gpio* port, unsigned pin, uint32_t mode) {
  port->mode = (port->mode & ~(3u << (2u * pin))) | mode << (2u * pin);
}

static void pin_function(gpio* port, unsigned pin, uint32_t function) {
  reg* half = &port->alternate[pin / 8u];
  *half = (*half & ~(15u << (4u * (pin % 8u)))) | function << (4u * (pin % 8u));
  pin_mode(port, pin, kAlternate);
}

static void set_pin(gpio* port, unsigned pin, bool level) {
  port->set_reset = level ? 1u << pin : 1u << (pin + 16u);
}

static void pins_start(void) {
  set_pin(GPIO_B, kCamera, false);
  for (unsigned pin = 0; pin < 4u; ++pin) pin_function(GPIO_A, pin, 1);  // TIM2
  GPIO_A->speed |= 3u;
  for (unsigned pin = 11; pin < 13u; ++pin) pin_function(GPIO_A, pin, 10);  // OTG_FS
  GPIO_A->speed |= 15u << 22;
  for (unsigned pin = 6; pin < 8u; ++pin) pin_function(GPIO_B, pin, 7);   // USART1
  for (unsigned pin = 8; pin < 10u; ++pin) pin_function(GPIO_B, pin, 4);  // I2C1
  GPIO_B->type |= 3u << 8;                                                // open drain
  GPIO_B->pull |= 1u << (2 * kButton) | 1u << (2 * 7);
  pin_mode(GPIO_B, kLed, kOutput);
  pin_mode(GPIO_B, kCamera, kOutput);
  pin_mode(GPIO_C, 0, kAnalog);
}

static void interrupts_start(void) {
  static const uint8_t kUsed[] = {EDGE_INTERRUPT, LIGHT_INTERRUPT, UART_INTERRUPT, USB_INTERRUPT};
  for (unsigned i = 0; i < sizeof kUsed; ++i) {
    // Edges first: a capture must be read before the next one. The others wait for each other, 8 µs at the most.
    NVIC_PRIORITY[kUsed[i]] = i == 0u ? 0u : 64u;
    NVIC_ENABLE[kUsed[i] / 32u] = 1u << (kUsed[i] % 32u);
  }
}

const board_facts* hal_init(void) {
  COPROCESSOR_ACCESS |= 0xFu << 20;
  const uint32_t clock_hz = clocks_start();
  pins_start();
  edges_start();
  uart_start(clock_hz);
  light_start(clock_hz, kSampleHz);
  sensors_start(clock_hz);
  interrupts_start();
  watchdog_start();
  facts =
      (board_facts){.tick_hz = clock_hz,
                    .capabilities = SYNC_CAN_TRIGGER | SYNC_CAN_STROBE | SYNC_CAN_REFERENCE |
                                    SYNC_CAN_TIMECODE | SYNC_CAN_PHOTODIODE | SYNC_CAN_IMU |
                                    SYNC_CAN_TEMPERATURE | SYNC_CAN_BUTTON | SYNC_CAN_CAMERA_POWER |
                                    SYNC_CAN_STORE | (chip_verifier() != NULL ? SYNC_CAN_UPDATE : 0),
                    .slot = (uint32_t)(uintptr_t)&image_start == chip_flash_address(FLASH_IMAGE_B) ? 1u : 0u,
                    .sample_hz = kSampleHz,
                    .highest_code = 4095,
                    .memory = &chip_flash,
                    .verifier = chip_verifier(),
                    .image_region_size = CHIP_IMAGE_REGION};
  // Silicon always reports its internal oscillator; an emulator that models no clocks has no identity to read either.
  if ((CLOCKS->control & (uint32_t)kHsiReady) != 0u)
    for (unsigned i = 0; i < 3u; ++i) facts.serial[i] = UNIQUE_ID[i];
  if (clocks_exact()) usb_start(facts.serial);
  return &facts;
}

bool hal_button(void) {
  return (GPIO_B->input & 1u << kButton) == 0u;
}

void hal_led(bool lit) {
  set_pin(GPIO_B, kLed, lit);
}

void hal_camera_power(bool on) {
  set_pin(GPIO_B, kCamera, on);
}

uint32_t hal_overruns(void) {
  return edges_overruns() + uart_overruns() + light_overruns();
}
