// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// The photodiode: TIM3 starts each conversion, DMA stores it; the loop reads behind the DMA.
#include "firmware/hal/hal.h"
#include "firmware/port/f405/port.h"
#include "firmware/port/f405/registers.h"

enum { kSamples = 128, kChannel = 10 };  // 16 ms: the loop is away for 2 at the most

static volatile uint16_t samples[kSamples];
static volatile uint32_t rounds;  // of the DMA through the samples
static uint32_t taken;
static uint32_t lost;

void light_interrupt(void);

void light_interrupt(void) {
  LIGHT_DMA->clear[0] = 1u << 5;
  ++rounds;
}

void light_start(uint32_t clock_hz, uint32_t sample_hz) {
  dma_stream* stream = &LIGHT_DMA->stream[0];
  stream->peripheral = (uint32_t)(uintptr_t)&LIGHT_ADC->data;
  stream->memory[0] = (uint32_t)(uintptr_t)samples;
  stream->count = kSamples;
  stream->control =
      1u << 13 | 1u << 11 | 1u << 10 | 1u << 8 | 1u << 4 | 1u;  // 16 bits, on and on, interrupt a round
  ADC_COMMON = 1u << 16;                                        // a quarter of APB2: 21 MHz
  LIGHT_ADC->sample[0] = 4u;                                    // 84 cycles of it on channel 10: 4 µs
  LIGHT_ADC->sequence[2] = kChannel;
  LIGHT_ADC->control2 =
      1u | 1u << 8 | 1u << 9 | 8u << 24 | 1u << 28;  // TIM3's update starts it, DMA takes it
  SAMPLE_TIMER->reload = clock_hz / sample_hz - 1u;
  SAMPLE_TIMER->control2 = 2u << 4;
  SAMPLE_TIMER->control1 = 1u;
}

uint32_t light_overruns(void) {
  return lost;
}

bool hal_sample(uint16_t* code) {
  uint32_t before;
  uint32_t left;
  do {  // a round may end between the two
    before = rounds;
    left = LIGHT_DMA->stream[0].count;
  } while (before != rounds);
  const uint32_t stored = before * (uint32_t)kSamples + ((uint32_t)kSamples - left);
  const uint32_t ahead = stored - taken;
  if (ahead == 0u || ahead > 0x80000000u) return false;
  if (ahead > (uint32_t)kSamples) {
    lost += ahead - (uint32_t)kSamples;
    taken = stored - (uint32_t)kSamples;
  }
  *code = samples[taken % (uint32_t)kSamples];
  ++taken;
  return true;
}
