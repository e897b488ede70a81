// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// Temperatures in thousandths of a degree Celsius: what sensors' codes mean, and a filter that neither a spike nor a bus
// error passes.

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

// The register of a TMP102, TMP105 or TMP112: 12 bits, the highest first, 1/16 °C each.
int32_t temperature_of_tmp105(uint16_t reading);

// The sensor inside an STM32F405 by its factory calibration: ADC codes at 30 and 110 °C, at 3.3 V.
int32_t temperature_of_stm32(uint32_t code, uint32_t code_at_30, uint32_t code_at_110);

typedef struct {
  int32_t recent[3];
  unsigned count;  // up to 5: the newest is at (count - 1) % 3
  bool started;
  int32_t value_q8;  // 1/256 m°C
} temperature;

void temperature_init(temperature* self);

// One reading, a few a second. False until three have come. Readings outside -60 … 150 °C are bus errors: left out.
bool temperature_sample(temperature* self, int32_t reading_mc, int32_t* filtered_mc);

#ifdef __cplusplus
}
#endif
