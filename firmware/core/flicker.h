// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// What a photodiode says about lamps: level, the strongest frequencies from 80 to 2000 Hz, and their depth.
//
// A measurement takes 30 windows of 1024 samples, half overlapping (at 8 kHz 1.98 s). The power of the first eight finds
// the frequencies that stand out of the noise to a fraction of a bin; in the other 22 the phase of each is followed, which
// gives it to hundredths of a hertz: a periodogram of that bin's complex values is searched for its maximum, the
// maximum-likelihood estimate of one tone in white noise (Rife and Boorstyn 1974). 10 KB, whatever the light.

#include <stdbool.h>
#include <stdint.h>

#include "firmware/core/fourier.h"

#ifdef __cplusplus
extern "C" {
#endif

enum {
  FLICKER_TONES = 4,
  FLICKER_HOP = FOURIER_SIZE / 2,
  FLICKER_SEARCH_BLOCKS = 8,
  FLICKER_PHASE_BLOCKS = 22,
  FLICKER_BINS = FOURIER_SIZE / 2,
  FLICKER_SAMPLES = FOURIER_SIZE + (FLICKER_SEARCH_BLOCKS + FLICKER_PHASE_BLOCKS - 1) * FLICKER_HOP
};

typedef struct {
  float hz;
  float depth;  // amplitude over the mean
} flicker_tone;

typedef struct {
  float level;  // mean, ADC codes, darkness taken off
  bool clipped;
  unsigned tones;
  flicker_tone tone[FLICKER_TONES];  // strongest first
} flicker_result;

typedef struct {
  float sample_hz;
  float dark;        // code in darkness
  uint16_t highest;  // code at which the converter ends
  uint16_t samples[FOURIER_SIZE];
  unsigned filled;
  unsigned block;
  bool clipped;
  float sum;  // of the blocks' means
  float work[FOURIER_SIZE];
  float power[FLICKER_BINS];
  unsigned candidates;
  uint16_t bin[FLICKER_TONES];
  float real[FLICKER_TONES][FLICKER_PHASE_BLOCKS];
  float imaginary[FLICKER_TONES][FLICKER_PHASE_BLOCKS];
} flicker;

// sample_hz: 4500 to 20000.
void flicker_init(flicker* self, float sample_hz, float dark, uint16_t highest);

// Takes one sample. True once a measurement is complete, which is then in *result; the next begins at once. The calls
// that end a block (one in 512) take a transform's time.
bool flicker_sample(flicker* self, uint16_t code, flicker_result* result);

#ifdef __cplusplus
}
#endif
