// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// The parts of this port, and the pins:
//   PA0  trigger out      TIM2_CH1        PB6  link, transmit   USART1_TX
//   PA1  strobe in        TIM2_CH2        PB7  link, receive    USART1_RX
//   PA2  PPS or genlock   TIM2_CH3        PB8  I2C1_SCL, PB9 I2C1_SDA: IMU and temperatures
//   PA3  timecode in      TIM2_CH4        PB12 LED, PB13 button (to ground), PB14 camera power
//   PC0  photodiode       ADC123_IN10     PA11, PA12  USB D-, D+    OTG_FS

#include <stdbool.h>
#include <stdint.h>

#include "firmware/core/flash.h"
#include "firmware/core/update.h"

// The 168 MHz of the PLL, and with it 84 MHz for timers and USART1; without crystal and PLL 16 MHz. Returns the timers' rate.
uint32_t clocks_start(void);
bool clocks_exact(void);  // crystal and PLL run: only then are there 48 MHz that USB may use

void edges_start(void);
uint32_t edges_overruns(void);

void uart_start(uint32_t clock_hz);
uint32_t uart_overruns(void);
bool uart_link_read(uint8_t* byte);
bool uart_link_ready(void);
void uart_link_write(uint8_t byte);

// serial: the device's serial number. Nothing of usb_link_* does anything before it, or in an image built without USB.
void usb_start(const uint32_t serial[3]);
bool usb_link_read(uint8_t* byte);
bool usb_link_ready(void);
void usb_link_write(uint8_t byte);

void light_start(uint32_t clock_hz, uint32_t sample_hz);
uint32_t light_overruns(void);

void sensors_start(uint32_t clock_hz);

// The chip's flash: copies of the settings in sectors 1 and 2, images with their records in sectors 4 and 5.
enum { CHIP_IMAGE_REGION = 65536 };
extern const flash chip_flash;
uint32_t chip_flash_address(uint32_t region);  // where a region begins

const update_verifier* chip_verifier(void);  // null: this build has none, and takes no updates

void watchdog_start(void);  // 4 s, from then on to the next reset
