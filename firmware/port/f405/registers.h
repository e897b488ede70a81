// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// The registers of an STM32F405 that this board uses, by the facts of ST's reference manual RM0090 and data sheet DS8626.

#include <stdint.h>

typedef volatile uint32_t reg;

typedef struct {
  reg mode, type, speed, pull, input, output, set_reset, alternate[2];
} gpio;

typedef struct {
  reg control1, control2, slave, interrupts, status, event, compare_mode[2], compare_enable, count, prescaler,
      reload, reserved, compare[4];
} timer;

typedef struct {
  reg status, data, baud, control1, control2, control3;
} usart;

typedef struct {
  reg control1, control2, own1, own2, data, status1, status2, clock, rise;
} i2c;

typedef struct {
  reg status, control1, control2, sample[2], offset[4], high, low, sequence[3], injected[5], data;
} adc;

typedef struct {
  reg control, count, peripheral, memory[2], fifo;
} dma_stream;

typedef struct {
  reg status[2], clear[2];
  dma_stream stream[8];
} dma;

typedef struct {
  reg access, key, option_key, status, control;
} flash_controller;

typedef struct {
  reg control, pll, configuration, interrupts, reset[7], reserved, ahb1, ahb2, ahb3, reserved2, apb1, apb2;
} clocks;

typedef struct {
  reg key, prescaler, reload, status;
} watchdog;

typedef struct {
  reg otg[14], core_configuration;  // TinyUSB knows the others
} usb_general;

#define GPIO_A ((gpio*)0x40020000u)
#define GPIO_B ((gpio*)0x40020400u)
#define GPIO_C ((gpio*)0x40020800u)
#define EDGE_TIMER ((timer*)0x40000000u)    // TIM2, 32 bits: interrupt 28
#define SAMPLE_TIMER ((timer*)0x40000400u)  // TIM3
#define LINK_USART ((usart*)0x40011000u)    // USART1: interrupt 37
#define SENSOR_I2C ((i2c*)0x40005400u)      // I2C1
#define LIGHT_ADC ((adc*)0x40012000u)       // ADC1
#define ADC_COMMON (*(reg*)0x40012304u)
#define LIGHT_DMA ((dma*)0x40026400u)  // DMA2, stream 0: interrupt 56
#define FLASH_CONTROLLER ((flash_controller*)0x40023C00u)
#define USB_GENERAL ((usb_general*)0x50000000u)  // OTG_FS: interrupt 67
#define CLOCKS ((clocks*)0x40023800u)
#define WATCHDOG ((watchdog*)0x40003000u)
#define NVIC_ENABLE ((reg*)0xE000E100u)
#define NVIC_PRIORITY ((volatile uint8_t*)0xE000E400u)
#define VECTOR_TABLE (*(reg*)0xE000ED08u)
#define COPROCESSOR_ACCESS (*(reg*)0xE000ED88u)
#define UNIQUE_ID ((reg*)0x1FFF7A10u)

enum { EDGE_INTERRUPT = 28, UART_INTERRUPT = 37, LIGHT_INTERRUPT = 56, USB_INTERRUPT = 67 };

static inline void interrupts_off(void) {
  __asm volatile("cpsid i" ::: "memory");
}
static inline void interrupts_on(void) {
  __asm volatile("cpsie i" ::: "memory");
}
